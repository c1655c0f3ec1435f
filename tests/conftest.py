"""Fixtures shared by every test file, and how hypothesis runs: the same examples each time, however slow the machine.

`pytest --hypothesis-profile=explore` looks at others.
"""

import pytest
from hypothesis import settings

import octomarch as om

settings.register_profile("same", derandomize=True, deadline=None, database=None, max_examples=60)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile("same")


@pytest.fixture(params=om.isas(), scope="session")
def isa(request: pytest.FixtureRequest) -> str:
    """Name of each instruction set that this machine can run, one after the other."""
    return str(request.param)


@pytest.fixture(params=["float32", "float64"], scope="session")
def precision(request: pytest.FixtureRequest) -> str:
    """Name of each arithmetic, one after the other."""
    return str(request.param)

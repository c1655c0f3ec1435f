"""Fixtures shared by every test file."""

import pytest

import octomarch as om


@pytest.fixture(params=om.isas())
def isa(request: pytest.FixtureRequest) -> str:
    """Name of each instruction set that this machine can run, one after the other."""
    return str(request.param)

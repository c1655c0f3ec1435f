"""Fixtures shared by every test file, and how hypothesis runs: the same examples each time, however slow the machine.

`pytest --hypothesis-profile=explore` looks at others.
"""

from collections.abc import Iterator

import pytest
from hypothesis import settings

import octomarch as om
from chromium import BROWSER, Chromium
from octomarch.empty import expected
from webgl import WebGl

WARNED = ("test_empty", "test_docs", "test_docstrings")
"""Files whose tests are told of pictures that show nothing."""

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


@pytest.fixture(scope="session")
def chromium() -> Iterator[Chromium]:
    """Return the browser of all tests that need one."""
    pytest.importorskip("playwright")
    if BROWSER is None:
        pytest.skip("needs Debian's chromium")
    browser = Chromium()
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def webgl(chromium: Chromium) -> WebGl:
    """Return what runs shaders in it."""
    return WebGl(chromium)


@pytest.fixture(scope="module", autouse=True)
def nothing_to_be_seen(request: pytest.FixtureRequest) -> Iterator[None]:
    """Pictures of nothing are what many tests are about: they are told of them where that is the subject."""
    if request.path.stem in WARNED:
        yield
    else:
        with expected():
            yield

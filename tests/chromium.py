"""Debian's chromium without a window, driven by playwright, for tests of what runs in browsers.

Playwright keeps an event loop running in the thread that uses it, which other libraries would trip over: so it has a
thread of its own.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from playwright.sync_api import Browser

Result = TypeVar("Result")

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_IS_SANITIZED = "libasan" in os.environ.get("LD_PRELOAD", "")
BROWSER = None if _IS_SANITIZED else next(filter(None, map(shutil.which, _NAMES)), None)
"""None where there is none, or it would be loaded with a sanitizer's library, which it does not run with."""
# The sandbox does not run in containers; without a graphics card WebGL is computed.
ARGUMENTS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


class Chromium:
    """A running browser."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)
        self._browser: Browser = self._thread.submit(self._start).result()

    def _start(self) -> Browser:
        from playwright.sync_api import sync_playwright  # here, since other tests need no playwright

        self._playwright = sync_playwright().start()
        return self._playwright.chromium.launch(executable_path=BROWSER, args=ARGUMENTS)

    def run(self, work: Callable[..., Result], *arguments: Any) -> Result:
        """Return work(browser, …), which may use the browser until it returns."""
        return self._thread.submit(work, self._browser, *arguments).result()

    def close(self) -> None:
        self._thread.submit(self._browser.close).result()
        self._thread.submit(self._playwright.stop).result()
        self._thread.shutdown()

"""A real browser for tests and for the programs that take pictures."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--no-sandbox --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync"
    " --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader"
).split()


class NoBrowser(Exception):
    """There is no browser here; the message says what is missing."""


@contextmanager
def started() -> Iterator[Any]:
    """Chromium without a window, drawing on the processor. Raises `NoBrowser`."""
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        raise NoBrowser("there is no Chromium")
    try:
        playwright = import_module("playwright.sync_api")
    except ImportError:
        raise NoBrowser("playwright is not installed") from None
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=program, headless=True, args=FLAGS)
        yield browser
        browser.close()

"""A real browser, and models in it. Skips, with the reason, where there is none."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

TESTS = str(Path(__file__).resolve().parents[2])
if TESTS not in sys.path:
    sys.path.insert(0, TESTS)

from chromium import NoBrowser, started  # noqa: E402


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium without a window, drawing on the processor."""
    try:
        with started() as opened:
            yield opened
    except NoBrowser as reason:
        pytest.skip(str(reason))


@pytest.fixture
def open_page(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens an address and waits for the model; what the page says on its console is an error."""
    faults: list[str] = []
    context = browser.new_context(viewport={"width": 1100, "height": 640})

    def opened(address: str, models: int | None = 1) -> Any:
        page = context.new_page()
        page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(address)
        if models is not None:
            page.wait_for_selector(f"html[data-shown='{models}']", state="attached", timeout=60_000)
        return page

    yield opened
    context.close()
    assert faults == []

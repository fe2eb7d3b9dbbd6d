"""Report progress while another machine is silent, so that the user sees that mjcompose is waiting."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_FIRST, _EVERY = 2.0, 1.0


@contextmanager
def waiting(progress: Callable[[str], None], what: str) -> Iterator[None]:
    """Report every second how long the block has taken so far, from the second one on."""
    done = threading.Event()
    begun = time.monotonic()

    def report() -> None:
        pause = _FIRST
        while not done.wait(pause):
            progress(f"waiting {what}: {time.monotonic() - begun:.0f} s")
            pause = _EVERY

    reporter = threading.Thread(target=report, daemon=True)
    reporter.start()
    try:
        yield
    finally:
        done.set()
        reporter.join()

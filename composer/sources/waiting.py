"""Progress while another machine says nothing, so that a person sees that something is waited for."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_FIRST, _EVERY = 2.0, 1.0


@contextmanager
def waiting(progress: Callable[[str], None], what: str) -> Iterator[None]:
    """Report every second of the block, from the second one on, how long it has taken so far."""
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

"""Signals that ask a process to end wait until what it has begun is whole, and counted: `with deferring()`.

Within it, what takes long and leaves nothing behind is `interruptible`: a model is built so, then written and noted.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


class _State(threading.local):
    """Of the main thread, the only one in which handlers run; in others it has no effect."""

    def __init__(self) -> None:
        self.defers = [False]
        self.waiting: list[int] = []


_state = _State()


@contextmanager
def deferring() -> Iterator[None]:
    """Let signals wait until the block ends, or one that is `interruptible`; the second of them does not wait.

    Only handlers that call `deferred` know of it.
    """
    try:
        with _set(True):
            yield
    finally:
        _send_again()


@contextmanager
def interruptible() -> Iterator[None]:
    """Within a block that defers signals: hear them at once."""
    with _set(False):
        _send_again()
        yield


def hear_signals() -> None:
    """Hear the signal that waits, if there is one."""
    with interruptible():
        pass


def deferred(number: int) -> bool:
    """Whether a signal that has come is to wait, which it then does: for a handler, before anything else."""
    waits = _state.defers[-1] and not _state.waiting
    _state.waiting[:] = [number] if waits else []
    return waits


def with_deferring(
    handler: Callable[[int, FrameType | None], None],
) -> Callable[[int, FrameType | None], None]:
    """A handler that is called once nothing defers its signal."""

    def handle(number: int, frame: FrameType | None) -> None:
        if not deferred(number):
            handler(number, frame)

    return handle


@contextmanager
def _set(value: bool) -> Iterator[None]:
    _state.defers.append(value)
    try:
        yield
    finally:
        _state.defers.pop()


def _send_again() -> None:
    if _state.waiting and not _state.defers[-1]:
        signal.raise_signal(_state.waiting.pop())

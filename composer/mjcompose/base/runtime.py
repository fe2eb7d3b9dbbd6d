"""How this process runs: where it looks for modules and programs, when signals arrive, when garbage is collected."""

from __future__ import annotations

import atexit
import gc
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType

_SEARCHED = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FALLBACK_LIBRARY_PATH")
"""Variables with folders in which programs, modules and libraries are searched."""


def without_current_folder(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment whose search paths have only absolute folders: an empty entry is the current folder.

    >>> without_current_folder({"PATH": "/usr/bin::bin:.", "PYTHONPATH": "", "HOME": "/root"})
    {'HOME': '/root', 'PATH': '/usr/bin'}
    """
    result = {name: value for name, value in environment.items() if name not in _SEARCHED}
    for name in _SEARCHED:
        folders = absolute_folders(environment.get(name, ""))
        if folders:
            result[name] = os.pathsep.join(folders)
    result.setdefault("PATH", os.defpath)  # without it, some systems search the current folder
    return result


def absolute_folders(path: str) -> list[str]:
    """Return the absolute folders of a search path. No I/O."""
    return [folder for folder in path.split(os.pathsep) if os.path.isabs(folder)]


def forget_current_folder() -> None:
    """Let this process, and Pythons that libraries start, find modules and programs in absolute folders alone.

    Python has made the relative folders of PYTHONPATH absolute when it started.
    """
    for folder in os.environ.get("PYTHONPATH", os.sep).split(os.pathsep):
        if not os.path.isabs(folder) and (place := os.path.abspath(folder)) in sys.path:
            sys.path.remove(place)
    sys.path[:] = [folder for folder in sys.path if os.path.isabs(folder)]
    environment = {**without_current_folder(os.environ), "PYTHONSAFEPATH": "1"}
    for name in os.environ.keys() - environment.keys():
        del os.environ[name]
    os.environ.update(environment)


_FIRST = 700_000
_NEW = 50_000
_YOUNG = 20
_OLD = 50


def rarely_collecting() -> None:
    """Run the garbage collector less often: imports and models create many objects that stay.

    A build of one model creates some 500,000 objects, of which 2,500 are garbage, and ends before the first collection.
    Longer runs then collect as usual.
    """
    gc.set_threshold(_FIRST, _YOUNG, _OLD)
    if _after_the_first not in gc.callbacks:
        gc.callbacks.append(_after_the_first)
        atexit.register(gc.freeze)


def _after_the_first(phase: str, info: dict[str, int]) -> None:
    gc.set_threshold(_NEW, _YOUNG, _OLD)
    gc.callbacks.remove(_after_the_first)


class _State(threading.local):
    def __init__(self) -> None:
        self.defers = [False]
        self.waiting: list[int] = []


_state = _State()
_heard: list[float] = []
_SECONDS = 0.3
"""The time that other processes get to end after a signal to this process."""


@contextmanager
def deferring() -> Iterator[None]:
    """Defer a signal to handlers of `deferred` until the block ends or is `interruptible`; a second one is not."""
    try:
        with _set(True):
            yield
    finally:
        _send_again()


@contextmanager
def interruptible() -> Iterator[None]:
    """Within a block that defers signals, handle them at once."""
    with _set(False):
        _send_again()
        yield


def hear_signals() -> None:
    """Handle the deferred signal, if there is one."""
    with interruptible():
        pass


def deferred(number: int) -> bool:
    """Return whether to defer a signal, and remember it in that case. A handler calls this first."""
    _heard.append(time.monotonic())
    waits = _state.defers[-1] and not _state.waiting
    _state.waiting[:] = [number] if waits else []
    return waits


def patience(most: float) -> float:
    """Return the seconds to wait for other processes to end: at most `most`, and fewer after a signal."""
    return min(most, max(0.0, _heard[0] + _SECONDS - time.monotonic())) if _heard else most


def with_deferring(handler: Callable[[int, FrameType | None], None]) -> Callable[[int, FrameType | None], None]:
    """Return a handler that is called once its signal is no longer deferred."""

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

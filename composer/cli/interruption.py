"""End in order when the process is interrupted or terminated, so that unfinished output is removed."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from _thread import interrupt_main
from collections.abc import Callable
from types import FrameType
from typing import Any

from composer.processes.deferring import with_deferring

INTERRUPTED, _TERMINATED = 130, 143
_LATER = 0.02
_SECONDS_TO_END = 0.7
_CUT_SHORT = b"\ninterrupted: the next run removes what this one leaves behind\n"


def end_in_order() -> None:
    """Let SIGTERM raise SystemExit, and Ctrl-C KeyboardInterrupt, at a moment when neither is lost."""
    signal.signal(signal.SIGTERM, _in_time(_terminate))
    # A shell's background jobs ignore Ctrl-C, and must continue to.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _in_time(_interrupt))


def end_in_a_second() -> None:
    """Let both signals end this process within a second, whatever it is doing then."""
    if os.name == "posix":
        heard, told = os.pipe()
        os.set_blocking(told, False)
        signal.set_wakeup_fd(told, warn_on_full_buffer=False)
        threading.Thread(target=_end_anyway, args=(heard,), daemon=True).start()


def _end_anyway(heard: int) -> None:
    """End this process a moment after a signal, even if it waits for something that does not end.

    Its children end with it, and outputs are whole, as after `kill -9`. The system reports the signal here even if the
    main thread never gets to its handlers.
    """
    codes = {signal.SIGTERM: _TERMINATED, signal.SIGINT: INTERRUPTED}
    while True:
        for number in os.read(heard, 64):
            if number in codes:
                time.sleep(_SECONDS_TO_END)
                with contextlib.suppress(Exception):
                    os.write(2, _CUT_SHORT)
                    if (processes := sys.modules.get("composer.processes.process")) is not None:
                        processes.kill_all()
                os._exit(codes[signal.Signals(number)])


_asked: list[int] = []


def exit_code_asked() -> int | None:
    """Return the exit code if a signal asked this process to end and other code replaced the exception."""
    return _asked[-1] if _asked else None


def _terminate(number: int, frame: FrameType | None) -> None:
    _asked.append(_TERMINATED)
    sys.exit(_TERMINATED)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _asked.append(INTERRUPTED)
    signal.default_int_handler(number, frame)


def _in_time(handler: Callable[[int, FrameType | None], Any]) -> Callable[[int, FrameType | None], None]:
    """Return a handler that waits while a module is being imported.

    Compiled modules, such as those of lxml 6.1, drop exceptions, and Python 3.11 turns them into a RuntimeError
    while it creates a class.
    """
    ready = with_deferring(handler)

    def handle(number: int, frame: FrameType | None) -> None:
        if not _imports(frame):
            ready(number, frame)
            return
        later = threading.Timer(_LATER, _send_again, [number])
        later.daemon = True
        later.start()

    return handle


def _send_again(number: int) -> None:
    """Send a signal to the main thread, which may be waiting by now."""
    if sys.platform == "win32":
        interrupt_main(number)
    else:
        signal.pthread_kill(threading.main_thread().ident or 0, number)


def _imports(frame: FrameType | None) -> bool:
    """Return whether a frame is inside the import of a module."""
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False

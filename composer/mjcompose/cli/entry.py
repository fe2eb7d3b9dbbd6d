"""The process of a command: its entry point, its memory, and its end."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import time
from _thread import interrupt_main
from collections.abc import Callable
from functools import cache
from types import FrameType
from typing import Any

from mjcompose.base.runtime import forget_current_folder, rarely_collecting, with_deferring

NO_MEMORY = "not enough memory; `--limit memory=16G` allows more than 8 GiB, if the machine has it"
LEAST = 160 << 20
"""The least bytes of data for a build: OpenBLAS, a part of numpy, ends the process with less."""


def main() -> None:
    """Run the command with the arguments of this process."""
    forget_current_folder()
    end_in_order()
    end_in_a_second()
    rarely_collecting()
    # Pydantic would search all installed packages for its plugins, which takes as long as reading a large recipe.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        from mjcompose.base.limits import in_force

        message = too_little()
        if message is not None:
            sys.exit(message)
        bound(in_force().memory)
        from mjcompose.cli.main import main as command

        command()
    except MemoryError:
        sys.exit(NO_MEMORY)
    except KeyboardInterrupt:  # before the command itself could handle it
        sys.exit(INTERRUPTED)


def bound(memory: int) -> None:
    """Limit the memory for data of this process, in bytes, or keep the user's own limit if it is lower (POSIX)."""
    try:
        import resource
    except ImportError:
        return
    with contextlib.suppress(OSError, ValueError):  # a system without this limit
        allowed = [each for each in _given() if each != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_DATA, (min([memory, *allowed]), _given()[1]))


def ran_out() -> bool:
    """Return whether the process came near its limit: without memory, some C code raises SystemError."""
    try:
        import resource
    except ImportError:
        return False
    most = resource.getrlimit(resource.RLIMIT_DATA)[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return most != resource.RLIM_INFINITY and peak > most / 2


@cache
def _given() -> tuple[int, int]:
    """Return the limits that the user set for this process."""
    import resource

    return resource.getrlimit(resource.RLIMIT_DATA)


def too_little() -> str | None:
    """Return a message if the user allows less memory than any build needs; also make numpy need less."""
    # One thread for each core would take more memory than everything else, and numpy has little to do here.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        import resource
    except ImportError:
        return None
    for kind, option in ((resource.RLIMIT_DATA, "-d"), (resource.RLIMIT_AS, "-v")):
        soft = resource.getrlimit(kind)[0]
        if soft != resource.RLIM_INFINITY and soft < LEAST:
            return (
                f"not enough memory: this process may have {soft >> 20} MiB (`ulimit {option}`), and needs at least"
                f" {LEAST >> 20}"
            )
    return None


INTERRUPTED = 130
_TERMINATED = 143
_LATER = 0.02
_SECONDS_TO_END = 0.7
_CUT_SHORT = b"\ninterrupted: the next run removes what this one leaves behind\n"


def end_in_order() -> None:
    """Make SIGTERM raise SystemExit, and Ctrl-C raise KeyboardInterrupt, at a moment when neither is lost."""
    signal.signal(signal.SIGTERM, _in_time(_terminate))
    # A shell's background jobs ignore Ctrl-C, and must continue to.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _in_time(_interrupt))


def end_in_a_second() -> None:
    """Make both signals end this process within a second, whatever it is doing."""
    if os.name == "posix":
        read_end, write_end = os.pipe()
        os.set_blocking(write_end, False)
        signal.set_wakeup_fd(write_end, warn_on_full_buffer=False)
        threading.Thread(target=_end_anyway, args=(read_end,), daemon=True).start()


def _end_anyway(read_end: int) -> None:
    """End this process shortly after a signal, even if it waits for something that does not end.

    Its children end with it, and outputs are complete, as after `kill -9`. The system reports the signal here even if
    the main thread never gets to its handlers.
    """
    codes = {signal.SIGTERM: _TERMINATED, signal.SIGINT: INTERRUPTED}
    while True:
        for number in os.read(read_end, 64):
            if number in codes:
                time.sleep(_SECONDS_TO_END)
                with contextlib.suppress(Exception):
                    os.write(2, _CUT_SHORT)
                    processes = sys.modules.get("mjcompose.base.processes")
                    if processes is not None:
                        processes.kill_all()
                os._exit(codes[signal.Signals(number)])


_exit_codes: list[int] = []


def requested_exit_code() -> int | None:
    """Return the exit code if a signal asked this process to end and other code replaced the exception."""
    return _exit_codes[-1] if _exit_codes else None


def _terminate(number: int, frame: FrameType | None) -> None:
    _exit_codes.append(_TERMINATED)
    sys.exit(_TERMINATED)


def _interrupt(number: int, frame: FrameType | None) -> None:
    _exit_codes.append(INTERRUPTED)
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
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False

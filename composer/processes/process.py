"""Start a program that ends with this process."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import weakref
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

_GUARD = str(Path(__file__).with_name("guard.py"))
_POSIX = os.name == "posix"
_begun: weakref.WeakSet[Process] = weakref.WeakSet()


class Process(subprocess.Popen[Any]):
    """A program in its own process group, which is killed when this process ends, even by `kill -9`.

    `memory` and `size` limit its data and each file that it writes, in bytes, on POSIX; 0 means no limit. With
    `watches` the program is Python that calls `guard.end_with` itself, with the last two numbers of its command
    line. Takes the other arguments of `subprocess.Popen`. On Windows a job object is used instead, without the
    limits.
    """

    def __init__(
        self, command: Sequence[str], *, memory: int = 0, size: int = 0, watches: bool = False, **options: Any
    ) -> None:
        self._life: int | None = None
        if not _POSIX:
            super().__init__(command, **options)
            from composer.processes.job import tie

            tie(int(getattr(self, "_handle")))  # noqa: B009  it exists on Windows alone
            return
        reading, self._life = os.pipe()
        ends = [str(reading), str(os.getpid())]
        guarded = [sys.executable, "-I", "-S", _GUARD, *ends, str(memory), str(size), *command]
        try:
            super().__init__(
                [*command, *ends] if watches else guarded,
                pass_fds=(reading,),
                start_new_session=True,
                **options,
            )
        except BaseException:
            self.release()
            raise
        finally:
            os.close(reading)
        _begun.add(self)

    def end(self) -> None:
        """Kill the program and all its children, and wait for it."""
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                if _POSIX:
                    os.killpg(self.pid, signal.SIGKILL)
            self.kill()
        self.wait()
        self.release()

    def release(self) -> None:
        """Stop the guard: the program has ended, or is killed now."""
        life, self._life = self._life, None
        if life is not None:
            os.close(life)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            super().__exit__(kind, error, trace)
        finally:
            self.release()

    def __del__(self, *arguments: Any) -> None:
        if getattr(self, "_life", None) is not None:
            with contextlib.suppress(OSError):
                self.release()
        super().__del__(*arguments)


def kill_all() -> None:
    """Kill every program that this process has started, as the last thing that it does."""
    for process in list(_begun):
        if process.returncode is None:
            with contextlib.suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL)


def module_path() -> list[str]:
    """Return this process's sys.path for another Python: absolute, with the folder of this package at the end."""
    path = [str(Path(entry).absolute()) for entry in sys.path]
    root = str(Path(__file__).resolve().parents[2])
    return path if root in path else [*path, root]

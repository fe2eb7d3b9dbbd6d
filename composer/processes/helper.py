"""A warm process that does tasks of one kind, one after another, for its parent."""

from __future__ import annotations

import contextlib
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, TypeVar

from composer.dataclass import dataclass
from composer.processes.deferring import patience
from composer.processes.process import Process, module_path

Task = TypeVar("Task")
Result = TypeVar("Result")
Opening = Callable[[], AbstractContextManager[Callable[[Task], Result]]]
"""Called once in a process, it returns the function that does its tasks. It is pickled, as are tasks and results."""

_SCRIPT = str(Path(__file__).with_name("worker.py"))
_TRIES = 2
_SECONDS_TO_END = 5.0


@dataclass(frozen=True, slots=True)
class Died:
    """There is no result; `how` describes the end of the two processes that had the task, one after the other."""

    how: str


@dataclass(frozen=True, slots=True)
class Undone:
    """A task that could not be done: no process could be started for it, or it raised an exception."""

    task: Any


class Helper:
    """Starts a process if there is none, which imports `modules`; a task whose process dies is tried once more.

    `folder` is its working folder. Only one thread at a time may have tasks done; any thread may end it.
    """

    def __init__(self, modules: Sequence[str] = (), folder: str | None = None) -> None:
        self._modules, self._folder = tuple(modules), folder
        self._process: Process | None = None
        self._is_open = False
        self._lock = threading.Lock()
        self.ends = False

    def start(self) -> None:
        """Start the process unless it runs. Raises OSError."""
        with self._lock:
            if self._process is not None or self.ends:
                return
            self._process = Process(
                [sys.executable, "-I", "-X", f"utf8={sys.flags.utf8_mode}", _SCRIPT],
                watches=True,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                cwd=self._folder,
            )
            self._is_open = False
        assert self._process.stdin is not None
        self._process.stdin.write(pickle.dumps((module_path(), self._modules)))
        self._process.stdin.flush()

    def result(self, opening: bytes, task: Any) -> Any:
        """Return the result of a task, Died or Undone; `opening` is the pickled Opening of all tasks."""
        content = pickle.dumps(task)
        died: list[str] = []
        while len(died) < _TRIES and not self.ends:
            try:
                is_done, answer = self._asked(opening, content)
                return answer if is_done else Undone(task)
            except (OSError, EOFError, pickle.UnpicklingError):
                died.append(self._buried())
        ways = list(dict.fromkeys(each for each in died if each))
        return Died(" and then ".join(ways)) if ways else Undone(task)

    def ask_to_end(self) -> None:
        """Ask the process to clean up and end."""
        with self._lock:
            self.ends = True
            if self._process is not None:
                with contextlib.suppress(OSError):
                    self._process.send_signal(signal.SIGTERM)

    def end(self) -> None:
        """End the process, after a short wait at most."""
        if self._process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience(_SECONDS_TO_END))
            self._process.end()

    def close(self) -> None:
        """Close the pipes to the process, once nobody waits for a result."""
        if self._process is not None:
            _close(self._process)

    def _asked(self, opening: bytes, task: bytes) -> tuple[bool, Any]:
        """Return whether the task was done, and the result. Raises OSError, EOFError and UnpicklingError."""
        self.start()
        process = self._process
        assert process is not None and process.stdin is not None and process.stdout is not None
        if not self._is_open:
            process.stdin.write(opening)
            self._is_open = True
        process.stdin.write(task)
        process.stdin.flush()
        answer: tuple[bool, Any] = pickle.load(process.stdout)
        return answer

    def _buried(self) -> str:
        """Return how the process ended, in words, empty if it never started; the next task starts another one."""
        with self._lock:
            process = self._process
            if process is None:
                return ""
            process.end()
            if not self.ends:
                _close(process)
                self._process = None
        status = process.returncode
        names = {-entry.value: f" ({entry.name})" for entry in signal.Signals}
        return (
            f"ended with signal {-status}{names.get(status, '')}"
            if status < 0
            else f"ended with status {status}"
        )


def _close(process: Process) -> None:
    for pipe in (process.stdin, process.stdout):
        if pipe is not None:
            with contextlib.suppress(OSError):  # unsent data has no receiver any more
                pipe.close()

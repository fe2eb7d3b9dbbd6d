"""Work in child processes: MuJoCo crashes, hangs and grows, and the rest of a run has to go on.

A process does one thing after another, so that what it has loaded serves again; it is replaced when it dies,
takes too long, or has done `RECYCLED` things.
"""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any, TypeVar

Argument = TypeVar("Argument")
Result = TypeVar("Result")

SECONDS = 180.0
RECYCLED = 100


class _Worker:
    """A process that waits for arguments."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        methods = multiprocessing.get_all_start_methods()
        processes = multiprocessing.get_context("fork" if "fork" in methods else None)
        self.connection, there = processes.Pipe()
        self.process = processes.Process(target=_work, args=(function, there))
        self.process.start()
        there.close()
        self.argument: Any = None
        self.deadline = 0.0
        self.done = 0

    def give(self, argument: Any, seconds: float) -> None:
        self.argument = argument
        self.deadline = time.monotonic() + seconds
        self.connection.send(argument)

    def end(self, *, kill: bool = False) -> None:
        if kill:
            self.process.kill()
        with suppress(OSError):
            self.connection.send(None)
        self.process.join()
        self.connection.close()


def each(
    function: Callable[[Argument], Result],
    arguments: Iterable[Argument],
    *,
    failed: Callable[[Argument, str], Result],
    workers: int = 2,
    seconds: float = SECONDS,
) -> Iterator[Result]:
    """`function` of every argument, at most `workers` at a time; the results as they come.

    Where it raises, crashes or takes longer than `seconds`, `failed` gives the result. No argument is None.
    """
    waiting = iter(arguments)
    running: dict[Connection, _Worker] = {}

    def next_for(worker: _Worker | None) -> None:
        for argument in waiting:
            if worker is None or worker.done >= RECYCLED:
                if worker is not None:
                    worker.end()
                worker = _Worker(function)
            worker.give(argument, seconds)
            running[worker.connection] = worker
            return
        if worker is not None:
            worker.end()

    try:
        for _ in range(workers):
            next_for(None)
        while running:
            ready = wait(list(running), timeout=1.0)
            for connection, worker in list(running.items()):
                late = connection not in ready and time.monotonic() > worker.deadline
                if connection not in ready and not late:
                    continue
                del running[connection]
                result, alive = _result(worker, failed, f"took longer than {seconds:g} s" if late else "")
                if alive:
                    worker.done += 1
                    next_for(worker)
                else:
                    worker.end(kill=True)
                    next_for(None)
                yield result
    finally:
        for worker in running.values():
            worker.end(kill=True)


def _result(worker: _Worker, failed: Callable[[Any, str], Any], late: str) -> tuple[Any, bool]:
    """The result of a worker, and whether it can go on."""
    if late:
        return failed(worker.argument, late), False
    try:
        fine, result = worker.connection.recv()
    except (EOFError, OSError):
        worker.process.join()
        return failed(worker.argument, f"the process died with {worker.process.exitcode}"), False
    return (result if fine else failed(worker.argument, result)), True


def _silence() -> None:
    """MuJoCo and dm_control warn on the standard error, where the progress is shown."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)


def _work(function: Callable[[Any], Any], there: Connection) -> None:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        os.chdir(folder)  # MuJoCo writes its log into the working directory
        _silence()
        with suppress(EOFError, OSError):
            while (argument := there.recv()) is not None:
                try:
                    answer: tuple[bool, Any] = (True, function(argument))
                except Exception:
                    answer = (False, traceback.format_exc(limit=-3))
                there.send(answer)
        os.chdir("/")

"""Work in child processes: MuJoCo crashes, hangs and grows, and the rest of a run has to go on."""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import TypeVar

Argument = TypeVar("Argument")
Result = TypeVar("Result")

SECONDS = 180.0


def each(
    function: Callable[[Argument], Result],
    arguments: Iterable[Argument],
    *,
    failed: Callable[[Argument, str], Result],
    workers: int = 2,
    seconds: float = SECONDS,
) -> Iterator[Result]:
    """`function` of every argument, each in a process of its own, at most `workers` at a time; as they come.

    Where a process raises, crashes or takes longer than `seconds`, `failed` gives the result.
    """
    processes = multiprocessing.get_context(
        "fork" if "fork" in multiprocessing.get_all_start_methods() else None
    )
    running: dict[Connection, tuple[BaseProcess, Argument, float]] = {}
    waiting = iter(arguments)
    more = True
    while more or running:
        while more and len(running) < workers:
            try:
                argument = next(waiting)
            except StopIteration:
                more = False
                break
            here, there = processes.Pipe(duplex=False)
            process = processes.Process(target=_work, args=(function, argument, there))
            process.start()
            there.close()
            running[here] = (process, argument, time.monotonic() + seconds)
        ready = wait(list(running), timeout=1.0)
        for connection, (process, argument, deadline) in list(running.items()):
            if connection in ready:
                yield _result(connection, process, argument, failed)
            elif time.monotonic() > deadline:
                process.kill()
                yield failed(argument, f"took longer than {seconds:g} s")
            else:
                continue
            process.join()
            connection.close()
            del running[connection]


def _work(function: Callable[[Argument], Result], argument: Argument, there: Connection) -> None:
    with tempfile.TemporaryDirectory() as folder:  # MuJoCo writes its log into the working directory
        os.chdir(folder)
        try:
            there.send((True, function(argument)))
        except Exception:
            there.send((False, traceback.format_exc(limit=-3)))
        os.chdir("/")


def _result(
    connection: Connection,
    process: BaseProcess,
    argument: Argument,
    failed: Callable[[Argument, str], Result],
) -> Result:
    try:
        fine, result = connection.recv()
    except EOFError:
        process.join()
        return failed(argument, f"the process died with {process.exitcode}")
    return result if fine else failed(argument, result)  # type: ignore[no-any-return]

"""Warm processes that do many tasks of one kind in parallel; the results are in order for any number of processes."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import TracebackType
from typing import Any, Generic

from composer.processes.deferring import hear_signals, patience
from composer.processes.helper import Died, Helper, Opening, Result, Task, Undone

_AHEAD = 8
_SECONDS_TO_END = 5.0
_LOOK_AGAIN = 0.1  # a longer wait cannot be interrupted on Windows, or while signals are deferred


class Pool(Generic[Task, Result]):
    """Runs this many workers, which import `modules` when the pool is created, and end with the block.

    A worker that dies is replaced, and its task is tried once more. For each process, at most `_AHEAD` tasks are
    started before the first result is taken, so that memory depends only on the number of workers.
    """

    def __init__(self, workers: int, modules: Sequence[str] = ()) -> None:
        self._shared = _Shared(tuple(modules))
        self._ahead = (workers + 1) * _AHEAD if workers else 1
        self._ready: dict[int, Any] = {}
        self._workers = [_Worker(self._shared) for _ in range(workers)]

    def __enter__(self) -> Pool[Task, Result]:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def results(
        self, opening: Opening[Task, Result], tasks: Iterable[Task], do: Callable[[Task], Result]
    ) -> Iterator[Result | Died]:
        """Yield the result of each task, in the order of the tasks.

        `do` does a task in this process: if all workers are busy, and if a worker failed, so that exceptions are
        raised here.
        """
        if self._workers:
            self._shared.opening = pickle.dumps(opening)
        each, given = iter(tasks), 0
        for taken in range(sys.maxsize):
            while given < taken + self._ahead:
                try:
                    task = next(each)
                except StopIteration:
                    break
                self._shared.todo.put((given, task))
                given += 1
            if taken == given:
                return
            while taken not in self._ready:
                self._go_on(do)
            yield self._ready.pop(taken)

    def finished(self) -> Iterator[Result]:
        """End the workers of an interrupted run, and yield the results that were not taken."""
        self.end()
        with contextlib.suppress(queue.Empty):
            while True:
                number, result = self._shared.done.get_nowait()
                self._ready[number] = result
        for number in sorted(self._ready):
            result = self._ready.pop(number)
            if not isinstance(result, Died | Undone):
                yield result

    def end(self) -> None:
        """End all workers, which remove unfinished work."""
        for worker in self._workers:
            worker.ask_to_end()
        for worker in self._workers:
            self._shared.todo.put(None)
            worker.end()
        self._workers = []

    def _go_on(self, do: Callable[[Task], Result]) -> None:
        """Take a result of a worker; if there is none, do a task here."""
        shared = self._shared
        try:
            number, result = shared.done.get_nowait()
        except queue.Empty:
            try:
                begun = shared.todo.get_nowait()
            except queue.Empty:
                hear_signals()
                try:
                    number, result = shared.done.get(timeout=_LOOK_AGAIN)
                except queue.Empty:
                    return
            else:
                assert begun is not None
                number, result = begun[0], Undone(begun[1])
        self._ready[number] = do(result.task) if isinstance(result, Undone) else result


class _Shared:
    """The state that the workers of a pool share."""

    def __init__(self, modules: tuple[str, ...]) -> None:
        self.modules = modules
        self.opening = b""
        self.todo: queue.SimpleQueue[tuple[int, Any] | None] = queue.SimpleQueue()
        self.done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()


class _Worker:
    """A process, and the thread that gives it tasks."""

    def __init__(self, shared: _Shared) -> None:
        self._shared = shared
        self._helper = Helper(shared.modules)
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def ask_to_end(self) -> None:
        self._helper.ask_to_end()

    def end(self) -> None:
        self._helper.end()
        self._thread.join(patience(_SECONDS_TO_END))
        self._helper.close()

    def _serve(self) -> None:
        shared, helper = self._shared, self._helper
        with contextlib.suppress(OSError):  # tried again with the first task
            helper.start()
        while (begun := shared.todo.get()) is not None and not helper.ends:
            number, task = begun
            shared.done.put((number, helper.result(shared.opening, task)))


def cores() -> int:
    """Return how many processes can run at once on the cores available to this process."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

"""Child processes that end with this process, and pools of them."""

from __future__ import annotations

import contextlib
import ctypes
import itertools
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any, Generic, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.runtime import hear_signals, patience

_GUARD = str(Path(__file__).with_name("guard.py"))
_POSIX = os.name == "posix"
_begun: weakref.WeakSet[Process] = weakref.WeakSet()


class Process(subprocess.Popen[Any]):
    """A program in its own process group, which is killed when this process ends, even by `kill -9`.

    `memory` and `size` limit its data and each file that it writes, in bytes, on POSIX; 0 means no limit. With
    `watches` the program is Python that calls `guard.end_with` itself, with the last two numbers of its command
    line. On Windows a job object is used instead, without the limits.
    """

    def __init__(
        self, command: Sequence[str], *, memory: int = 0, size: int = 0, watches: bool = False, **options: Any
    ) -> None:
        self._life: int | None = None
        if not _POSIX:
            super().__init__(command, **options)
            tie(int(getattr(self, "_handle")))  # noqa: B009  it exists on Windows alone
            return
        reading, self._life = os.pipe()
        ends = [str(reading), str(os.getpid())]
        guarded = [sys.executable, "-I", "-S", _GUARD, *ends, str(memory), str(size), *command]
        try:
            super().__init__(
                [*command, *ends] if watches else guarded, pass_fds=(reading,), start_new_session=True, **options
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
        """Stop the guard, because the program has ended or is being killed."""
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
    """Kill every program that this process has started; the last action of the process."""
    for process in list(_begun):
        if process.returncode is None:
            with contextlib.suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL)


def module_path() -> list[str]:
    """Return this process's sys.path for another Python: absolute, with the folder of this package at the end."""
    path = [str(Path(entry).absolute()) for entry in sys.path]
    root = str(Path(__file__).resolve().parents[2])
    return path if root in path else [*path, root]


_EXTENDED_LIMITS, _KILL_ON_JOB_CLOSE = 9, 0x2000
# sizeof(JOBOBJECT_EXTENDED_LIMIT_INFORMATION) in pointers is 18 on 64 bits; the flags follow two 64-bit times
_SIZE, _FLAGS_AT = 144, 16


def tie(handle: int) -> None:
    """End a process and all its children together with this one. Errors of the system are ignored."""
    kernel, job = _kernel_and_job()
    if job:
        kernel.AssignProcessToJobObject(job, ctypes.c_void_p(handle))


@cache
def _kernel_and_job() -> tuple[Any, Any]:
    kernel = getattr(ctypes, "windll").kernel32  # noqa: B009  it exists on Windows alone
    kernel.CreateJobObjectW.restype = ctypes.c_void_p
    job = ctypes.c_void_p(kernel.CreateJobObjectW(None, None))
    limits = ctypes.create_string_buffer(_SIZE)
    ctypes.memmove(ctypes.addressof(limits) + _FLAGS_AT, _KILL_ON_JOB_CLOSE.to_bytes(4, "little"), 4)
    kernel.SetInformationJobObject(job, _EXTENDED_LIMITS, limits, _SIZE)
    return kernel, job


Task = TypeVar("Task")
Result = TypeVar("Result")
Opening = Callable[[], AbstractContextManager[Callable[[Task], Result]]]
"""Called once in a process, it returns the function that does its tasks. It is pickled, as are tasks and results."""

_TRIES = 2
_SECONDS_TO_END = 5.0


class Died(Struct):
    """There is no result; `how` describes the end of the two processes that had the task, one after the other."""

    how: str


class Undone(Struct):
    """A task that no process could do: none could be started for it, or the task raised an exception."""

    task: Any


class Helper:
    """Starts a process that imports `modules` in `folder` if none runs, and retries a task if the process dies."""

    def __init__(self, modules: Sequence[str] = (), folder: str | None = None) -> None:
        self._modules, self._folder = tuple(modules), folder
        self._process: Process | None = None
        self._is_open = False
        self._lock = threading.Lock()
        self.ends = False

    def start(self) -> None:
        with self._lock:
            if self._process is not None or self.ends:
                return
            self._process = Process(
                [sys.executable, "-I", "-X", f"utf8={sys.flags.utf8_mode}", _GUARD, "worker"], watches=True,
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=self._folder,
            )  # fmt: skip
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
        """End the process, after at most a short wait."""
        if self._process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience(_SECONDS_TO_END))
            self._process.end()

    def close(self) -> None:
        for pipe in () if self._process is None else (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):  # unsent data has no receiver any more
                    pipe.close()

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
        """Return in words how the process ended, or "" if it never started; the next task starts another process."""
        with self._lock:
            process = self._process
            if process is None:
                return ""
            process.end()
            if not self.ends:
                self.close()
                self._process = None
        status = process.returncode
        names = {-entry.value: f" ({entry.name})" for entry in signal.Signals}
        return f"ended with signal {-status}{names.get(status, '')}" if status < 0 else f"ended with status {status}"


_Item = tuple[int, Any]
"""A task or a result, with its number."""
_AHEAD = 8
_LOOK_AGAIN = 0.1  # a longer wait cannot be interrupted on Windows, or while signals are deferred


class Pool(Generic[Task, Result]):
    """Runs this many workers, which import `modules` when the pool is created, and end with the block.

    A worker that dies is replaced, and its task is tried once more. For each process, at most `_AHEAD` tasks are
    started before the first result is taken, so memory depends only on the number of workers.
    """

    def __init__(self, workers: int, modules: Sequence[str] = ()) -> None:
        self._ahead = (workers + 1) * _AHEAD if workers else 1
        self._opening = b""
        self._todo, self._done = queue.SimpleQueue[_Item | None](), queue.SimpleQueue[_Item | None]()
        self._ready: dict[int, Any] = {}
        helpers = [Helper(tuple(modules)) for _ in range(workers)]
        self._workers = [(each, threading.Thread(target=self._serve, args=(each,), daemon=True)) for each in helpers]
        for _, thread in self._workers:
            thread.start()

    def __enter__(self) -> Pool[Task, Result]:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()

    def results(
        self, opening: Opening[Task, Result], tasks: Iterable[Task], do: Callable[[Task], Result]
    ) -> Iterator[Result | Died]:
        """Yield the results in the order of the tasks; `do` runs a task here if all workers are busy or one failed."""
        if self._workers:
            self._opening = pickle.dumps(opening)
        each, given = iter(tasks), 0
        for taken in range(sys.maxsize):
            for task in itertools.islice(each, taken + self._ahead - given):
                self._todo.put((given, task))
                given += 1
            if taken == given:
                return
            while taken not in self._ready:
                self._go_on(do)
            yield self._ready.pop(taken)

    def finished(self) -> Iterator[Result]:
        """End the workers of an interrupted run, and yield the results that were not taken."""
        self.end()
        while (found := _next(self._done)) is not None:
            self._ready[found[0]] = found[1]
        for number in sorted(self._ready):
            result = self._ready.pop(number)
            if not isinstance(result, Died | Undone):
                yield result

    def end(self) -> None:
        """End all workers, which remove unfinished work."""
        for helper, _ in self._workers:
            helper.ask_to_end()
        for helper, thread in self._workers:
            self._todo.put(None)
            helper.end()
            thread.join(patience(_SECONDS_TO_END))
            helper.close()
        self._workers = []

    def _serve(self, helper: Helper) -> None:
        with contextlib.suppress(OSError):  # tried again with the first task
            helper.start()
        while (begun := self._todo.get()) is not None and not helper.ends:
            self._done.put((begun[0], helper.result(self._opening, begun[1])))

    def _go_on(self, do: Callable[[Task], Result]) -> None:
        found = _next(self._done)
        if found is None and (begun := _next(self._todo)) is not None:
            found = begun[0], Undone(begun[1])
        if found is None:
            hear_signals()
            try:
                found = self._done.get(timeout=_LOOK_AGAIN)
            except queue.Empty:
                return
        assert found is not None
        number, result = found
        self._ready[number] = do(result.task) if isinstance(result, Undone) else result


def _next(waiting: queue.SimpleQueue[_Item | None]) -> _Item | None:
    try:
        return waiting.get_nowait()
    except queue.Empty:
        return None


def cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

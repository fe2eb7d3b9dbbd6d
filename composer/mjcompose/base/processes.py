"""The one door to other programs: each child starts here, and ends with this process. Also pools of workers.

A folder that somebody else made can have a `json.py`, a `uv.toml` or a `.git/config`, and many programs obey such files
in their current folder. So a child starts in an empty folder of ours, unless its caller names one and gives the reason.
`PATH` and the like are searched only in their absolute folders: an empty entry means the current folder.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import itertools
import json
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Generic, TypeVar

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import untrusted
from mjcompose.base.limits import in_force
from mjcompose.base.runtime import absolute_folders, hear_signals, patience, without_current_folder
from mjcompose.base.scratch import scratch

PIPE = subprocess.PIPE
DEVNULL = subprocess.DEVNULL
STDOUT = subprocess.STDOUT

_GUARD = str(Path(__file__).with_name("guard.py"))
_OWN = str(Path(__file__).with_name("own_command.py"))
_POSIX = os.name == "posix"
_begun: weakref.WeakSet[Process] = weakref.WeakSet()


class WorkFolder(Struct):
    """The current folder of a child that does not start in an empty one, and the reason for it."""

    path: Path | str
    reason: str


class Overrun(Exception):
    """A program took too long or wrote too much, and was killed; the message says which."""

    def __init__(self, message: str, *, is_late: bool) -> None:
        super().__init__(message)
        self.is_late = is_late


class Process(subprocess.Popen[Any]):
    """A program in its own process group, which is killed when this process ends, even by `kill -9`.

    It starts in an empty folder if `folder` is None, without standard input unless the caller gives it one. The first
    word of the command is the name of a program in an absolute folder of `PATH`, or an absolute path. `memory` and
    `size` limit its data and each file that it writes, in bytes, on POSIX; None means the limit `memory` of this run,
    0 means no limit. With `watches` the program is Python that calls `guard.end_with` itself, with the last two numbers
    of its command line, and limits itself. On Windows a job object is used instead, without the limits.

    Raises OSError if the program does not exist or there is no trusted folder for temporary files.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        folder: WorkFolder | None = None,
        env: Mapping[str, str] | None = None,
        memory: int | None = None,
        size: int = 0,
        watches: bool = False,
        **options: Any,
    ) -> None:
        self._life: int | None = None
        environment = without_current_folder(os.environ if env is None else env)
        command = [_located(command[0], environment), *command[1:]]
        if "cwd" in options:
            raise TypeError("name the folder and the reason for it, as a WorkFolder")
        options = {"stdin": DEVNULL, **options, "env": environment}
        options["cwd"] = empty_folder() if folder is None else folder.path
        if not _POSIX:
            super().__init__(command, **options)
            tie(int(getattr(self, "_handle")))  # noqa: B009  it exists on Windows alone
            return
        reading, self._life = os.pipe()
        ends = [str(reading), str(os.getpid())]
        bounds = [str(in_force().memory if memory is None else memory), str(size)]
        guarded = isolated(sys.executable, ["-S", _GUARD, *ends, *bounds, *command])
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

    def finish(self, *, seconds: float, most: int, content: bytes = b"") -> tuple[bytes, bytes]:
        """Return the output and the last part of the errors once the program has ended; `content` is its input.

        Raises Overrun if it takes longer than `seconds`, or if its output has more than `most` bytes.
        """
        output = _Reader(self.stdout, most, self.end)
        errors = _Reader(self.stderr, _MOST_ERRORS, None)
        writer = threading.Thread(target=self._write, args=(content,), daemon=True)
        writer.start()
        try:
            self.wait(min(seconds, threading.TIMEOUT_MAX))
        except subprocess.TimeoutExpired:
            raise Overrun(f"it takes longer than {seconds:g} s", is_late=True) from None
        finally:
            self._end_group()
            self.end()
            for thread in (writer, output.thread, errors.thread):
                thread.join(_SECONDS_TO_END)  # a program in another group may hold its pipes open
        if output.is_over:
            raise Overrun(f"it prints more than {most} bytes", is_late=False)
        return output.content, errors.content

    def _end_group(self) -> None:
        """Kill the programs that it has started and left. The guard keeps their group from getting another meaning."""
        if _POSIX:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self.pid, signal.SIGKILL)

    def _write(self, content: bytes) -> None:
        if self.stdin is not None:
            with contextlib.suppress(OSError, ValueError):  # it has ended, or reads nothing
                self.stdin.write(content)
                self.stdin.close()

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
        life = self._life
        self._life = None
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


_MOST_ERRORS = 64 << 10
_PIECE = 64 << 10


class _Reader:
    """Reads a pipe to its end and keeps at most `most` bytes: the first if `stop` is called for more, else the last."""

    def __init__(self, pipe: IO[bytes] | None, most: int, stop: Callable[[], None] | None) -> None:
        self.is_over = False
        self._pieces: list[bytes] = []
        self._pipe = pipe
        self._most = most
        self._stop = stop
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self) -> None:
        if self._pipe is None:
            return
        size = 0
        with contextlib.suppress(OSError, ValueError), self._pipe as pipe:  # closed from this side
            while piece := os.read(pipe.fileno(), _PIECE):
                self._pieces.append(piece)
                size += len(piece)
                if size <= self._most:
                    continue
                if self._stop is not None:
                    self.is_over = True
                    self._stop()
                    break
                self._pieces = [self.content[-self._most :]]
                size = len(self._pieces[0])

    @property
    def content(self) -> bytes:
        """The bytes that it has read and kept."""
        return b"".join(self._pieces)


def kill_all() -> None:
    """Kill every program that this process has started; the last action of the process."""
    for process in list(_begun):
        if process.returncode is None:
            with contextlib.suppress(OSError):
                os.killpg(process.pid, signal.SIGKILL)


_emptied: dict[int, Path] = {}
"""The empty folder of this process, by its number: a forked process makes its own."""
_emptying = threading.Lock()
_until_exit = ExitStack()
atexit.register(_until_exit.close)


def empty_folder() -> Path:
    """Return an empty folder of ours, which this process removes at its end. Raises OSError."""
    with _emptying:
        folder = _emptied.get(os.getpid())
        if folder is None or not os.path.isdir(folder) or os.listdir(folder):
            folder = _until_exit.enter_context(scratch("empty"))
            why = untrusted(folder.parent.parent, is_temporary=True)
            if why is not None:
                raise PermissionError(
                    f"the folder for temporary files, `{folder.parent.parent}`, is not trusted: {why}"
                )
            folder.chmod(0o500)
            _emptied[os.getpid()] = folder
        return folder


def program(name: str, environment: Mapping[str, str]) -> str | None:
    """Return the path of a program in the absolute folders of `PATH`, or None.

    `shutil.which` also searches relative folders, and on Windows the current one.
    """
    endings = [""] if _POSIX else ["", *environment.get("PATHEXT", ".COM;.EXE;.BAT;.CMD").split(os.pathsep)]
    for folder in absolute_folders(environment.get("PATH", os.defpath)):
        for ending in endings:
            path = os.path.join(folder, name + ending)
            if os.path.isfile(path) and os.access(path, os.X_OK):
                return path
    return None


def _located(name: str, environment: Mapping[str, str]) -> str:
    if os.path.isabs(name):
        return name
    path = None if os.path.dirname(name) else program(name, environment)
    if path is None:
        raise FileNotFoundError(f"there is no program `{name}` in the absolute folders of PATH")
    return path


def isolated(python: str, words: Sequence[str]) -> list[str]:
    """Return the command of a Python that imports only its own packages, and obeys no variable of Python.

    >>> isolated("/usr/bin/python3", ["-c", "print()"])
    ['/usr/bin/python3', '-I', '-c', 'print()']
    """
    return [python, "-I", *words]


def open_in_browser(address: str) -> None:
    """Open an address in the user's browser; the result of that is unknown."""
    if os.name == "nt":  # Windows itself starts the browser, which a job object of ours would end
        import webbrowser

        webbrowser.open_new_tab(address)
        return
    command = isolated(sys.executable, ["-m", "webbrowser", address])
    with contextlib.suppress(OSError, Overrun), Process(command, stdout=DEVNULL, memory=0) as process:
        process.finish(seconds=_SECONDS_TO_OPEN, most=0)


def own_command(*words: str) -> list[str]:
    """Return `mjcompose WORDS` as a command for this Python, with the module path of this process."""
    if not sys.executable:
        raise FileNotFoundError("this Python does not know its own executable")
    utf8 = f"utf8={sys.flags.utf8_mode}"
    return isolated(sys.executable, ["-X", utf8, _OWN, json.dumps(module_path()), *words])


def module_path() -> list[str]:
    """Return the absolute folders of this process's sys.path for another Python, and the folder of this package."""
    path = [entry for entry in sys.path if os.path.isabs(entry)]
    root = str(Path(__file__).resolve().parents[2])
    return path if root in path else [*path, root]


_EXTENDED_LIMITS = 9
_KILL_ON_JOB_CLOSE = 0x2000
# sizeof(JOBOBJECT_EXTENDED_LIMIT_INFORMATION) in pointers is 18 on 64 bits; the flags follow two 64-bit times
_SIZE = 144
_FLAGS_AT = 16


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
_SECONDS_TO_OPEN = 3600.0  # a browser of the terminal ends with its page


class Died(Struct):
    """There is no result; `how` describes the end of the two processes that had the task, one after the other."""

    how: str


class Undone(Struct):
    """A task that no process could do: none could be started for it, or the task raised an exception."""

    task: Any


class Helper:
    """Starts a process that imports `modules` in `folder` if none runs, and retries a task if the process dies."""

    def __init__(self, modules: Sequence[str] = (), folder: str | None = None) -> None:
        self._modules = tuple(modules)
        self._folder = folder
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
                isolated(sys.executable, ["-X", f"utf8={sys.flags.utf8_mode}", _GUARD, "worker"]),
                watches=True,
                stdin=PIPE,
                stdout=PIPE,
                folder=WorkFolder(self._folder or os.getcwd(), "tasks name files from it"),
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
        """End the process, after at most a short wait."""
        if self._process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(patience(_SECONDS_TO_END))
            self._process.end()

    def close(self) -> None:
        """Close the pipes to the process, once nobody waits for a result."""
        if self._process is not None:
            for pipe in (self._process.stdin, self._process.stdout):
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
        self._todo = queue.SimpleQueue[_Item | None]()
        self._done = queue.SimpleQueue[_Item | None]()
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
        each = iter(tasks)
        given = 0
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
    """Return how many processes can run at once on the cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

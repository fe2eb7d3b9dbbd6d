"""A process that may only read and calculate, and that answers one call.

`call_confined` starts this file as a script, which reads its task as one line of JSON, gives up its rights, calls the
function and answers with one line. On Linux, Landlock forbids writing, new programs, connections and all files but
those named; seccomp allows only the system calls that reading needs. Except on Windows, limits forbid new processes
(except for root) and large files. If the system refuses one of these, the call fails: nothing runs half confined.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import platform
import stat
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any

_MOST_OUTPUT = 256 << 20
_MEMORY = 2 << 30


class Unconfined(Exception):
    """The system can confine a process, but refused to do it."""


def call_confined(
    function: str, argument: Any, readable: Iterable[str], *, seconds: float, memory: int
) -> dict[str, Any]:
    """Call `function` (`module:name`) with JSON data in a new process that can read `readable`, and Python's own files.

    The answer has `ok`, `value` (JSON data) and `confined`, how it was confined; or `error` and `crash`, which is
    `timeout`, `output`, `memory`, `unconfined`, `start` or `exit N`. An exception of the function is an `error` without
    `crash`.
    """
    from mjcompose.base.processes import PIPE, Overrun, Process, isolated, module_path

    task = {
        "path": module_path(),
        "function": function,
        "argument": argument,
        "readable": sorted(readable),
        "memory": min(memory, _MEMORY),
        "seconds": seconds,
    }
    try:
        process = Process(
            isolated(sys.executable, ["-X", "utf8", __file__]),
            watches=True,
            stdin=PIPE,
            stdout=PIPE,
            stderr=PIPE,
        )
    except (OSError, ValueError) as error:
        return _failure(f"no process can be started: {error}", "start")
    content = json.dumps(task).encode() + b"\n"
    try:
        out, words = process.finish(seconds=seconds, most=_MOST_OUTPUT, content=content)
    except Overrun as overrun:
        return _failure(str(overrun), "timeout" if overrun.is_late else "output")
    try:
        answer = json.loads(out)
    except ValueError:
        answer = None
    if isinstance(answer, dict):
        return answer
    last = (words.decode("utf-8", "replace").strip().splitlines() or [""])[-1]
    if "MemoryError" in last:
        return _failure("it needs more memory than it may have", "memory")
    status = process.returncode
    return _failure(f"its process ended with status {status}{': ' + last[:200] if last else ''}", f"exit {status}")


def _failure(error: str, crash: str | None) -> dict[str, Any]:
    return {"ok": False, "error": error, "crash": crash}


def main() -> None:
    answers = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    task = json.loads(sys.stdin.readline())
    sys.path[:] = task["path"]
    if os.name == "posix":  # on Windows, a job object does it
        from mjcompose.base.guard import end_with

        end_with(*map(int, sys.argv[1:]))
    answers.write(json.dumps(_answer(task)))
    answers.flush()
    os._exit(0)  # whatever the call has left behind does not run any more


def _answer(task: dict[str, Any]) -> dict[str, Any]:
    module, _, name = task["function"].partition(":")
    try:
        function = getattr(import_module(module), name)
        for each in getattr(sys.modules[module], "BEFORE", ()):
            with contextlib.suppress(ImportError):  # the function says so itself
                import_module(each)
        confined = confine((*task["readable"], *python_folders()), task["memory"], task["seconds"])
        return {"ok": True, "value": function(task["argument"]), "confined": confined}
    except Unconfined as error:
        return _failure(f"its process cannot be confined: {error}", "unconfined")
    except MemoryError:
        return _failure("it needs more memory than it may have", "memory")
    except Exception as error:
        return _failure(f"{type(error).__name__}: {error}", None)


def probe(argument: str) -> dict[str, bool]:
    """Return whether a confined process, this one, can write to a folder (the argument), connect, start a process."""
    import socket

    def is_possible(attempt: Callable[[], object]) -> bool:
        try:
            attempt()
        except (OSError, AttributeError):
            return False
        return True

    def started() -> None:
        if os.fork() == 0:
            os._exit(0)

    return {
        "write": is_possible(lambda: os.open(os.path.join(argument, "written"), os.O_WRONLY | os.O_CREAT)),
        "connect": is_possible(lambda: socket.socket().close()),
        "start a process": is_possible(started),
    }


def confine(readable: Sequence[str], memory: int = 0, seconds: float = 0) -> list[str]:
    """Give up all rights of this single-threaded process except reading `readable`; return the ways."""
    ways = []
    if sys.platform == "linux":
        kernel = _Kernel()
        if len(os.listdir("/proc/self/task") if os.path.isdir("/proc/self/task") else "1") != 1:
            raise Unconfined("it has several threads")
        if _limit(memory, seconds):
            ways.append("limits")
        if kernel.no_new_privileges():
            for way in (_landlock(kernel, readable), _seccomp(kernel)):
                ways += [way] if way else []
    elif _limit(memory, seconds):
        ways.append("limits")
    return ways


def python_folders() -> list[str]:
    """The folders of Python and of the modules that are loaded: `sys.path` may name the user's own folder."""
    files = [getattr(each, "__file__", None) for each in list(sys.modules.values())]
    found = [sys.prefix, sys.base_prefix, sys.exec_prefix, sys.base_exec_prefix]
    found += [os.path.dirname(each) for each in files if isinstance(each, str)]
    return sorted({each for each in found if each and os.path.isabs(each) and each != os.sep})


def _limit(memory: int, seconds: float) -> bool:
    """Set limits that the process cannot raise again; return whether the system has such limits."""
    try:
        import resource
    except ImportError:
        return False
    limits = [("CORE", 0), ("NPROC", 0), ("FSIZE", _MOST_OUTPUT), ("NOFILE", 64)]
    limits += [("DATA", memory), ("AS", 2 * memory)] if memory else []
    limits += [("CPU", int(time.process_time() + seconds) + 5)] if seconds else []
    for name, value in limits:
        kind = getattr(resource, f"RLIMIT_{name}", None)
        if kind is None:
            continue
        hard = resource.getrlimit(kind)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        try:
            resource.setrlimit(kind, (value, value))
        except (OSError, ValueError) as error:
            if sys.platform == "linux":  # macOS has some of them in name alone
                raise Unconfined(f"the limit {name} cannot be set: {error}") from error
    return True


class _Kernel:
    """Calls Linux through the C library; a call returns its result, or its negated error number."""

    def __init__(self) -> None:
        import ctypes

        self._ctypes = ctypes
        self._library = ctypes.CDLL(None, use_errno=True)
        self.machine = platform.machine()

    def no_new_privileges(self) -> bool:
        """Promise to gain no rights by starting programs; return whether the kernel knows the promise."""
        said = self.prctl(38, 1)
        if said not in (0, -errno.EINVAL):
            raise Unconfined(f"no_new_privs: {os.strerror(-said)}")
        return said == 0

    def syscall(self, number: int, *arguments: Any) -> int:
        return self._said(self._library.syscall, self._ctypes.c_long, number, *arguments)

    def prctl(self, option: int, *arguments: Any) -> int:
        return self._said(self._library.prctl, self._ctypes.c_int, option, *(*arguments, 0, 0, 0, 0)[:4])

    def _said(self, function: Any, kind: Any, *arguments: Any) -> int:
        long = self._ctypes.c_long
        function.restype = kind
        result = int(function(*[long(each) if isinstance(each, int) else each for each in arguments]))
        return -self._ctypes.get_errno() if result < 0 else result

    def bytes(self, data: bytes) -> Any:
        return self._ctypes.create_string_buffer(data, len(data))

    def address(self, buffer: Any) -> int:
        return int(self._ctypes.addressof(buffer))


_CREATE = 444
_ADD = 445
_RESTRICT = 446
_READ_FILE = 1 << 2
_READ_FOLDER = 1 << 3
_NOT_THERE = (-errno.ENOSYS, -errno.EOPNOTSUPP, -errno.EPERM)
"""The kernel has no Landlock, it is switched off, or a container around this process forbids the query."""
_FILES = {1: 13, 2: 14, 3: 15, 4: 15}
"""The number of file rights that each version of Landlock handles; later ones handle 16."""


def _landlock(kernel: _Kernel, readable: Sequence[str]) -> str | None:
    """Forbid TCP, sockets, signals and all access to files except reading these, as far as the kernel can."""
    version = kernel.syscall(_CREATE, 0, 0, 1)
    if version in _NOT_THERE:
        return None
    if version < 1:
        raise Unconfined(f"Landlock: {os.strerror(-version)}")
    words = [(1 << _FILES.get(version, 16)) - 1, 3 if version >= 4 else 0, 3 if version >= 6 else 0]
    size = 8 if version < 4 else 16 if version < 6 else 24
    attributes = kernel.bytes(b"".join(each.to_bytes(8, sys.byteorder) for each in words))
    rules = _granted(kernel.syscall(_CREATE, attributes, size, 0), "Landlock")
    try:
        for path in readable:
            _may_be_read(kernel, rules, path)
        _granted(kernel.syscall(_RESTRICT, rules, 0), "Landlock")
    finally:
        os.close(rules)
    return f"Landlock {version}"


def _may_be_read(kernel: _Kernel, rules: int, path: str) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except (OSError, ValueError):
        return  # without access, no right is needed
    try:
        is_folder = stat.S_ISDIR(os.fstat(place).st_mode)
        rights = _READ_FILE | (_READ_FOLDER if is_folder else 0)
        beneath = kernel.bytes(rights.to_bytes(8, sys.byteorder) + place.to_bytes(4, sys.byteorder))
        _granted(kernel.syscall(_ADD, rules, 1, beneath, 0), f"Landlock, {path}")
    finally:
        os.close(place)


def _granted(said: int, what: str) -> int:
    if said < 0:
        raise Unconfined(f"{what}: {os.strerror(-said)}")
    return said


_MACHINES = {"x86_64": (0xC000003E, 0), "aarch64": (0xC00000B7, 1)}
"""The kernel's number for a kind of machine, and its column in the table of calls."""
_CALLS: dict[str, tuple[int | None, int | None]] = {
    "read": (0, 63), "write": (1, 64), "close": (3, 57), "stat": (4, None), "fstat": (5, 80), "lstat": (6, None),
    "poll": (7, None), "lseek": (8, 62), "mmap": (9, 222), "mprotect": (10, 226), "munmap": (11, 215),
    "brk": (12, 214), "rt_sigaction": (13, 134), "rt_sigprocmask": (14, 135), "rt_sigreturn": (15, 139),
    "pread64": (17, 67), "readv": (19, 65), "writev": (20, 66), "access": (21, None), "sched_yield": (24, 124),
    "mremap": (25, 216), "madvise": (28, 233), "dup": (32, 23), "dup2": (33, None), "nanosleep": (35, 101),
    "getpid": (39, 172), "exit": (60, 93), "uname": (63, 160), "fcntl": (72, 25), "getcwd": (79, 17),
    "readlink": (89, None), "gettimeofday": (96, 169), "getrlimit": (97, 163), "getrusage": (98, 165),
    "sysinfo": (99, 179), "times": (100, 153), "getuid": (102, 174), "getgid": (104, 176), "geteuid": (107, 175),
    "getegid": (108, 177), "getppid": (110, 173), "sigaltstack": (131, 132), "statfs": (137, 43),
    "fstatfs": (138, 44), "gettid": (186, 178), "futex": (202, 98), "sched_getaffinity": (204, 123),
    "getdents64": (217, 61), "restart_syscall": (219, 128), "fadvise64": (221, 223), "clock_gettime": (228, 113),
    "clock_getres": (229, 114), "clock_nanosleep": (230, 115), "exit_group": (231, 94), "newfstatat": (262, 79),
    "readlinkat": (267, 78), "faccessat": (269, 48), "ppoll": (271, 73), "set_robust_list": (273, 99),
    "dup3": (292, 24), "getrandom": (318, 278), "membarrier": (324, 283), "statx": (332, 291), "rseq": (334, 293),
    "faccessat2": (439, 439),
}  # fmt: skip
"""The system calls of a process that reads and calculates, on both kinds of machines."""
_OPEN = (2, None)
_OPENAT = (257, 56)
_IOCTL = (16, 29)
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | 0o20000000  # O_TMPFILE without O_DIRECTORY
_TERMINAL = 0x5401
"""The request with which Python tests for a terminal, by `ioctl`."""
_CLOSES = 0x5451
"""The request with which Python closes a file for other programs, by `ioctl`."""
_ALLOW = 0x7FFF0000
_KILL = 0x80000000
_REFUSE = 0x00050000


def filter_program(machine: str) -> bytes | None:
    """The program that decides about each system call in Linux; None for machines whose calls are not known here."""
    if machine not in _MACHINES:
        return None
    kind, column = _MACHINES[machine]
    load = 0x20
    equal = 0x15
    has = 0x45
    end = 0x06
    steps = [(load, 0, 0, 4), (equal, 1, 0, kind), (end, 0, 0, _KILL), (load, 0, 0, 0)]
    for numbers in _CALLS.values():
        number = numbers[column]
        if number is not None:
            steps += [(equal, 0, 1, number), (end, 0, 0, _ALLOW)]
    for numbers, argument in ((_OPEN, 1), (_OPENAT, 2)):
        number = numbers[column]
        if number is not None:
            steps += [(equal, 0, 4, number), (load, 0, 0, 16 + 8 * argument), (has, 1, 0, _WRITES)]
            steps += [(end, 0, 0, _ALLOW), (end, 0, 0, _REFUSE | errno.EACCES)]
    steps += [(equal, 0, 4, _IOCTL[column]), (load, 0, 0, 24), (equal, 1, 0, _TERMINAL)]
    steps += [(equal, 0, 1, _CLOSES), (end, 0, 0, _ALLOW)]
    steps += [(end, 0, 0, _REFUSE | errno.ENOSYS)]  # with which the C library knows what to do
    order: Any = sys.byteorder
    return b"".join(
        code.to_bytes(2, order) + bytes((yes, no)) + value.to_bytes(4, order) for code, yes, no, value in steps
    )


def _seccomp(kernel: _Kernel) -> str | None:
    there = kernel.prctl(22, 2, 0)
    if there == -errno.EINVAL:
        return None
    program = filter_program(kernel.machine)
    if program is None:
        return None
    if there != -errno.EFAULT:  # the error for a missing filter
        raise Unconfined(f"seccomp: {os.strerror(-there)}")
    steps = kernel.bytes(program)
    head = (len(program) // 8).to_bytes(2, sys.byteorder) + bytes(6)
    given = kernel.bytes(head + kernel.address(steps).to_bytes(8, sys.byteorder))
    _granted(kernel.prctl(22, 2, kernel.address(given)), "seccomp")
    return "seccomp"


if __name__ == "__main__":
    main()

"""A process that may read and calculate: what it cannot do, and that it does not begin where it cannot be confined."""

from __future__ import annotations

import errno
import os
import socket
import sys
from pathlib import Path
from typing import Any

import pytest
from mjcompose.base import sandbox
from mjcompose.base.sandbox import Unconfined, call_confined, filter_program

linux = pytest.mark.skipif(sys.platform != "linux", reason="of Linux")
ATTEMPTS = """
import ctypes, os, shutil, signal, socket, subprocess, sys, threading, urllib.request
HERE = {folder!r}
def all_of_them(argument):
    library = ctypes.CDLL(None, use_errno=True)
    def called(number):
        if library.syscall(number, 0, 0, 0, 0) < 0:
            raise OSError(ctypes.get_errno(), "refused")
    file = os.path.join(HERE, "mine.txt")
    attempts = dict(
        run=lambda: subprocess.run(["/bin/true"]), system=lambda: os.system("true") and 1 / 0, fork=os.fork,
        execute=lambda: os.execv("/bin/true", ["true"]), spawn=lambda: os.posix_spawn("/bin/true", ["true"], {{}}),
        write=lambda: open(os.path.join(HERE, "new.txt"), "w"), append=lambda: open(file, "a"), both=lambda: open(file, "r+"),
        cut=lambda: os.truncate(file, 0), remove=lambda: os.unlink(file), rename=lambda: os.rename(file, file + "2"),
        folder=lambda: os.mkdir(os.path.join(HERE, "d")), link=lambda: os.symlink("a", os.path.join(HERE, "l")),
        hard=lambda: os.link(file, file + "3"), mode=lambda: os.chmod(file, 0o600), times=lambda: os.utime(file),
        pipe=lambda: os.mkfifo(os.path.join(HERE, "p")), tree=lambda: shutil.rmtree(HERE), unnamed=lambda: os.memfd_create("m"),
        tcp=lambda: socket.create_connection(("127.0.0.1", argument), 1), udp=lambda: socket.socket(type=socket.SOCK_DGRAM),
        unix=lambda: socket.socketpair(), address=lambda: urllib.request.urlopen("http://127.0.0.1", timeout=1),
        signal=lambda: os.kill(os.getppid(), 0), thread=lambda: threading.Thread(target=print).start(),
        secret=lambda: open("/etc/passwd").read(), folders=lambda: os.listdir("/etc"), clone3=lambda: called(435),
        ring=lambda: called(425), trace=lambda: called(101), other=lambda: called(310), bpf=lambda: called(321),
        more=lambda: __import__("resource").setrlimit(__import__("resource").RLIMIT_NOFILE, (4096, 4096)),
    )
    done = []
    for name, attempt in attempts.items():
        try:
            attempt()
        except Exception:
            continue
        done.append(name)
    return dict(done=done, read=open(file).read())
def path(argument):
    return open(argument).read()
def sleeps(argument):
    import time
    time.sleep(60)
def ends(argument):
    os._exit(7)
def fills(argument):
    return len([bytearray(1 << 20) for _ in range(1 << 20)])
def raises(argument):
    raise KeyError("nothing")
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "mine.txt").write_text("mine")
    (tmp_path / "code").mkdir()
    (tmp_path / "code" / "attempts.py").write_text(ATTEMPTS.format(folder=str(tmp_path)))
    monkeypatch.syspath_prepend(tmp_path / "code")
    return tmp_path


def called(function: str, argument: Any = None, *readable: Path, seconds: float = 20) -> dict[str, Any]:
    return call_confined(f"attempts:{function}", argument, map(str, readable), seconds=seconds, memory=1 << 30)


def held() -> tuple[str, ...]:
    return tuple(call_confined("json:dumps", "", (), seconds=20, memory=1 << 30)["confined"])


@linux
@pytest.mark.skipif(len(held()) < 3, reason="this kernel has no Landlock or no seccomp")
def test_it_reads_what_is_named_and_does_nothing_else(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        answer = called("all_of_them", server.getsockname()[1], folder)
    assert answer.get("value") == {"done": [], "read": "mine"}, answer
    assert sorted(each.name for each in folder.iterdir()) == ["code", "mine.txt"]
    assert [each.split()[0] for each in answer["confined"]] == ["limits", "Landlock", "seccomp"]


@linux
def test_what_is_not_named_is_not_read(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not any(each.startswith("Landlock") for each in held()):
        pytest.skip("this kernel has no Landlock")
    other = tmp_path_factory.mktemp("other") / "secret.txt"
    other.write_text("secret")
    monkeypatch.syspath_prepend(other.parent)  # as the folder in which a command is started
    assert called("path", str(other), folder)["error"].startswith("PermissionError")
    assert called("path", str(other), other.parent)["value"] == "secret"
    assert called("path", str(other), other)["value"] == "secret"
    assert called("path", str(other), Path("/"))["value"] == "secret"


def test_how_it_ends_is_the_answer(folder: Path) -> None:
    assert called("raises") == {"ok": False, "error": "KeyError: 'nothing'", "crash": None}
    assert called("ends")["crash"] == "exit 7"
    assert called("sleeps", seconds=1)["crash"] == "timeout"
    assert "error" in called("not_there")
    if os.name == "posix":
        assert called("fills")["crash"] == "memory"


@pytest.mark.parametrize(
    "error", ["Unconfined('x')", "OSError('x')", "MemoryError()", "RecursionError()", "UnicodeError('x')"]
)
@pytest.mark.parametrize("guard", ["_landlock", "_seccomp", "_limit", "confine"])
@linux
def test_a_process_that_is_not_confined_does_not_begin(
    folder: Path, monkeypatch: pytest.MonkeyPatch, guard: str, error: str
) -> None:
    """The module of the function breaks a guard while it is imported, which is before the process is confined."""
    text = (
        f"import sys\nmain = sys.modules['__main__']\nUnconfined = main.Unconfined\n"
        f"def broken(*_):\n    raise {error}\nmain.{guard} = broken\n"
        f"def begins(argument):\n    print('begun', file=sys.stderr)\n    return 'begun'\n"
    )
    (folder / "code" / "breaking.py").write_text(text)
    answer = call_confined("breaking:begins", None, (), seconds=20, memory=1 << 30)
    assert not answer["ok"] and "value" not in answer


class Kernel:
    """A kernel that answers as it is told, and remembers what it was asked."""

    machine = "x86_64"

    def __init__(self, **said: int) -> None:
        self.said = {"version": 7, "create": 1000, "add": 0, "restrict": 0, "there": -errno.EFAULT, "filter": 0} | said
        self.asked: list[str] = []

    def no_new_privileges(self) -> bool:
        return True

    def bytes(self, data: bytes) -> bytes:
        return data

    def address(self, buffer: bytes) -> int:
        return 4096

    def answer(self, what: str) -> int:
        self.asked.append(what)
        return self.said[what]

    def syscall(self, number: int, *arguments: Any) -> int:
        if number == 444:
            return self.answer("version" if arguments[0] == 0 else "create")
        return self.answer({445: "add", 446: "restrict"}[number])

    def prctl(self, option: int, *arguments: Any) -> int:
        return self.answer("there" if arguments[1] == 0 else "filter")


def confined_by(monkeypatch: pytest.MonkeyPatch, kernel: Kernel) -> list[str]:
    monkeypatch.setattr(sandbox, "_Kernel", lambda: kernel)
    monkeypatch.setattr(sandbox, "_limit", lambda *_: True)
    monkeypatch.setattr(sandbox.os, "listdir", lambda _: ["1"])
    monkeypatch.setattr(sandbox.os, "close", lambda _: None)
    return sandbox.confine(["/"])


@linux
@pytest.mark.parametrize(
    "said",
    [
        {"version": -errno.EIO},
        {"version": 0},
        {"create": -errno.EPERM},
        {"create": -errno.ENOSYS},
        {"create": -errno.E2BIG},
        {"add": -errno.EINVAL},
        {"restrict": -errno.EPERM},
        {"restrict": -errno.E2BIG},
        {"there": -errno.EACCES},
        {"there": 0},
        {"filter": -errno.EACCES},
        {"filter": -errno.EINVAL},
    ],
)
def test_what_the_kernel_has_and_refuses_is_an_error(monkeypatch: pytest.MonkeyPatch, said: dict[str, int]) -> None:
    with pytest.raises(Unconfined):
        confined_by(monkeypatch, Kernel(**said))


@linux
@pytest.mark.parametrize(
    ("said", "ways"),
    [
        ({}, ["limits", "Landlock 7", "seccomp"]),
        ({"version": 1}, ["limits", "Landlock 1", "seccomp"]),
        ({"version": -errno.ENOSYS}, ["limits", "seccomp"]),
        ({"version": -errno.EOPNOTSUPP, "there": -errno.EINVAL}, ["limits"]),
    ],
)
def test_what_the_kernel_has_is_used(monkeypatch: pytest.MonkeyPatch, said: dict[str, int], ways: list[str]) -> None:
    assert confined_by(monkeypatch, Kernel(**said)) == ways


@linux
def test_a_process_with_threads_cannot_be_confined(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox.os, "listdir", lambda _: ["1", "2"])
    with pytest.raises(Unconfined, match="threads"):
        sandbox.confine([])


def judged(machine: str, number: int, *arguments: int, kind: int | None = None) -> int:
    """What the program for the kernel says of a call, run step by step."""
    program = filter_program(machine)
    assert program is not None
    order: Any = sys.byteorder
    kind = sandbox._MACHINES[machine][0] if kind is None else kind
    words = [number, kind, 0, 0]
    for each in (*arguments, *[0] * (6 - len(arguments))):
        words += [each & 0xFFFFFFFF, each >> 32]
    at = 0
    held = 0
    while True:
        code = int.from_bytes(program[at : at + 2], order)
        yes = program[at + 2]
        no = program[at + 3]
        value = int.from_bytes(program[at + 4 : at + 8], order)
        at += 8
        if code == 0x20:
            held = words[value // 4]
        elif code == 0x06:
            return value
        else:
            holds = held == value if code == 0x15 else bool(held & value)
            at += 8 * (yes if holds else no)


ALLOW = 0x7FFF0000
NUMBERS = {
    "x86_64": {
        "read": 0,
        "exit_group": 231,
        "openat": 257,
        "clone": 56,
        "fork": 57,
        "vfork": 58,
        "execve": 59,
        "socket": 41,
        "connect": 42,
        "kill": 62,
        "ptrace": 101,
        "unlink": 87,
        "rename": 82,
        "clone3": 435,
        "io_uring_setup": 425,
        "openat2": 437,
        "execveat": 322,
        "bpf": 321,
        "prlimit64": 302,
        "pidfd_open": 434,
        "mount": 165,
        "x32": 1 << 30,
    },
    "aarch64": {
        "read": 63,
        "exit_group": 94,
        "openat": 56,
        "clone": 220,
        "execve": 221,
        "socket": 198,
        "connect": 203,
        "kill": 129,
        "ptrace": 117,
        "unlinkat": 35,
        "renameat": 38,
        "clone3": 435,
        "io_uring_setup": 425,
        "openat2": 437,
        "execveat": 281,
        "bpf": 280,
        "prlimit64": 261,
        "mount": 40,
    },
}


@linux
@pytest.mark.parametrize("machine", NUMBERS)
def test_the_filter_lets_reading_through_and_nothing_else(machine: str) -> None:
    numbers = dict(NUMBERS[machine])
    opened = numbers.pop("openat")
    assert judged(machine, numbers.pop("read")) == judged(machine, numbers.pop("exit_group")) == ALLOW
    assert judged(machine, opened, 0, 0, os.O_RDONLY | os.O_CLOEXEC | os.O_DIRECTORY) == ALLOW
    for flag in (os.O_WRONLY, os.O_RDWR, os.O_CREAT, os.O_TRUNC, os.O_TMPFILE, os.O_RDONLY | os.O_TRUNC):
        assert judged(machine, opened, 0, 0, flag) != ALLOW
    for name, number in numbers.items():
        assert judged(machine, number) != ALLOW, name
    assert judged(machine, 0, kind=0x40000003) == 0x80000000  # the calls of another machine end the process


def test_other_machines_have_no_filter() -> None:
    assert filter_program("riscv64") is None

"""A pipe, a device, a socket, a folder or 10 GB in the place of any file that a command reads is an error at once."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose import LoadError, load

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs pipes and devices")
MODEL = '<mujoco><worldbody><body name="b"><joint/><geom size=".1"/></body></worldbody></mujoco>'


def _socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as made:
        here = Path.cwd()
        os.chdir(path.parent)  # the names of sockets are short
        made.bind(path.name)
        os.chdir(here)


def _sparse(path: Path) -> None:
    path.touch()
    os.truncate(path, 10 << 30)


def _device(path: Path) -> None:
    """A link to one of the system; one of its own for who could replace that, were there a fault."""
    if os.geteuid():
        path.symlink_to("/dev/zero")
        return
    try:
        os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 5))
    except OSError:
        os.mkfifo(path)


KINDS: dict[str, Callable[[Path], object]] = {
    "a pipe": os.mkfifo,
    "a device": _device,
    "a socket": _socket,
    "a folder": Path.mkdir,
    "10 GB": _sparse,
}
# By the file, the commands that read it. `?` marks those that do without it.
PLACES: dict[str, tuple[str, ...]] = {
    "s.yaml": ("build s.yaml", "plan s.yaml", "fmt s.yaml", "fix s.yaml", "lock s.yaml", "view s.yaml --html a.html"),
    "low.yaml": ("build s.yaml --no-cache", "check s.yaml", "tree s.yaml"),
    "s.lock": ("plan s.yaml", "build s.yaml --no-cache", "lock s.yaml", "update s.yaml", "check s.yaml --locked"),
    "values.yaml": ("build s.yaml --set-file values.yaml", "check s.yaml --set-file values.yaml"),
    "arm.xml": ("build s.yaml --no-cache", "diff arm.xml arm.xml", "import arm.xml", "tree arm.xml"),
    "LICENSE": ("? build s.yaml --no-cache",),
    "made.zip": ("verify made.zip", "diff made.zip made.zip", "? build s.yaml -o made.zip --no-cache"),
    "made/manifest.json": ("verify made", "? view made --html a.html", "build s.yaml -o made/ --no-cache"),
    "models.csv": ("ls .", "ls models.csv"),
}  # fmt: skip


@contextmanager
def _in_time(seconds: int = 5) -> Iterator[None]:
    def over(*_: object) -> None:
        raise AssertionError("it waits")

    before = signal.signal(signal.SIGALRM, over)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture
def project(folder: Path) -> Path:
    for name, text in {
        "s.yaml": "recipe: 1\nextends: ./low.yaml\nparams: {x: 1}\n",
        "low.yaml": "recipe: 1\nbase: ./arm.xml\n",
        "arm.xml": MODEL,
        "values.yaml": "x: 2\n",
        "LICENSE": "MIT",
        "models.csv": "path\na.zip\n",
    }.items():
        (folder / name).write_text(text)
    assert run("lock", "s.yaml").exit_code == 0
    for out in ("made.zip", "made/", "made.mjb"):
        assert run("build", "s.yaml", "-o", out).exit_code == 0
    return folder


@pytest.mark.parametrize("place", PLACES)
def test_a_command_says_so_at_once(project: Path, place: str) -> None:
    for kind, make in KINDS.items():
        path = project / place
        path.unlink() if not path.is_dir() else shutil.rmtree(path)
        make(path)
        for command in PLACES[place]:
            arguments = command.removeprefix("? ").split()
            with _in_time():
                result = run(*arguments)
            does_without = command.startswith("?")
            assert does_without or result.exit_code in (1, 2), (command, kind, result.output)
            assert "memory" not in result.stderr and "Traceback" not in result.stderr, (command, kind)
            assert does_without or len(result.stderr) > 10, (command, kind)
        if kind != "a folder":
            assert path.lstat().st_size in (0, 9, 10 << 30) or place == "made.zip", kind  # nobody wrote into it


@pytest.mark.parametrize("file", ["made.mjb", "made.manifest.json", "made.zip"])
def test_load_says_so_at_once(project: Path, file: str) -> None:
    bundle = project / ("made.zip" if file == "made.zip" else "made.mjb")
    for kind, make in KINDS.items():
        path = project / file
        path.unlink() if not path.is_dir() else shutil.rmtree(path)
        make(path)
        with _in_time(), pytest.raises(LoadError) as caught:
            load(bundle)
        assert caught.value.diagnostics[0].code in ("file-unreadable", "file-not-found", "bundle-manifest"), kind

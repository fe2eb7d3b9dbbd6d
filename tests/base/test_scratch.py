"""What a killed process leaves is swept by the next one; what is in use never is."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from mjcompose.base import scratch as module
from mjcompose.base.scratch import locked_folder, scratch, sweep
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.staging import staged_file, write_folder

posix = pytest.mark.skipif(os.name != "posix", reason="needs signals")
HOLDS = """
import sys, time
from mjcompose.base.scratch import scratch
with scratch("engine") as folder:
    (folder / "file").write_text("x")
    print(folder.parent, flush=True)
    time.sleep(300)
"""
WRITES = """
import sys, time
from pathlib import Path
from mjcompose.bundle import staging as folder, staging
from mjcompose.bundle.bundle import Bundle

def swap(stage, target):
    if sys.argv[2] == "between":
        target.replace(staging.backup_path(stage))
    print(stage.parent, flush=True)
    time.sleep(300)

staging._swap = swap
folder.write_folder(Bundle({"model.xml": b"<mujoco/>"}, "model.xml"), Path(sys.argv[1]))
"""


@pytest.fixture(autouse=True)
def own_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(module, "_swept", set())
    return folder


def started(program: str, *arguments: str) -> tuple[subprocess.Popen[str], Path]:
    process = subprocess.Popen([sys.executable, "-c", program, *arguments], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    return process, Path(process.stdout.readline().strip())


def kill(process: subprocess.Popen[str]) -> None:
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert process.stdout is not None
    process.stdout.close()


def test_it_is_gone_after_the_block(own_temporary_folder: Path) -> None:
    with scratch("engine") as folder:
        assert folder.parent.parent == own_temporary_folder and list(folder.iterdir()) == []
    assert list(own_temporary_folder.iterdir()) == []


@posix
def test_what_a_killed_process_left_is_swept_and_what_is_in_use_is_not(own_temporary_folder: Path) -> None:
    process, left = started(HOLDS)
    with scratch("engine"):
        assert left.is_dir()
        assert not sweep(left)
    kill(process)
    assert left.is_dir()
    with scratch("engine"):
        assert left.is_dir()  # each process sweeps once
    module._swept.clear()
    with scratch("engine") as folder:
        assert [each.name for each in own_temporary_folder.iterdir()] == [folder.parent.name]


@posix
def test_what_is_not_ours_stays(own_temporary_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (own_temporary_folder / "mjcompose-notes").mkdir()
    (own_temporary_folder / "mjcompose-file").touch()
    elsewhere = own_temporary_folder.parent / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "lock").touch()
    (own_temporary_folder / "mjcompose-link").symlink_to(elsewhere)
    (own_temporary_folder / "mjcompose-of-another").mkdir()
    (own_temporary_folder / "mjcompose-of-another" / "lock").touch()
    monkeypatch.setattr(os, "getuid", lambda: os.geteuid() + 1)
    with scratch("engine"):
        pass
    monkeypatch.undo()
    names = {each.name for each in own_temporary_folder.iterdir()}
    assert names == {"mjcompose-notes", "mjcompose-file", "mjcompose-link", "mjcompose-of-another"}
    assert elsewhere.is_dir()


@posix
def test_one_that_was_killed_before_it_was_locked(own_temporary_folder: Path) -> None:
    folder = own_temporary_folder / "mjcompose-engine-0"
    folder.mkdir()
    (folder / "new").touch()
    assert not sweep(folder)
    os.utime(folder, (time.time() - 7200,) * 2)
    assert sweep(folder) and not folder.exists()


def test_a_fault_in_the_block_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(KeyError), locked_folder(tmp_path / "mjcompose-x"):
        raise KeyError
    assert not (tmp_path / "mjcompose-x").exists()


@posix
@pytest.mark.parametrize("when", ["before", "between"])
def test_stages_beside_an_output_are_swept_and_the_older_output_is_put_back(tmp_path: Path, when: str) -> None:
    out = tmp_path / "build" / "out"
    bundle = Bundle({"model.xml": b"<mujoco/>"}, "model.xml")
    write_folder(bundle, out)
    (out / "manifest.json").write_text('{"mjcompose": "0", "manifest": 1, "files": [{"path": "model.xml"}]}')
    process, stage = started(WRITES, str(out), when)
    assert stage.parent == out.parent
    kill(process)
    assert out.exists() == (when == "before") and stage.is_dir()
    module._swept.clear()
    write_folder(bundle, out.with_name("other"))
    assert sorted(each.name for each in out.parent.iterdir()) == ["other", "out"]
    assert (out / "manifest.json").is_file()


@posix
def test_a_process_killed_while_it_removes_its_folder_leaves_the_lock(
    own_temporary_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without it nobody could tell whose the folder was: it stayed for ever."""
    seen = []

    def remove(path: object, ignore_errors: bool = False) -> None:
        seen.append((Path(str(path)).name, (folder.parent / "lock").exists()))

    with scratch("engine") as folder:
        monkeypatch.setattr(module.shutil, "rmtree", remove)
    assert seen[0] == ("files", True)


def _folder_with(lock: str) -> Callable[[Path], None]:
    def plant(folder: Path) -> None:
        folder.mkdir()
        if lock == "a file":
            (folder / "lock").touch()
        elif lock == "a folder":
            (folder / "lock").mkdir()
        elif lock == "a pipe":
            os.mkfifo(folder / "lock")
        else:
            (folder / "lock").symlink_to("/etc/hostname")
        (folder / "old-output").write_text("planted")

    return plant


def _file(path: Path) -> None:
    path.write_text("planted")


def _link(path: Path) -> None:
    (path.parent / "linked").mkdir()
    (path.parent / "linked" / "lock").touch()
    (path.parent / "linked" / "kept").touch()
    path.symlink_to("linked")


def _deep(path: Path) -> None:
    """Removing it takes more calls within calls than Python allows."""
    path.mkdir()
    (path / "lock").touch()
    at = os.getcwd()
    os.chdir(path)
    for _ in range(1500):
        os.mkdir("d")
        os.chdir("d")
    os.chdir(at)


@posix
@pytest.mark.parametrize(
    "plant",
    [*map(_folder_with, ("a file", "a folder", "a pipe", "a link")), _file, _link],
    ids=["file", "folder", "pipe", "link", "no folder", "link to a folder"],
)
@pytest.mark.parametrize("name", ["..", "...", ".arm.zip", ".\udce9", ".a\nb"])
def test_a_sweep_never_ends_a_command(tmp_path: Path, name: str, plant: Callable[[Path], None]) -> None:
    work = tmp_path / "work"
    work.mkdir()
    plant(work / f"{name}.tmp-0123456789ab")
    with staged_file(work / "out.xml") as stage:
        stage.write_text("new")
    assert (work / "out.xml").read_text() == "new"
    assert not (work / "linked").exists() or (work / "linked" / "kept").exists()


@posix
def test_a_folder_that_is_too_deep_to_remove_ends_no_command(tmp_path: Path) -> None:
    _deep(tmp_path / ".arm.zip.tmp-0123456789ab")
    with staged_file(tmp_path / "out.xml") as stage:
        stage.write_text("new")
    assert (tmp_path / "out.xml").read_text() == "new"
    subprocess.run(["rm", "-rf", str(tmp_path / ".arm.zip.tmp-0123456789ab")], check=True)

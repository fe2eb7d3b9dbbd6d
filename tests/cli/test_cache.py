from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose.sources import blobs
from mjcompose.sources.fetching import quiet
from mjcompose.sources.store import Store

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Store:
    """The user's store, with one entry of two thousand bytes."""
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    monkeypatch.delenv("MJCOMPOSE_CACHE_SIZE", raising=False)
    store = Store(tmp_path / "store")
    with store.lock("a" * 40, quiet):
        store.add("git", "a" * 40, "git+https://host/robots@v1", lambda to: write(to / "file"), {})
    return store


def write(path: Path) -> None:
    path.write_bytes(bytes(2000))


def test_info(store: Store) -> None:
    assert run("cache", "info").stdout == (
        f"{store.folder}: 2.0 KiB of at most 10.0 GiB, 1 entry\n"
        "    2.0 KiB  git aaaaaaaaaaaa  git+https://host/robots@v1\n"
    )
    told = json.loads(run("cache", "info", "--output-format", "json").stdout)
    assert (told["size"], told["entries"][0]["files"]) == (2000, 1)


def test_prune_keeps_what_is_in_use(store: Store) -> None:
    assert run("cache", "prune").stdout == "removed 0 entries, 0 B\n"
    assert run("cache", "prune", "--size", "1M").stdout == "removed 0 entries, 0 B\n"
    assert run("cache", "prune", "--size", "1K").stdout == "removed 1 entry, 2.0 KiB\n"
    assert store.entries() == []


@pytest.fixture
def mujoco(store: Store) -> Path:
    """A MuJoCo of three thousand bytes in the store, last used before the entry was."""
    folder = store.folder / "mujoco/3.1.6"
    (folder / "lib").mkdir(parents=True)
    (folder / "lib/mujoco.so").write_bytes(bytes(3000))
    blobs.complete(folder)
    os.utime(folder / ".ready", (1, 1))
    return folder


def test_info_has_the_mujocos_of_migrate(store: Store, mujoco: Path) -> None:
    assert run("cache", "info").stdout == (
        f"{store.folder}: 4.9 KiB of at most 10.0 GiB, 1 entry\n"
        "    2.9 KiB  MuJoCo 3.1.6, for `migrate`\n"
        "    2.0 KiB  git aaaaaaaaaaaa  git+https://host/robots@v1\n"
    )
    told = json.loads(run("cache", "info", "--output-format", "json").stdout)
    assert told["mujocos"] == [{"version": "3.1.6", "size": 3000}] and told["size"] == 5000
    (mujoco / ".ready").write_text("")  # as the first version of `migrate` wrote it
    assert json.loads(run("cache", "info", "--output-format", "json").stdout)["mujocos"][0]["size"] == 3000


def test_prune_removes_a_mujoco_that_was_used_longest_ago(store: Store, mujoco: Path) -> None:
    assert run("cache", "prune").stdout == "removed 0 entries, 0 B\n"
    assert run("cache", "prune", "--size", "3K").stdout == "removed 1 entry, 2.9 KiB\n"
    assert not mujoco.exists() and len(store.entries()) == 1


HOLDS = """
import sys
from pathlib import Path
from mjcompose.sources.blobs import gate, hold
with gate(Path(sys.argv[1])):
    hold(Path(sys.argv[1]), "mujoco-3-1-6")
print("held", flush=True)
sys.stdin.read()
"""


def test_a_mujoco_in_use_stays(store: Store, mujoco: Path) -> None:
    command = [sys.executable, "-c", HOLDS, str(store.folder)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT) as process:
        assert process.stdout is not None and process.stdout.readline().strip() == b"held"
        assert run("cache", "prune", "--size", "1K").exit_code == 0
        assert mujoco.exists()
        process.communicate()
    assert run("cache", "prune", "--size", "1K").exit_code == 0
    assert not mujoco.exists()


def test_what_is_left_of_a_mujoco_is_pruned_unless_it_is_being_made(store: Store, mujoco: Path) -> None:
    (mujoco / ".ready").unlink()
    assert "1 unfinished, being fetched now or interrupted" in run("cache", "info").stdout
    with store.lock(blobs.mujoco_key("3.1.6"), quiet):
        assert run("cache", "prune").exit_code == 0
        assert mujoco.exists()
    assert run("cache", "prune").exit_code == 0
    assert not mujoco.exists()


def test_prune_all(store: Store) -> None:
    assert run("cache", "prune", "--all").exit_code == 0
    assert store.entries() == []


def test_prune_to_no_size(store: Store) -> None:
    result = run("cache", "prune", "--size", "lots")
    assert result.exit_code == 2
    assert len(store.entries()) == 1


def test_verify(store: Store) -> None:
    assert run("cache", "verify").stdout == "looked at 1 entry\n"
    file = store.entries()[0].content / "file"
    file.chmod(0o644)
    file.write_bytes(b"")
    result = run("cache", "verify")
    assert result.exit_code == 1
    assert "`file` changed" in result.stderr
    assert run("cache", "verify", "--fix").exit_code == 0
    assert store.entries() == []


@pytest.mark.parametrize(
    ("text", "command"),
    [("", ("verify", "--fix")), ("{}", ("prune", "--all")), (None, ("prune",)), ("[", ("verify", "--fix"))],
)
def test_an_entry_that_nothing_can_be_read_of_is_found_and_removed(
    store: Store, text: str | None, command: tuple[str, ...]
) -> None:
    """No build sees it, and its size is not known: it would stay for ever."""
    (entry,) = store.entries()
    (entry.folder / "entry.json").unlink()
    if text is not None:
        (entry.folder / "entry.json").write_text(text)
    result = run("cache", "verify")
    assert result.exit_code == 1
    assert f"`{entry.folder}` is damaged, and its origin is unknown" in result.stderr
    assert run("cache", *command).exit_code == 0
    assert not entry.folder.exists()
    assert run("cache", "verify").exit_code == 0


def test_a_bound_that_is_none(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE_SIZE", "lots")
    result = run("cache", "info")
    assert result.exit_code == 2
    assert "not a size" in result.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="a file that is gone is locked by nobody there, too")
def test_prune_sweeps_what_killed_processes_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    left = tmp_path / "tmp" / "mjcompose-engine-0123456789ab"
    left.mkdir(parents=True)
    (left / "lock").touch()
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    monkeypatch.setattr("mjcompose.base.scratch._swept", set())
    assert run("cache", "prune").exit_code == 0
    assert not left.exists()

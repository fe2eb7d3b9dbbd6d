from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose.sources.fetching import quiet
from mjcompose.sources.store import Store


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

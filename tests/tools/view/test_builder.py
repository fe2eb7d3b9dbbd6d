"""Waiting for files that change, with the library that knows and without."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Event

import pytest
from mjcompose.base.files import Mark
from mjcompose.tools.view.builder import FileWatch, marks


@pytest.fixture(params=["watchfiles", "polling"])
def watch(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> FileWatch:
    if request.param == "polling":
        monkeypatch.setitem(sys.modules, "watchfiles", None)
    found = FileWatch(Event())
    if found._watchfiles is None and request.param == "watchfiles":
        pytest.skip("watchfiles is not installed")
    return found


def _write(file: Path) -> None:
    file.write_text("new text")


def _rename(file: Path) -> None:
    other = file.with_name("other")
    other.write_text("as old")
    os.replace(other, file)


def _delete(file: Path) -> None:
    file.unlink()


@contextmanager
def waiting(watch: FileWatch, before: dict[Path, Mark], monkeypatch: pytest.MonkeyPatch) -> Iterator[Future[bool]]:
    """The answer of a watch that has looked at the files and waits now."""
    waits = Event()
    sleep = watch._sleep

    def sleeps(folders: set[Path]) -> None:
        waits.set()
        sleep(folders)

    monkeypatch.setattr(watch, "_sleep", sleeps)
    with ThreadPoolExecutor(1) as executor:
        try:
            answer = executor.submit(watch.wait, before)
            assert waits.wait(20) and not answer.done()
            yield answer
        finally:
            watch.stop.set()


@pytest.mark.parametrize("change", [_write, _rename, _delete])
def test_a_change_is_noticed_however_it_is_saved(
    watch: FileWatch, change: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "file"
    file.write_text("as old")
    with waiting(watch, marks([file, tmp_path / "none"]), monkeypatch) as answer:
        change(file)
        assert answer.result(20)


def test_a_file_that_appears_is_a_change(watch: FileWatch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with waiting(watch, marks([tmp_path / "folder" / "file"]), monkeypatch) as answer:
        (tmp_path / "folder").mkdir()
        (tmp_path / "folder" / "file").write_text("")
        assert answer.result(20)


def test_waiting_ends_when_it_is_told_to(watch: FileWatch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with waiting(watch, marks([tmp_path / "file"]), monkeypatch) as answer:
        watch.stop.set()
        assert not answer.result(20)
    assert not watch.wait({tmp_path / "file": (1, 2, 3)})  # nor does a change count then

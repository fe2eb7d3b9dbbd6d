"""Waiting for files that change, with the library that knows and without."""

from __future__ import annotations

import os
import time
from pathlib import Path
from threading import Event, Thread

import pytest

from composer.view import watching
from composer.view.watching import Watch, marks


@pytest.fixture(params=["watchfiles", "polling"])
def watch(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Watch:
    if request.param == "polling":
        monkeypatch.setattr(watching, "_library", lambda: None)
    found = Watch(Event())
    if found.polls and request.param == "watchfiles":
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


@pytest.mark.parametrize("change", [_write, _rename, _delete])
def test_a_change_is_noticed_however_it_is_saved(watch: Watch, change: object, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("as old")
    before = marks([file, tmp_path / "none"])
    Thread(target=lambda: (time.sleep(0.2), change(file))).start()  # type: ignore[operator]
    assert watch.wait(before)


def test_a_file_that_appears_is_a_change(watch: Watch, tmp_path: Path) -> None:
    before = marks([tmp_path / "folder" / "file"])
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "file").write_text("")
    assert watch.wait(before)


def test_waiting_ends_when_it_is_told_to(watch: Watch, tmp_path: Path) -> None:
    Thread(target=lambda: (time.sleep(0.2), watch.stop.set())).start()
    assert not watch.wait(marks([tmp_path / "file"]))

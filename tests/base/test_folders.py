from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.base import files
from mjcompose.base.files import memory_of, real_folder

OLD = 1_000_000_000


@pytest.fixture(autouse=True)
def everything_is_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes are told apart by time alone, so that the test shows what the times are for."""
    monkeypatch.setattr(files, "_SETTLED", -1)


def test_a_folder_is_asked_once_while_it_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    holds = memory_of(("mark",))
    asked: list[str] = []
    monkeypatch.setattr(files.os, "access", lambda path, mode: asked.append(path) is not None)
    assert [holds(str(tmp_path)) for _ in range(3)] == [False] * 3
    assert len(asked) == 1


def test_what_is_put_into_a_folder_or_taken_out_is_seen(tmp_path: Path) -> None:
    holds = memory_of(("mark", "sign"))
    assert not holds(str(tmp_path))
    (tmp_path / "sign").mkdir()
    os.utime(tmp_path, (OLD, OLD))
    assert holds(str(tmp_path))
    (tmp_path / "sign").rmdir()
    os.utime(tmp_path, (OLD + 1, OLD + 1))
    assert not holds(str(tmp_path))
    assert not holds(str(tmp_path / "nowhere"))


def test_a_link_that_leads_elsewhere_now(tmp_path: Path) -> None:
    for name in ("one", "other"):
        (tmp_path / name).mkdir()
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "one")
    assert real_folder(str(link)) == os.path.realpath(tmp_path / "one")
    link.unlink()
    link.symlink_to(tmp_path / "other")
    assert real_folder(str(link)) == os.path.realpath(tmp_path / "other")
    link.unlink()
    assert real_folder(str(link)) == os.path.realpath(link)


def test_what_has_just_changed_is_not_remembered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two changes in one moment may leave the folder with one time."""
    monkeypatch.setattr(files, "_SETTLED", 2_000_000_000)
    holds = memory_of(("mark",))
    monkeypatch.setattr(files.os, "access", lambda path, mode: False)
    assert not holds(str(tmp_path))
    monkeypatch.setattr(files.os, "access", lambda path, mode: True)
    assert holds(str(tmp_path))


def test_ordinary_files_of_a_folder_are_found_by_one_look(tmp_path: Path) -> None:
    for name in "abcdef":
        (tmp_path / name).touch()
    (tmp_path / "d").unlink()
    (tmp_path / "d").symlink_to(tmp_path / "a")
    (tmp_path / "e").unlink()
    (tmp_path / "e").mkdir()
    asked = [str(tmp_path / name) for name in "abcdex"]
    ((folder, found),) = files.files_among(asked)
    assert os.path.samefile(folder, tmp_path)
    assert sorted(found) == asked[:3]
    assert list(files.files_among(asked[:3])) == [], "a few are asked one by one"


def test_a_folder_of_many_files_is_not_read_to_its_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "_LISTED", 1)
    for name in "abcdefghij":
        (tmp_path / name).touch()
    ((_, found),) = files.files_among(str(tmp_path / name) for name in "abcd")
    assert len(found) <= 4


def test_where_a_path_leads(tmp_path: Path) -> None:
    one = tmp_path / "deep" / "one"
    one.mkdir(parents=True)
    (one / "file").touch()
    (tmp_path / "link").symlink_to(one)
    (one / "other").symlink_to(one / "file")
    for path in ("deep/one/file", "link/file", "link/other", "link", "link/none", "link/../one/file", "link/..", "."):
        assert files.real_path(tmp_path / path) == os.path.realpath(tmp_path / path), path

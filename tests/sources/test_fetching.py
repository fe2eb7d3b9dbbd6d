"""How long another machine may say nothing: a number, or an error that says so."""

from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.sources import fetching as nearby
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError


def test_nearest_first_and_no_deeper_than_asked(tmp_path: Path) -> None:
    for name in ("z.xml", "a/b/c/deep.xml", "a/one.yaml", "a/picture.png", ".hidden/x.xml", "__pycache__/y.xml"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    assert nearby.model_files(tmp_path) == ["z.xml", "a/one.yaml", "a/b/c/deep.xml"]
    assert nearby.model_files(tmp_path, depth=1) == ["z.xml", "a/one.yaml"]
    assert nearby.model_files(tmp_path, depth=0) == ["z.xml"]


def test_a_folder_that_is_not_there_has_none(tmp_path: Path) -> None:
    assert nearby.model_files(tmp_path / "gone") == []


def test_links_between_folders_do_not_go_round(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text("")
    (tmp_path / "loop").symlink_to(tmp_path)
    assert nearby.model_files(tmp_path) == ["a.xml"]


def test_a_large_folder_ends_the_search(tmp_path: Path) -> None:
    for index in range(2100):
        (tmp_path / f"{index:04}.txt").touch()
    (tmp_path / "z.xml").touch()
    assert nearby.model_files(tmp_path) == []


def test_only_what_is_near_was_meant() -> None:
    assert nearby.nearest("./tabel.xml", ["./table.xml", "./arm.xml"]) == "./table.xml"
    assert nearby.nearest("./humanoid.xml", ["./table.xml", "./arm.xml"]) is None


@pytest.mark.parametrize("written", ["inf", "1e300", "nan", "0", "-5", "30s", " "])
@pytest.mark.parametrize("reference", ["http://127.0.0.1:9/a.zip#a.xml", "git+http://127.0.0.1:9/a@v1#a.xml"])
def test_what_is_no_time_is_told(written: str, reference: str, own_environment: dict[str, str]) -> None:
    environment = {**own_environment, "MJCOMPOSE_TIMEOUT": written}
    with pytest.raises(SourceError, match="MJCOMPOSE_TIMEOUT") as caught:
        resolve(reference, relative_to=Path(), environment=environment, fetching=Fetching())
    assert caught.value.help == "write it as `30`"

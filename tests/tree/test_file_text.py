from __future__ import annotations

from pathlib import Path

import pytest

from composer.diagnostics.sink import Sink
from composer.tree import file_text
from composer.tree.file_text import FileText
from composer.tree.parse import parse_file


def test_a_file_is_read_when_a_place_in_it_is_asked_for(tmp_path: Path) -> None:
    text = FileText(tmp_path / "later.xml")
    (tmp_path / "later.xml").write_text("<a/>")
    assert text.split().text == "<a/>"
    (tmp_path / "later.xml").write_text("<b/>")
    assert text.split().text == "<a/>"


def test_contents_come_before_the_file(tmp_path: Path) -> None:
    assert FileText(tmp_path / "none.xml", b"<a/>").split().text == "<a/>"


def test_a_file_that_cannot_be_read_has_no_text(tmp_path: Path) -> None:
    assert FileText(tmp_path / "none.xml").split().text == ""
    assert FileText().split().text == ""


def test_copies_of_a_model_split_its_files_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.xml").write_text('<mujoco>\n<worldbody>\n<geom size="1"/>\n</worldbody></mujoco>')
    unit = parse_file(tmp_path / "a.xml", Sink())
    assert unit is not None
    split = []
    source = file_text.SourceText
    monkeypatch.setattr(file_text, "SourceText", lambda data: split.append(data) or source(data))
    for copy in (unit.copied(), unit.copied(), unit):
        assert copy.origins.span(copy.root[0][0], copy.file).column == 1
    assert len(split) == 1


def test_files_know_their_paths_included_ones_too(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text('<mujoco><include file="b.xml"/></mujoco>')
    (tmp_path / "b.xml").write_text('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>')
    unit = parse_file(tmp_path / "a.xml", Sink())
    assert unit is not None
    assert {each.path for each in unit.origins.texts.values()} == {tmp_path / "a.xml", tmp_path / "b.xml"}

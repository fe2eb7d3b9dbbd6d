from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest
from lxml import etree
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.link.expansion import Copy
from mjcompose.tree import unit as file_text
from mjcompose.tree.merged_settings import ReadRow
from mjcompose.tree.parse import parse_file, parse_text
from mjcompose.tree.unit import FileText, KeyValues, PartKeys, Unit, place_of


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


def places(*tags: str) -> list[str]:
    """The sections of a model, the last one put where it belongs."""
    root = etree.fromstring("<mujoco>" + "".join(f"<{tag}/>" for tag in tags[:-1]) + "</mujoco>")
    root.insert(place_of(root, tags[-1]), etree.Element(tags[-1]))
    return [str(child.tag) for child in root]


def test_in_the_order_of_the_reference() -> None:
    assert places("compiler") == ["compiler"]
    assert places("worldbody", "option") == ["option", "worldbody"]
    assert places("compiler", "worldbody", "actuator", "asset") == ["compiler", "asset", "worldbody", "actuator"]
    assert places("worldbody", "sensor", "tendon") == ["worldbody", "tendon", "sensor"]
    assert places("option", "worldbody", "option") == ["option", "option", "worldbody"]


def test_behind_what_comes_before_it_however_the_file_is_ordered() -> None:
    assert places("actuator", "worldbody", "asset", "default") == ["default", "actuator", "worldbody", "asset"]
    assert places("worldbody", "compiler", "default") == ["worldbody", "compiler", "default"]
    assert places("worldbody", "unheard_of") == ["worldbody", "unheard_of"]


TEXT = """<mujoco><compiler fusestatic="true" angle="radian"/><compiler fusestatic="true" boundmass="1"/></mujoco>"""

KEYED = """<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>
<keyframe><key name="home" qpos="1"/></keyframe></mujoco>"""


def test_settings_that_are_forgotten_are_nowhere_written() -> None:
    unit = parse_text(TEXT, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    assert (unit.settings.fusestatic, unit.settings.boundmass) == ("true", "1")
    unit.forget_settings("fusestatic", "boundmass", "fitaabb")
    assert (unit.settings.fusestatic, unit.settings.boundmass, unit.settings.angle) == ("false", "0", "radian")
    assert [dict(each.attrib) for each in unit.root] == [{"angle": "radian"}, {}]


def test_a_copy_has_everything_and_shares_no_element() -> None:
    unit = parse_text(KEYED, Sink(), file="a.xml", directory=Path(), label="a")
    assert unit is not None
    joint = unit.root.find(".//joint")
    element = unit.root.find(".//key")
    assert joint is not None and element is not None
    several = Copy(joint, (2,))
    key = KeyValues("home", None, element, "a.xml", unit.origins, {"qpos": {joint: [], several: []}})
    unit.part_keys = {"arm": PartKeys(1, (key,))}
    unit.table = (ReadRow("link", 1, "body", "", Span("a.xml", 1, 1)),)
    copy = unit.copied()
    for field in fields(Unit):
        if field.name not in ("root", "header", "origins", "part_keys"):
            assert getattr(copy, field.name) == getattr(unit, field.name), field.name
    (kept,) = copy.part_keys["arm"].keys
    assert [*kept.values["qpos"]] == [copy.root.find(".//joint"), Copy(copy.root.find(".//joint"), (2,))]  # type: ignore[arg-type]
    assert [*key.values["qpos"]] == [joint, several]

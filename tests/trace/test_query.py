from __future__ import annotations

import pytest
from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.trace.query import ExplainQuery, find, read
from mjcompose.tree.pattern import BadPattern


def asked(text: str, attribute: str | None = None) -> ExplainQuery:
    sink = Sink()
    found = read(text, attribute, sink)
    assert found is not None and not sink.diagnostics
    return found


@pytest.mark.parametrize(
    ("text", "kinds", "name", "attribute"),
    [
        ("geom gripper/pad", {"geom"}, "gripper/pad", None),
        ("geom gripper/pad friction", {"geom"}, "gripper/pad", "friction"),
        ("joint j", {"joint", "freejoint"}, "j", None),
        ("freejoint j", {"freejoint"}, "j", None),
        ("equality/joint j", {"equality/joint"}, "j", None),
        ("keyframe home", {"keyframe/key"}, "home", None),
        ("class pad", {"default"}, "pad", None),
        ("motor", {"actuator/motor"}, None, None),
        ("gripper/pad", None, "gripper/pad", None),
        ("gripper/pad friction", None, "gripper/pad", "friction"),
        ("option timestep", {"option"}, None, "timestep"),
        ("option flag gravity", {"option/flag"}, None, "gravity"),
        ("visual/headlight ambient", {"visual/headlight"}, None, "ambient"),
        ("compiler", {"compiler"}, None, None),
    ],
)
def test_kind_name_attribute(text: str, kinds: set[str] | None, name: str | None, attribute: str | None) -> None:
    found = asked(text)
    assert (found.kinds, found.name, found.attribute) == (kinds, name, attribute)


def test_a_family_takes_all_of_its_own() -> None:
    kinds = asked("sensor tip").kinds
    assert kinds is not None and {"sensor/force", "sensor/framepos"} < kinds


def test_the_attribute_may_stand_by_itself() -> None:
    assert asked("geom pad", "friction").attribute == "friction"
    assert asked("option", "timestep").attribute == "timestep"


def test_numbers_and_lines() -> None:
    assert (asked("geom#3 size").number, asked("geom#3 size").attribute) == (3, "size")
    assert asked("parts/gripper.xml:12").line == ("parts/gripper.xml", 12)
    assert asked("gripper.xml:12:4").line == ("gripper.xml", 12)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("", "unknown-name"),
        ("goem pad", "unknown-element"),
        ("goem#3", "unknown-element"),
        ("geom a b c", "unknown-name"),
    ],
)
def test_without_meaning(text: str, code: str) -> None:
    sink = Sink()
    assert read(text, None, sink) is None
    assert [each.code for each in sink.errors] == [code]


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("geom /pad[0-9]/", ["pad1", "pad2"]),
        ("geom *", ["pad1", "pad2"]),
        ("geom **", ["pad1", "pad2", "left/pad", None]),
        ("/.*pad/", ["left/pad"]),
    ],
)
def test_names_fit_as_in_a_selector(text: str, names: list[str | None]) -> None:
    geoms = '<geom name="pad1"/><geom name="pad2"/><geom name="left/pad"/><geom/>'
    root = etree.fromstring(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    assert [node.get("name") for node in find(asked(text), root, "/")] == names
    with pytest.raises(BadPattern, match="is not valid"):
        find(asked("/(/"), root, "/")

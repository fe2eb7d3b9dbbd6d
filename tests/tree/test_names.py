from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree
from mjcompose.tree.names import NameIndex, is_list, own_name

ROOT = etree.fromstring(
    '<mujoco><default><default class="c"><geom material="m"/></default></default>'
    '<asset><mesh file="a/part.stl"/><material name="m"/></asset>'
    '<worldbody><body name="b" childclass="c"><geom name="g" class="main" material="m"/>'
    '<camera name="eye" target="world" mode="targetbody"/></body></worldbody>'
    '<deformable><flex name="f" body="b b world"/></deformable>'
    '<sensor><framepos name="s" objtype="geom" objname="g"/></sensor></mujoco>'
)


@pytest.mark.parametrize(
    "file", sorted(Path(__file__).parents[1].glob("golden/*/*.xml")), ids=lambda file: f"{file.parent.name}/{file.stem}"
)
def test_a_whole_tree_is_indexed_as_node_by_node(file: Path) -> None:
    root = etree.parse(file).getroot()
    index = NameIndex()
    whole = NameIndex.of(root)
    for section in root.iterchildren("*"):
        for node in section.iterdescendants("*"):
            index.note(node, str(section.tag))
    assert (index.declared, index.leads_out) == (whole.declared, whole.leads_out)
    assert _in_order(index) == _in_order(whole)


def _in_order(index: NameIndex) -> dict[str, list[tuple[str, list[object]]]]:
    return {space: [(name, list(users)) for name, users in names.items()] for space, names in index.uses.items()}


def test_names_are_found_by_namespace() -> None:
    index = NameIndex.of(ROOT)
    assert {space: list(names) for space, names in index.declared.items()} == {
        "default": ["c"],
        "mesh": ["part"],
        "material": ["m"],
        "body": ["b"],
        "geom": ["g"],
        "camera": ["eye"],
        "flex": ["f"],
        "sensor": ["s"],
    }
    assert index.find("geom", "g") is ROOT.find("worldbody/body/geom")
    assert index.find("geom", "b") is None


def test_references_are_found_from_what_they_refer_to() -> None:
    index = NameIndex.of(ROOT)
    assert [(node.tag, name) for node, name in index.users("material", "m")] == [
        ("geom", "material"),
        ("geom", "material"),
    ]
    assert [name for _, name in index.users("geom", "g")] == ["objname"]
    assert [name for _, name in index.users("body", "b")] == ["body"]
    assert [name for _, name in index.users("default", "c")] == ["childclass"]


def test_world_and_main_are_nobodys_names() -> None:
    index = NameIndex.of(ROOT)
    assert "world" not in index.uses.get("body", {}) and "main" not in index.uses["default"]


def test_what_is_forgotten_is_gone_and_can_come_back() -> None:
    index = NameIndex.of(ROOT)
    geom = ROOT.find("worldbody/body/geom")
    index.forget(geom, "worldbody")
    assert index.find("geom", "g") is None
    assert [node.getparent().tag for node, _ in index.users("material", "m")] == ["default"]
    index.note(geom, "worldbody")
    assert index.find("geom", "g") is geom


def test_an_asset_without_a_name_has_that_of_its_file() -> None:
    assert own_name(ROOT.find("asset/mesh"), "name") == "part"
    assert own_name(ROOT.find("worldbody/body"), "name") == "b"


def test_who_refers_to_a_name_follows_it() -> None:
    root = etree.fromstring(
        '<mujoco><deformable><flex body="b bb b world"/><flex body="b"/></deformable>'
        '<contact><exclude body1="b" body2="bb"/><exclude body1="x" body2="bb"/></contact></mujoco>'
    )
    index = NameIndex.of(root)
    index.follow("body", {"b": "x"})
    assert [flex.get("body") for flex in root.iter("flex")] == ["x bb x world", "x"]
    assert [dict(exclude.attrib) for exclude in root.iter("exclude")] == [{"body1": "x", "body2": "bb"}] * 2
    assert index.uses == NameIndex.of(root).uses and index.users("body", "b") == []


def test_lists_of_names_are_told_from_single_ones() -> None:
    assert is_list(ROOT.find("deformable/flex"), "body", "deformable")
    assert not is_list(ROOT.find("sensor/framepos"), "objname", "sensor")

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from lxml import etree
from mjcompose.tree.edit import (
    BadBone,
    NewName,
    Removal,
    Renaming,
    assign,
    bones,
    changing,
    renamed_skin,
    resolves,
    skins,
    unresolved,
)
from tree.editing import Tree

ARM = (
    '<mujoco><worldbody><body name="a"><geom name="g" size="1" euler="0 0 1" material="m"/></body></worldbody>'
    '<asset><material name="m"/><material name="n"/></asset></mujoco>'
)


def test_references_follow_what_is_written() -> None:
    tree = Tree(ARM)
    geom = tree.find(".//geom")
    assign(tree, geom, {"material": "n"})
    assert tree.names.users("material", "n") == [(geom, "material")] and not tree.names.users("material", "m")
    assign(tree, geom, {"material": None})
    assert not tree.names.users("material", "n") and geom.get("material") is None


def test_an_orientation_replaces_the_others() -> None:
    tree = Tree(ARM)
    geom = tree.find(".//geom")
    assign(tree, geom, {"quat": "1 0 0 0"})
    assert geom.get("euler") is None and geom.get("quat") == "1 0 0 0"


def test_a_change_that_fails_leaves_the_names() -> None:
    tree = Tree(ARM)
    geom = tree.find(".//geom")
    with pytest.raises(ValueError, match="stop"), changing(tree, geom):
        geom.set("name", "h")
        raise ValueError("stop")
    assert tree.find_node("geom", "h") is geom and tree.find_node("geom", "g") is None


REFERENCES_ARM = (
    '<mujoco><worldbody><body name="a"><site name="tip"/></body><replicate count="2"><body name="pad"/></replicate>'
    "</worldbody></mujoco>"
)


def test_what_exists_always_and_what_mujoco_may_make_resolves() -> None:
    tree = Tree(REFERENCES_ARM)
    assert resolves(tree, "body", "a") and resolves(tree, "body", "world") and resolves(tree, "default", "main")
    assert resolves(tree, "body", "pad1")
    assert not resolves(tree, "site", "world") and not resolves(tree, "site", "a")


def test_the_nearest_name_is_the_help() -> None:
    found = unresolved(Tree(REFERENCES_ARM), "site", "tpi", None, written="site: {}")
    assert found.help == "did you mean `site: tip`?" and found.subjects == {"tpi"}
    assert [note.message for note in found.notes] == ["sites that exist: tip"]


def test_a_name_of_another_kind_is_said() -> None:
    found = unresolved(Tree(REFERENCES_ARM), "joint", "tip", None)
    assert [note.message for note in found.notes] == ["`tip` is a site", "there are no joints"]
    assert found.help is None


def test_the_type_beside_it_is_the_help_where_there_is_one() -> None:
    found = unresolved(Tree(REFERENCES_ARM), "geom", "tip", None, typed_by="objtype")
    assert found.help == "`tip` is a site: write `objtype: site`"


REMOVAL_ARM = (
    '<mujoco><default><default class="c"><geom material="m"/></default></default><asset><material name="m"/></asset>'
    '<worldbody><body name="a"><joint name="j"/><body name="b"><site name="s"/><geom material="m"/></body></body></worldbody>'
    '<tendon><spatial name="t"><site site="s"/><site site="other"/></spatial></tendon>'
    '<actuator><motor name="pull" tendon="t"/><motor name="turn" joint="j"/></actuator>'
    '<sensor><actuatorfrc name="force" actuator="pull"/></sensor></mujoco>'
)
SCENE = '<mujoco><actuator><motor name="from above" joint="arm/j"/></actuator></mujoco>'


def _going(removal: Removal[Tree]) -> list[str]:
    return [str(node.get("name")) for _, node in removal.going]


def test_what_refers_is_found_and_a_reference_inside_does_not_count() -> None:
    tree = Tree(REMOVAL_ARM)
    removal = Removal.of([(tree, tree.find("worldbody/body/body"))])
    assert [(each.node.tag, each.attribute, each.namespace, each.name) for each in removal.references] == [
        ("site", "site", "site", "s")
    ]


def test_referrers_fall_one_after_the_other_each_as_a_whole() -> None:
    tree = Tree(REMOVAL_ARM)
    removal = Removal.of([(tree, tree.find("worldbody/body/body"))]).with_referrers()
    assert _going(removal) == ["b", "t", "pull", "force"] and not removal.references


def test_what_stands_inside_another_goes_with_it() -> None:
    tree = Tree(REMOVAL_ARM)
    both = [(tree, tree.find("worldbody/body/body")), (tree, tree.find("worldbody/body"))]
    assert _going(Removal.of(both)) == ["a"]


def test_models_above_lose_who_refers_too() -> None:
    scene = Tree(SCENE)
    tree = Tree(REMOVAL_ARM, scene, "arm/")
    removal = Removal.of([(tree, tree.find("worldbody/body/joint"))]).with_referrers()
    assert _going(removal) == ["j", "turn", "from above"] and removal.going[2][0] is scene


def test_materials_are_dropped_and_nothing_falls() -> None:
    tree = Tree(REMOVAL_ARM)
    removal = Removal.of([(tree, tree.find("asset/material"))]).with_referrers()
    assert _going(removal) == ["m"] and len(removal.references) == 2
    removal.drop_references()
    assert not tree.root.xpath("//geom[@material]") and not tree.names.users("material", "m")


SHEET = (
    '<mujoco><worldbody><body name="a"/><body name="b"/><replicate count="2"><site name="pad"/></replicate></worldbody>'
    '<deformable><flex name="f" body="a b a c"/></deformable>'
    '<contact><exclude name="e" body1="a" body2="b"/></contact>'
    '<sensor><framepos objtype="site" objname="pad1"/><framepos objtype="site" objname="padding"/></sensor></mujoco>'
)
RENAMING_SCENE = (
    '<mujoco><worldbody><body name="a"/></worldbody><contact><exclude body1="a" body2="sheet/a"/></contact>'
    '<sensor><framepos objtype="site" objname="sheet/pad0"/></sensor></mujoco>'
)


def _renamed(tree: Tree, *names: tuple[str, str, str]) -> None:
    Renaming.of([NewName(tree, *each) for each in names]).carry_out()


def test_two_names_change_places_in_a_list_too() -> None:
    tree = Tree(SHEET)
    _renamed(tree, ("body", "a", "b"), ("body", "b", "a"))
    assert tree.find("deformable/flex").get("body") == "b a b c"
    assert dict(tree.find("contact/exclude").attrib) == {"name": "e", "body1": "b", "body2": "a"}
    assert [len(tree.names.users("body", name)) for name in "abc"] == [2, 2, 1]


def test_copies_that_a_replicate_makes_follow_and_other_names_do_not() -> None:
    tree = Tree(SHEET)
    _renamed(tree, ("site", "pad", "tip"))
    assert [each.get("objname") for each in tree.find("sensor")] == ["tip1", "padding"]


def test_models_above_follow_with_the_prefix() -> None:
    scene = Tree(RENAMING_SCENE)
    tree = Tree(SHEET, scene, "sheet/")
    _renamed(tree, ("body", "a", "x"), ("site", "pad", "tip"))
    assert dict(scene.find("contact/exclude").attrib) == {"body1": "a", "body2": "sheet/x"}
    assert scene.find("sensor/framepos").get("objname") == "sheet/tip0"


def test_a_new_prefix_leaves_a_model_its_own_names() -> None:
    scene = Tree(RENAMING_SCENE.replace('name="a"', 'name="sheet/b"').replace('"a"', '"sheet/b"'))
    Renaming.of_prefix(scene, "sheet/", "cloth/").carry_out()
    assert dict(scene.find("contact/exclude").attrib) == {"body1": "sheet/b", "body2": "cloth/a"}


def test_a_name_with_a_space_cannot_stand_in_a_list() -> None:
    tree = Tree(SHEET)
    ((reference, new),) = Renaming.of([NewName(tree, "body", "b", "two words")]).unlistable()
    assert (reference.node.tag, reference.attribute, reference.name, new) == ("flex", "body", "b", "two words")
    assert not list(Renaming.of([NewName(tree, "site", "pad", "two words")]).unlistable())


def _skin(*names: str) -> bytes:
    """A triangle with a bone for each name."""
    header = struct.pack("<4i9f3i", 3, 0, 1, len(names), *range(9), 0, 1, 2)
    bind = struct.pack("<7fi3i3f", 0, 0, 0, 1, 0, 0, 0, 3, 0, 1, 2, 1, 1, 1)
    return header + b"".join(name.encode().ljust(40, b"\0") + bind for name in names)


def test_two_bones_change_places() -> None:
    assert renamed_skin(_skin("a", "b", "c"), {"a": "b", "b": "a"}.get) == _skin("b", "a", "c")


def test_a_file_without_any_of_the_names_stays(tmp_path: Path) -> None:
    (tmp_path / "coat.skn").write_bytes(_skin("a"))
    assert renamed_skin(tmp_path / "coat.skn", {"b": "c"}.get) is None
    assert bones(tmp_path / "coat.skn") == ["a"]


@pytest.mark.parametrize("source", [_skin("a")[:-1], b"nothing", Path("does-not-exist.skn")])
def test_a_file_that_cannot_be_read_stays(source: bytes | Path) -> None:
    assert renamed_skin(source, {"a": "b"}.get) is None
    assert bones(source) is None


def test_a_name_that_has_no_room_is_a_fault() -> None:
    with pytest.raises(BadBone, match="longer than the 39 bytes"):
        renamed_skin(_skin("a"), {"a": "b" * 40}.get)


def test_skins_stand_in_two_sections_and_follow_the_compiler_settings() -> None:
    root = etree.fromstring(
        '<mujoco><compiler meshdir="m"/><asset><skin file="a.skn"/><mesh file="b.obj"/></asset>'
        '<deformable><skin name="x"/><skin file="c.skn"/></deformable></mujoco>'
    )
    assert [(each.path, each.written) for each in skins(root)] == [("m/a.skn", "a.skn"), ("m/c.skn", "c.skn")]

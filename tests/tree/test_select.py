from __future__ import annotations

from lxml import etree
from mjcompose.tree.select import attribute_of, kind_of, query, section_of, spoken, tags_of

ROOT = etree.fromstring(
    "<mujoco><default><geom/></default><worldbody><body><geom/><frame><joint/></frame></body></worldbody>"
    "<tendon><fixed><joint/></fixed></tendon><equality><joint/></equality><visual><global/></visual></mujoco>"
)


def paths(expression: str) -> list[str]:
    return [kind_of(node).path for node in ROOT.xpath(expression)]


def test_a_tag_means_what_its_place_makes_it() -> None:
    assert paths("//joint") == ["joint", "fixed/joint", "equality/joint"]
    assert paths("//geom") == ["default/geom", "geom"]
    assert paths("/mujoco/visual | //global") == ["visual", "visual/global"]


def test_the_section_is_that_of_the_topmost_element() -> None:
    assert [section_of(node) for node in ROOT.xpath("//joint")] == ["worldbody", "tendon", "equality"]
    assert section_of(ROOT.find("visual")) == "visual"
    assert section_of(etree.fromstring("<body><joint/></body>")[0]) == "worldbody"


def test_class_is_spelled_dclass() -> None:
    kind = kind_of(ROOT.find("worldbody/body/geom"))
    found = attribute_of(kind, "dclass")
    assert found is not None and found.name == "class" and spoken("class") == "dclass"
    assert attribute_of(kind, "class_") is found
    assert attribute_of(kind, "dklass") is None


def test_a_family_takes_all_of_its_tags_and_a_tag_only_itself() -> None:
    assert query("joint", None).paths == {"joint", "freejoint"}
    assert query("freejoint", None).paths == {"freejoint"}
    assert {"actuator/motor", "actuator/position"} < query("actuator", None).paths
    assert query("motor", None).paths == {"actuator/motor"}
    assert query("key", None).paths == {"keyframe/key"}


def test_inside_a_section_its_own_elements_are_meant() -> None:
    assert query("joint", "equality").paths == {"equality/joint"}
    assert query("geom", "default").paths == {"default/geom"}
    assert query("geom", None).paths == {"geom"}
    assert query("goem", None).paths == frozenset()


def test_every_tag_and_family_can_be_suggested() -> None:
    assert {"geom", "actuator", "motor", "global"} <= set(tags_of())

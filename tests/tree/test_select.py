from __future__ import annotations

from itertools import product

import pytest
from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.classes import Classes
from mjcompose.tree.names import NameIndex
from mjcompose.tree.pattern import Selector
from mjcompose.tree.select import Selection, attribute_of, kind_of, query, section_of, spoken, tags_of

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


MODEL = etree.fromstring("""
<mujoco>
  <default><default class="b1"><geom/></default></default>
  <worldbody>
    <geom name="b1"/>
    <body name="b1"><joint name="j"/><geom name="g1"/>
      <frame name="f"><geom name="g2"/><body name="b2"><freejoint name="free"/><geom name="g3"/><geom/></body></frame>
    </body>
    <body name="b3"><site name="g1"/><geom name="g4"/></body>
  </worldbody>
  <tendon><fixed name="j"><joint joint="j" coef="1"/></fixed></tendon>
  <actuator><motor name="g1" joint="j"/><position name="p" joint="j"/></actuator>
</mujoco>
""")


def selectors() -> list[Selector]:
    places = [None, Selector("body", "b1"), Selector("body", "b?"), Selector("frame", "f"), Selector("body", "none")]
    named = product(
        ("geom", "body", "joint", "site", "actuator", "motor"), ("b1", "g1", "j", "g*", "**", "none", "world")
    )
    return [
        Selector(tag, pattern, parent=parent, inside=inside)
        for (tag, pattern), parent, inside in product(named, places, places)
    ]


def test_an_index_finds_what_a_search_finds() -> None:
    index = NameIndex.of(MODEL)
    searching = Selection(MODEL, Classes(MODEL))
    looking_up = Selection(MODEL, Classes(MODEL), find=index.find)
    found = [searching.of(selector) for selector in selectors()]
    assert found == [looking_up.of(selector) for selector in selectors()]
    assert sum(map(bool, found)) > 50


@pytest.mark.parametrize("around", ["parent", "inside"])
def test_elements_of_one_body_are_found_without_a_look_at_the_others(
    around: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_at: list[Node] = []
    monkeypatch.setattr(Selection, "_named", lambda self, node, pattern: looked_at.append(node) or True)
    selection = Selection(MODEL, Classes(MODEL), find=NameIndex.of(MODEL).find)
    selection.of(Selector("geom", "g*", **{around: Selector("body", "b3")}))
    assert [node.get("name") for node in looked_at if node.tag == "geom"] == ["g4"]

from __future__ import annotations

import random
from itertools import product

import pytest
from lxml import etree
from lxml.etree import _Element as Node
from mjcompose.tree.classes import Classes
from mjcompose.tree.names import NameIndex
from mjcompose.tree.pattern import BadPattern, Selector
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
    looking_up = Selection(MODEL, Classes(MODEL), index=index)
    found = [searching.of(selector) for selector in selectors()]
    assert found == [looking_up.of(selector) for selector in selectors()]
    assert sum(map(bool, found)) > 50


PATTERNS = (
    "a*",
    "*a",
    "*a*",
    "a?b",
    "?",
    "*",
    "**",
    "**/b",
    "a/*",
    "{a,b}",
    "{a,b}/{a,b}*",
    "{a*,b}",
    "{a,}b",
    "a{1,2}",
    "none*",
    "a**b",
    "/a.*/",
    "/.*a/",
    "/a|b/",
    "/ab?/",
    "/(?i)A.*/",
    "/a+/",
    "/[ab]*/",
    "/a/",
    "/a{1}.*/",
    "/a\\/b.*/",
    "/ab?1|b/",
)


def _named(count: int, chance: random.Random) -> Node:
    root = etree.fromstring("<mujoco><worldbody/><actuator/></mujoco>")
    names = list({"".join(chance.choices("aAb/1", k=chance.randrange(1, 5))) for _ in range(count)})
    bodies = [root[0]]
    for name in chance.sample(names, len(names)):
        body = etree.SubElement(chance.choice(bodies), "body", {"name": name})
        etree.SubElement(body, "geom", {"name": name[::-1]} if chance.random() < 0.7 else {})
        etree.SubElement(root[1], "motor", {"name": name})
        bodies.append(body)
    return root


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("separator", ["/", "_"])
def test_patterns_in_an_index_that_follows_changes(seed: int, separator: str) -> None:
    chance = random.Random(seed)
    root = _named(60, chance)
    index = NameIndex.of(root)
    for number in range(12):
        searching = Selection(root, Classes(root), separator)
        looking_up = Selection(root, Classes(root), separator, index=index)
        for tag, pattern in product(("body", "geom", "actuator"), PATTERNS):
            selector = Selector(tag, pattern)
            assert looking_up.of(selector) == searching.of(selector), str(selector)
            assert looking_up.looks(selector) <= searching.looks(selector)
        node = chance.choice(list(root.iter("geom", "motor")))
        index.forget(node, "actuator" if node.tag == "motor" else "worldbody")
        if chance.random() < 0.5:
            node.set("name", f"a/b{number}x")
            index.note(node, "actuator" if node.tag == "motor" else "worldbody")
        else:
            node.getparent().remove(node)  # type: ignore[union-attr]


def test_a_pattern_that_is_not_valid_is_reported_without_names_to_match() -> None:
    selection = Selection(MODEL, Classes(MODEL), index=NameIndex.of(MODEL))
    with pytest.raises(BadPattern, match="is not valid"):
        selection.of(Selector("geom", "/nothing begins like this(/"))


def test_a_pattern_with_literal_text_looks_at_few_names() -> None:
    names = [f"{side}{number}_pad" for side in ("left", "right") for number in range(50)]
    bodies = "".join(f'<body name="{name}"><geom/></body>' for name in names)
    root = etree.fromstring(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    selection = Selection(root, Classes(root), index=NameIndex.of(root))
    looks = {
        pattern: selection.looks(Selector("body", pattern))
        for pattern in (
            "left7*",
            "*7_pad",
            "{left,right}7_*",
            "/left7_.*/",
            "*",
            "/.*7_pad/",
            "**",
            "left7_pad",
        )
    }
    assert looks == {
        "left7*": 1,
        "*7_pad": 10,
        "{left,right}7_*": 2,
        "/left7_.*/": 1,
        "*": 100,
        "/.*7_pad/": 100,
        "**": 202,
        "left7_pad": 0,
    }


@pytest.mark.parametrize("around", ["parent", "inside"])
def test_elements_of_one_body_are_found_without_a_look_at_the_others(
    around: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_at: list[Node] = []
    monkeypatch.setattr(Selection, "_named", lambda self, node, pattern: looked_at.append(node) or True)
    selection = Selection(MODEL, Classes(MODEL), index=NameIndex.of(MODEL))
    selection.of(Selector("geom", "g*", **{around: Selector("body", "b3")}))
    assert [node.get("name") for node in looked_at if node.tag == "geom"] == ["g4"]

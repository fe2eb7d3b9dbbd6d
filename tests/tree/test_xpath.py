from __future__ import annotations

import pytest
from lxml import etree

from composer.tree.xpath import BadXPath, is_plain, nodes_at

ROOT = etree.fromstring(
    "<mujoco><!-- c --><worldbody><body name='a'><!-- d --><geom/><geom name='g&lt;é'/></body><body/></worldbody></mujoco>"
)


@pytest.mark.parametrize(
    "xpath",
    [
        "worldbody/body[2]",
        "//geom[@name]",
        "//body[not(@name)][1]",
        "worldbody//geom[@name='g<é']",
        "//body|//geom",
        "*/*",
        ".",
    ],
)
def test_plain_ones(xpath: str) -> None:
    assert is_plain(xpath) == (xpath != ".")
    assert nodes_at(ROOT, xpath) == [node for node in ROOT.xpath(xpath) if node is not ROOT]


@pytest.mark.parametrize(
    "xpath",
    ["//geom[../geom[@name]]", "//geom/..", "//*[self::geom or self::body]", "//body[geom]/descendant::*"],
)
def test_others_give_the_same_elements(xpath: str) -> None:
    assert not is_plain(xpath) and nodes_at(ROOT, xpath) == ROOT.xpath(xpath) != []


@pytest.mark.parametrize(
    ("xpath", "message"),
    [
        ("//geom[", "invalid expression"), ("//@name", "gives no elements"), ("count(//*)", "gives no elements"),
        ("//comment()", "gives no elements"), ("x" * 10_001, "too long"), ("//x\x1b", "which XML cannot hold"),
    ],
)  # fmt: skip
def test_what_gives_no_elements(xpath: str, message: str) -> None:
    with pytest.raises(BadXPath, match=message):
        nodes_at(ROOT, xpath)

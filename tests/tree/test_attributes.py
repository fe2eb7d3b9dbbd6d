from __future__ import annotations

import pytest
from tree.editing import Tree

from composer.tree.attributes import assign, changing

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

from __future__ import annotations

from tree.editing import Tree

from composer.tree.removal import Removal

ARM = (
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
    tree = Tree(ARM)
    removal = Removal.of([(tree, tree.find("worldbody/body/body"))])
    assert [(each.node.tag, each.attribute, each.namespace, each.name) for each in removal.references] == [
        ("site", "site", "site", "s")
    ]


def test_referrers_fall_one_after_the_other_each_as_a_whole() -> None:
    tree = Tree(ARM)
    removal = Removal.of([(tree, tree.find("worldbody/body/body"))]).with_referrers()
    assert _going(removal) == ["b", "t", "pull", "force"] and not removal.references


def test_what_stands_inside_another_goes_with_it() -> None:
    tree = Tree(ARM)
    both = [(tree, tree.find("worldbody/body/body")), (tree, tree.find("worldbody/body"))]
    assert _going(Removal.of(both)) == ["a"]


def test_models_above_lose_who_refers_too() -> None:
    scene = Tree(SCENE)
    tree = Tree(ARM, scene, "arm/")
    removal = Removal.of([(tree, tree.find("worldbody/body/joint"))]).with_referrers()
    assert _going(removal) == ["j", "turn", "from above"] and removal.going[2][0] is scene


def test_materials_are_dropped_and_nothing_falls() -> None:
    tree = Tree(ARM)
    removal = Removal.of([(tree, tree.find("asset/material"))]).with_referrers()
    assert _going(removal) == ["m"] and len(removal.references) == 2
    removal.drop_references()
    assert not tree.root.xpath("//geom[@material]") and not tree.names.users("material", "m")

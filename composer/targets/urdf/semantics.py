"""SRDF: pairs of links that do not collide, and the poses of keyframes."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.plain.numbers import text

GROUP = "all"


def semantics(draft: Draft, name: str, names: list[str], joints: dict[str, Node]) -> bytes:
    """Return the SRDF file of the robot `name`. `names` has the name of the link of each body."""
    model = draft.model
    root = etree.Element("robot", name=name)
    movable = [
        each for each, joint in joints.items() if joint.get("type") in ("revolute", "continuous", "prismatic")
    ]
    if movable:
        group = etree.SubElement(root, "group", name=GROUP)
        for each in movable:
            etree.SubElement(group, "joint", name=each)
    for number, key in draft.of("key"):
        state = etree.SubElement(
            root, "group_state", name=str(key.get("name") or f"key{number}"), group=GROUP
        )
        for joint, node in draft.of("joint"):
            if node.get("name") in movable:
                value = model.key_qpos[number][model.jnt_qposadr[joint]]
                etree.SubElement(state, "joint", name=str(node.get("name")), value=text(value))
    for body in range(1, model.nbody):
        if parent := int(model.body_parentid[body]):
            _apart(root, names[parent], names[body], reason="Adjacent")
    for signature in model.exclude_signature.tolist():
        pair = signature >> 16, signature & 0xFFFF
        if all(pair):
            _apart(root, names[pair[0]], names[pair[1]], reason="Excluded in MuJoCo")
    etree.indent(root)
    return etree.tostring(root, xml_declaration=True, encoding="utf-8") + b"\n"


def _apart(root: Node, first: str, second: str, reason: str) -> None:
    etree.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)

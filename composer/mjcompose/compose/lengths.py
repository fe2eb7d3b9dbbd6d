"""Elements whose numbers are lengths and not angles, because of the joint or the tendon to which they belong."""

from __future__ import annotations

from lxml.etree import _Element as Node

from mjcompose.link.key_layout import joint_type
from mjcompose.link.linking import Linking
from mjcompose.tree.select import section_of

_JOINTS = ("joint", "jointinparent", "joint1")
"""The attributes by which actuators, sensors and equalities name the joint whose numbers they have."""
_TENDONS = ("tendon", "tendon1")
_LINEAR = ("slide", "free")
_SPATIAL = "spatial"


def why_a_length(node: Node, linking: Linking) -> str | None:
    """Return in words why the numbers of an element are lengths, or None if they may be angles."""
    section = section_of(node)
    if section == "default":
        return None
    if node.tag == "joint" and section == "worldbody":
        kind = joint_type(node, linking.base.classes)
        return f"a {kind}" if kind in _LINEAR else None
    if node.get("cranksite"):
        return "whose slider has a length"
    if (joint := _named(node, _JOINTS, "joint", linking)) is not None:
        kind = joint_type(joint, linking.base.classes)
        return f"whose joint is a {kind}" if kind in _LINEAR else None
    if (tendon := _named(node, _TENDONS, "tendon", linking)) is not None:
        return "whose tendon is spatial" if tendon.tag == _SPATIAL else None
    actuator = _named(node, ("actuator",), "actuator", linking) if section == "sensor" else None
    return None if actuator is None else why_a_length(actuator, linking)


def _named(node: Node, attributes: tuple[str, ...], namespace: str, linking: Linking) -> Node | None:
    """Return the element of a namespace that the node names by one of the attributes."""
    name = next((str(value) for each in attributes if (value := node.get(each))), None)
    return None if name is None else linking.names.find(namespace, name)

"""`<ros2_control>`: the joints with actuators, and their interfaces."""

from __future__ import annotations

from lxml import etree
from lxml.etree import _Element as Node

from composer.targets.draft import Draft
from composer.targets.plain.numbers import text

_INTERFACE = {"motor": "effort", "position": "position", "velocity": "velocity"}
_PLUGIN = "mock_components/GenericSystem"
"""The system that `ros2_control` has for tests; a robot puts its own there."""


def control(draft: Draft, joints: dict[str, Node]) -> Node | None:
    """Return the element, or None if no joint has an actuator. Actuators of anything else are recorded as losses."""
    found = etree.Element("ros2_control", name=str(draft.root.get("model") or "model"), type="system")
    etree.SubElement(etree.SubElement(found, "hardware"), "plugin").text = _PLUGIN
    for number, node in list(draft.of("actuator")):
        name = str(node.get("joint") or "")
        if node.tag not in _INTERFACE or name not in joints:
            draft.lose("actuators", node, "`ros2_control` has motors and servos of joints")
            continue
        joint = next((each for each in found.iterchildren("joint") if each.get("name") == name), None)
        if joint is None:
            joint = etree.SubElement(found, "joint", name=name)
        command = etree.SubElement(joint, "command_interface", name=_INTERFACE[str(node.tag)])
        if draft.model.actuator_ctrllimited[number]:
            for side, end in zip(("min", "max"), draft.model.actuator_ctrlrange[number], strict=True):
                etree.SubElement(command, "param", name=side).text = text(end)
    for joint in found.iterchildren("joint"):
        for each in ("position", "velocity", "effort"):
            etree.SubElement(joint, "state_interface", name=each)
    return found if found.find("joint") is not None else None

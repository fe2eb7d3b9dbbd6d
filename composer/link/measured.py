"""Widths of what only MuJoCo can lay out, from a unit compiled alone."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.layout import BLOCK, Layout, Slot, Unknown, actuator_slot, lay_out
from composer.link.linking import Linking
from composer.tree.unit import Unit

_ARRAYS = ("nq", "nv", "qpos0", "actuator_actnum", "actuator_ctrlnum")


def widths(linking: Linking, unit: Unit) -> dict[Node, Slot] | None:
    """(nq, nv) of the one block whose size is unknown, (nctrl, nact) of every actuator; None where that fails."""
    arrays = linking.measure(unit, _ARRAYS) if linking.measure else None
    if not arrays:
        return None
    found: dict[Node, Slot] = {}
    actuators = [
        element
        for section in unit.root.iterchildren("actuator")
        for element in section
        if isinstance(element.tag, str)
    ]
    acts = [int(n) for n in arrays["actuator_actnum"]]
    controls = [int(n) for n in arrays.get("actuator_ctrlnum") or [1.0] * len(acts)]
    if len(acts) == len(actuators):
        found.update(zip(actuators, map(actuator_slot, acts, controls), strict=True))
    unknown: list[Node] = []
    while True:
        try:
            layout = lay_out(unit, found)
            break
        except Unknown as reason:
            if unknown:
                return found
            unknown.append(reason.element)
            found[reason.element] = Slot(BLOCK, (0, 0))
    if unknown:
        nq = int(arrays["nq"][0]) - layout.total("qpos")
        nv = int(arrays["nv"][0]) - layout.total("qvel")
        found[unknown[0]] = Slot(BLOCK, (nq, nv))
        layout = lay_out(unit, found)
    if layout.total("qpos") == int(arrays["nq"][0]):
        _note_references(linking, layout, arrays["qpos0"])
    return found


def _note_references(linking: Linking, layout: Layout, qpos0: list[float]) -> None:
    at = 0
    for joint, slot in layout.joints.items():
        width = slot.widths[0]
        if slot.kind == BLOCK:
            linking.references[joint] = numbers.text(qpos0[at : at + width]).split()
        at += width

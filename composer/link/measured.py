"""Widths of what only MuJoCo can lay out, from a unit compiled alone."""

from __future__ import annotations

from collections.abc import Mapping

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.layout import BLOCK, Layout, Slot, Unknown, actuator_slot, lay_out
from composer.link.linking import Linking
from composer.link.multiplied import actuators_in_order, element_of
from composer.tree.unit import Unit

_ARRAYS = (
    "nq",
    "nv",
    "qpos0",
    "body_mocapid",
    "jnt_type",
    "jnt_qposadr",
    "jnt_dofadr",
    "actuator_actnum",
    "actuator_ctrlnum",
)
_FREE = 0  # of `mjtJoint`


def widths(linking: Linking, unit: Unit) -> dict[Node, Slot] | None:
    """(nq, nv) of the one block whose size is unknown, (nctrl, nact) of every actuator; None where that fails."""
    arrays = linking.measure(unit, _ARRAYS) if linking.measure else None
    if not arrays:
        return None
    found: dict[Node, Slot] = {}
    actuators = list(map(element_of, actuators_in_order(unit.root)))
    acts = [int(n) for n in arrays["actuator_actnum"]]
    controls = [int(n) for n in arrays.get("actuator_ctrlnum") or [1.0] * len(acts)]
    if len(acts) == len(actuators):
        found.update(zip(actuators, map(actuator_slot, acts, controls), strict=True))
    elif (replicate := next(unit.root.iter("replicate"), None)) is not None:
        raise Unknown(replicate)  # it multiplies actuators that refer to nothing in it: see `spurious.py`
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
        found[unknown[0]] = Slot(BLOCK, (nq, nv), _free_inside(layout, unknown[0], (nq, nv), arrays))
        layout = lay_out(unit, found)
        if sum(number >= 0 for number in arrays["body_mocapid"]) > len(layout.mocaps):
            linking.hiding_mocaps.append(unknown[0])
    if layout.total("qpos") == int(arrays["nq"][0]):
        _note_references(linking, unit, layout, arrays["qpos0"])
    return found


def _free_inside(
    layout: Layout, block: Node, widths: tuple[int, int], arrays: Mapping[str, list[float]]
) -> tuple[tuple[int, int], ...]:
    """Where the free joints are in a block that MuJoCo has expanded."""
    nq = nv = 0
    for joint, slot in layout.joints.items():
        if joint is block:
            break
        nq, nv = nq + slot.widths[0], nv + slot.widths[1]
    joints = zip(arrays["jnt_type"], arrays["jnt_qposadr"], arrays["jnt_dofadr"], strict=True)
    return tuple(
        (int(q) - nq, int(v) - nv) for kind, q, v in joints if kind == _FREE and nq <= q < nq + widths[0]
    )


def is_measured(unit: Unit, joint: Node, slot: Slot) -> bool:
    """Whether only MuJoCo knows the reference: of what it expands, and of a body that it aligns with its inertia."""
    if slot.kind == BLOCK:
        return slot.widths[0] > 0
    return slot.kind == "free" and "true" in (joint.get("align"), unit.settings.alignfree)


def _note_references(linking: Linking, unit: Unit, layout: Layout, qpos0: list[float]) -> None:
    at = 0
    for joint, slot in layout.joints.items():
        width = slot.widths[0]
        if is_measured(unit, joint, slot):
            linking.references[joint] = numbers.text(qpos0[at : at + width]).split()
        at += width

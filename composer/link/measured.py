"""The widths that only MuJoCo can determine, from a unit compiled alone."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import islice

from lxml.etree import _Element as Node

from composer.compiled.joints import FREE, HINGE
from composer.link import numbers
from composer.link.layout import BLOCK, Holder, Layout, Slot, Unknown, actuator_slot, lay_out
from composer.link.linking import Linking
from composer.link.multiplied import Copy, actuators_in_order, element_of
from composer.numerics.pose import Pose
from composer.tree.names import declaration
from composer.tree.unit import Unit

_ARRAYS = (
    "nq",
    "nv",
    "qpos0",
    "key_time",
    "body_mocapid",
    "body_pos",
    "body_quat",
    "jnt_type",
    "jnt_qposadr",
    "jnt_dofadr",
    "actuator_actnum",
    "actuator_ctrlnum",
)
_OF_FLEX = ("nq", "nv", "jnt_type")


def widths(linking: Linking, unit: Unit) -> dict[Node, Slot] | None:
    """Measure what the tree does not tell about a unit's keys, by element. Return None if MuJoCo refuses the unit.

    That is all of what MuJoCo attaches, (nctrl, nact) of every actuator, (nq, nv) of every flex and of one more
    block of unknown size. Raises `Unknown` if the layout is not as wide as MuJoCo's.
    """
    arrays = linking.measure(unit, _ARRAYS) if linking.measure else None
    if not arrays:
        return None
    found = attached(linking, unit)
    brought = sum(slot.actuators for slot in found.values())
    found.update(_flexes(linking, unit))
    actuators = list(map(element_of, actuators_in_order(unit.root)))
    slots = list(map(actuator_slot, _counts(arrays, "actnum"), _counts(arrays, "ctrlnum")))
    # MuJoCo 4.0 puts the actuators of a model that it attaches behind all others, so that the first rows are the unit's
    # own.
    if len(slots) - brought == len(actuators):
        found.update(zip(actuators, slots, strict=False))
    elif (replicate := next(unit.root.iter("replicate"), None)) is not None:
        raise Unknown(
            replicate
        )  # it multiplies actuators that refer to nothing in it: see `replicate_capture.py`
    unknown: Node | None = None
    try:
        layout = lay_out(unit, found)
    except Unknown as reason:
        unknown = reason.element
        found[unknown] = Slot(BLOCK, (0, 0))
        layout = lay_out(unit, found)
    if unknown is not None:
        nq = int(arrays["nq"][0]) - layout.total("qpos")
        nv = int(arrays["nv"][0]) - layout.total("qvel")
        found[unknown] = Slot(BLOCK, (nq, nv), _free_inside(layout, unknown, (nq, nv), arrays))
        layout = lay_out(unit, found)
    is_mocap = [number >= 0 for number in arrays["body_mocapid"]]
    if (layout.total("qpos"), layout.total("qvel"), sum(layout.mocaps.values())) != (
        int(arrays["nq"][0]), int(arrays["nv"][0]), sum(is_mocap)
    ):  # fmt: skip
        raise Unknown(next(unit.root.iter("replicate", "flexcomp", "attach", "composite", "worldbody")))
    _note_references(linking, unit, layout, arrays["qpos0"])
    _note_mocaps(linking, layout, arrays, is_mocap)
    return found


def attached(linking: Linking, unit: Unit) -> dict[Node, Slot]:
    """Measure what each `<attach>` adds, alone in an empty world. `linking.keys.measured` caches the results."""
    found: dict[Node, Slot] = {}
    for attach in unit.root.iter("attach"):
        slot = linking.keys.measured.get(attach) or _measured(linking, unit, attach)
        if slot is not None:
            found[attach] = linking.keys.measured[attach] = slot
    return found


def _flexes(linking: Linking, unit: Unit) -> Iterator[tuple[Node, Slot]]:
    """Measure what each `<flexcomp>` adds, alone. Those that MuJoCo refuses alone are left out."""
    for flex in unit.root.iter("flexcomp"):
        arrays = linking.measure(_alone(unit, flex), _OF_FLEX, attempt=True) if linking.measure else None
        if arrays:
            # The vertices and nodes of a flex slide; hinges are the twists of a rod (since MuJoCo 4.0).
            twists = arrays["jnt_type"].count(HINGE)
            yield (
                flex,
                Slot(BLOCK, (int(arrays["nq"][0]) - twists, int(arrays["nv"][0]) - twists), twists=twists),
            )


def _alone(unit: Unit, flex: Node) -> Unit:
    """Return a model with only a flex in its world, and only the sections that affect its number of joints."""
    root = unit.root.makeelement("mujoco")
    root.extend(copy.copy(compiler) for compiler in unit.root.iterchildren("compiler"))
    own, name = copy.copy(flex), flex.get("mesh")
    asset, worldbody = root.makeelement("asset"), root.makeelement("worldbody")
    meshes = unit.root.iterfind("asset/mesh") if name else ()
    asset.extend(copy.copy(mesh) for mesh in meshes if declaration(mesh, "asset") == ("mesh", name))
    worldbody.append(own)
    root.extend((asset, worldbody))
    # These change no number of joints, and what they name does not come along.
    for element in (own, *asset):
        for attribute in ("material", "class"):
            element.attrib.pop(attribute, None)
        for plugin in list(element.iterchildren("plugin")):
            element.remove(plugin)
    return replace(unit, root=root)


def _measured(linking: Linking, unit: Unit, attach: Node) -> Slot | None:
    arrays = linking.measure(_by_itself(unit, attach), _ARRAYS, attempt=True) if linking.measure else None
    if not arrays:
        return None
    acts, controls = _counts(arrays, "actnum"), _counts(arrays, "ctrlnum")
    size = int(arrays["nq"][0]), int(arrays["nv"][0])
    return Slot(
        BLOCK,
        size,
        tuple(_free_joints(arrays)),
        0,
        (sum(controls), sum(acts)),
        len(acts),
        sum(number >= 0 for number in arrays["body_mocapid"]),
        len(arrays["key_time"]),
    )


def _by_itself(unit: Unit, attach: Node) -> Unit:
    """Return a model that only attaches what `attach` attaches."""
    root = unit.root.makeelement("mujoco")
    for compiler in unit.root.iterchildren("compiler"):
        root.append(copy.copy(compiler))
    for tag, children in (("asset", unit.root.iterfind("asset/model")), ("worldbody", [attach])):
        section = root.makeelement(tag)
        section.extend(copy.copy(child) for child in children)
        root.append(section)
    return replace(unit, root=root)


def _counts(arrays: Mapping[str, list[float]], name: str) -> list[int]:
    """Return the number of activations or controls of each actuator. Before MuJoCo 4, each has one control."""
    return [int(n) for n in arrays.get(f"actuator_{name}") or [1.0] * len(arrays["actuator_actnum"])]


def _free_joints(arrays: Mapping[str, list[float]]) -> Iterator[tuple[int, int]]:
    """Yield the indices at which the numbers of each free joint begin."""
    joints = zip(arrays["jnt_type"], arrays["jnt_qposadr"], arrays["jnt_dofadr"], strict=True)
    return ((int(q), int(v)) for kind, q, v in joints if kind == FREE)


def _free_inside(
    layout: Layout, block: Node, widths: tuple[int, int], arrays: Mapping[str, list[float]]
) -> tuple[tuple[int, int], ...]:
    """Return where the free joints are in a block that MuJoCo has expanded."""
    nq = nv = 0
    for joint, slot in layout.joints.items():
        if joint is block:
            break
        nq, nv = nq + slot.widths[0], nv + slot.widths[1]
    return tuple((q - nq, v - nv) for q, v in _free_joints(arrays) if nq <= q < nq + widths[0])


def is_measured(unit: Unit, joint: Holder, slot: Slot) -> bool:
    """Return whether only MuJoCo knows the reference.

    It does of what it expands, of bodies aligned with their inertia, and of the copies of floating bodies.
    """
    if slot.kind == BLOCK:
        return slot.widths[0] > 0
    if slot.kind != "free":
        return False
    return isinstance(joint, Copy) or "true" in (joint.get("align"), unit.settings.alignfree)


def _note_references(linking: Linking, unit: Unit, layout: Layout, qpos0: list[float]) -> None:
    at = 0
    for joint, slot in layout.joints.items():
        width = slot.widths[0]
        if is_measured(unit, joint, slot):
            linking.keys.references[joint] = numbers.text(qpos0[at : at + width]).split()
        at += width


def _note_mocaps(
    linking: Linking, layout: Layout, arrays: Mapping[str, list[float]], is_mocap: list[bool]
) -> None:
    """Record the places of mocap bodies that are not in the tree, or several times."""
    bodies = iter([body for body, found in enumerate(is_mocap) if found])
    for holder, count in layout.mocaps.items():
        own = list(islice(bodies, count))
        if isinstance(holder, Copy) or holder.tag != "body":
            linking.keys.mocap_references[holder] = [_pose(arrays, body) for body in own]


def _pose(arrays: Mapping[str, list[float]], body: int) -> Pose:
    x, y, z = arrays["body_pos"][3 * body : 3 * body + 3]
    w, a, b, c = arrays["body_quat"][4 * body : 4 * body + 4]
    return Pose((x, y, z), (w, a, b, c))

"""Verb `calibrate`: how one robot differs from its model in ways that no attribute of MJCF says."""

from __future__ import annotations

from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.compose.editing import is_limited_by_range
from mjcompose.compose.values import report_unusable
from mjcompose.compose.verbs.inertia import recalibrate
from mjcompose.compose.verbs.values import OFFSET, SET, Entry, ValueChange
from mjcompose.language.verbs.calibrate import Calibrate
from mjcompose.link import numbers
from mjcompose.link.delays import samples_in, time_step
from mjcompose.link.key_layout import joint_type
from mjcompose.text.expression import Angle


def carry_out(verb: Calibrate, entry: Entry, at: Path) -> None:
    if verb.com is not None or verb.shape is not None:
        recalibrate(entry, verb.com, verb.shape, at=at)
    for index, node in enumerate(entry.found):
        if verb.zero is not None:
            _move_zero(entry, node, index, verb.zero, at=(*at, "zero"))
        if verb.delay is not None:
            _set_delay(entry, node, index, verb.delay, at=(*at, "delay"))


def _move_zero(entry: Entry, joint: Node, index: int, zero: float | Angle, at: Path) -> None:
    """Move the reference, the spring and the range of a joint together, so hard stops stay where the robot has them."""
    editing = entry.editing
    kind = joint_type(joint, editing.classes)
    if kind not in ("hinge", "slide"):
        message = f"{editing.called(joint)} is a {kind}, which has no zero"
        report_unusable(editing, joint, Fault("wrong-type", message, at, key=True, help="select a hinge or a slide"))
    if isinstance(zero, Angle) and kind == "slide":
        message = f"{editing.called(joint)} is a slide, whose zero is a length"
        report_unusable(editing, joint, Fault("wrong-type", message, at, help="write it in meters"))
    if kind == "hinge" and not isinstance(zero, Angle):
        message = f"the zero of {editing.called(joint)} is an angle, and {zero} has no unit"
        help = f"write `{zero}deg` or `{zero}rad`"
        report_unusable(editing, joint, Fault("bare-angle", message, at, help=help))
    written = str(zero) if isinstance(zero, Angle) else zero
    change = ValueChange(editing, OFFSET, entry.masses)
    change.carry_out(joint, index, {"ref": written}, at=at)
    if any(numbers.read(editing.effective(joint, "stiffness") or "0")):
        change.carry_out(joint, index, {"springref": written}, at=at)
    ends = set(numbers.read(editing.effective(joint, "range") or ""))
    if len(ends) > 1 and is_limited_by_range(editing, joint, "limited"):
        change.carry_out(joint, index, {"range": written}, at=at)


def _set_delay(entry: Entry, actuator: Node, index: int, delay: float, at: Path) -> None:
    editing = entry.editing
    values: dict[str, Any] = {"delay": delay}
    if delay:
        values["nsample"] = samples_in(delay, time_step(editing.root))
    ValueChange(editing, SET, entry.masses).carry_out(actuator, index, values, at=at)
    if delay:
        # The time step of the whole model is not known yet.
        editing.linking.base.origins.delays[actuator] = str(actuator.get("nsample"))

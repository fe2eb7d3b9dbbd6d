"""Verb `datasheet`: the values of a data sheet, as attributes of an actuator and its joint."""

from __future__ import annotations

import math
from typing import Any, NoReturn

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.compose.editing import Editing, is_limited_by_range
from mjcompose.compose.values import UnusableValue, report_unusable
from mjcompose.compose.verbs.values import SET, Entry, ValueChange
from mjcompose.language.datasheets import SHEETS, Sheet, library
from mjcompose.language.verbs.datasheet import Datasheet
from mjcompose.link import numbers
from mjcompose.link.delays import samples_in, time_step
from mjcompose.link.key_layout import joint_type
from mjcompose.tree.edit import assign

_SERVOS = ("position", "velocity")
_PLAIN = ("motor",)


def carry_out(verb: Datasheet, entry: Entry, at: Path) -> None:
    editing = entry.editing
    sheet = _sheet(editing, verb.model, (*at, "model"))
    effort = sheet.effort
    if verb.effort == "rated":
        if sheet.rated is None:
            message = f"the data sheet of `{verb.model}` has no rated torque"
            editing.sink.error("missing-key", message, editing.span((*at, "effort")), help="leave `effort` out")
            raise UnusableValue
        effort = sheet.rated
    known = {"armature": sheet.reflected, "frictionloss": sheet.friction, "damping": sheet.damping}
    of_joint = {name: value for name, value in known.items() if value is not None}  # the others stay as they are
    for index, node in enumerate(entry.found):
        joint, gear = _joint(editing, node, at)
        _without_other(editing, node, at)
        change = ValueChange(editing, SET, entry.masses)
        change.carry_out(joint, index, of_joint, at=at)
        drive = _Drive(editing, node, joint, gear=gear, sheet=sheet, effort=effort, written=verb, at=at)
        change.carry_out(node, index, drive.values(), at=at)
        if sheet.delay:
            # The time step of the whole model is not known yet.
            editing.linking.base.origins.delays[node] = str(node.get("nsample"))


def _sheet(editing: Editing, name: str, at: Path) -> Sheet:
    known = {**library(), **SHEETS, **editing.datasheets}
    if name not in known:
        note = exists_note("data sheet", sorted(known), name)
        help = did_you_mean(name, known) or "write it in the section `datasheets`"
        editing.sink.error(
            "unknown-name",
            f"there is no data sheet `{name}`",
            editing.span(at),
            notes=(note,),
            help=help,
            subjects=(name,),
        )
        raise UnusableValue
    return known[name]


def _joint(editing: Editing, node: Node, at: Path) -> tuple[Node, float]:
    name = node.get("joint")
    joint = editing.find_node("joint", str(name)) if name else None
    if joint is None or joint_type(joint, editing.classes) != "hinge":
        message = f"{editing.called(node)} does not turn a hinge, but a motor does"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True), it="it")
    if (gear := numbers.first(editing.effective(node, "gear") or "1")) == 0:
        message = f"the `gear` of {editing.called(node)} is 0"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help="set it to 1"), it="it")
    return joint, gear


class _Drive(Struct):
    """An actuator with its `gear` and its hinge, and the motor that they become; `effort` is the peak torque in N·m."""

    editing: Editing
    node: Node
    joint: Node
    gear: float
    sheet: Sheet
    effort: float
    written: Datasheet
    at: Path

    def values(self) -> dict[str, Any]:
        # The force of an actuator turns the joint `gear` times as strong, and its length is `gear` times the angle.
        limit = self.effort / abs(self.gear)
        values: dict[str, Any] = {"forcerange": [-limit, limit]}
        if not is_limited_by_range(self.editing, self.node, "forcelimited"):
            values["forcelimited"] = True
        if self.node.tag in _SERVOS:
            kp, kv = self._gains()
            values["kv"] = kv / self.gear**2
            if self.node.tag == "position":
                values["kp"] = kp / self.gear**2
                _without_dampratio(self.editing, self.node, self.at)
        if delay := self.sheet.delay:
            values |= {"delay": delay, "nsample": samples_in(delay, time_step(self.editing.root))}
        return values

    def _gains(self) -> tuple[float, float]:
        written = self.written
        if written.error is not None:
            if self.sheet.speed is None:
                message = f"`kv` needs a speed, which the data sheet of `{written.model}` does not have"
                self._lacks(message, "write `bandwidth` instead of `error`", "error")
            # A motor gives its whole torque at rest and none at its greatest speed.
            return self.effort / written.error, self.effort / self.sheet.speed
        called = self.editing.called(self.node)
        if written.bandwidth is None:
            help = "write `bandwidth: 5`, in Hz; or `error: 0.1`, in rad, at which it gives its greatest torque"
            self._lacks(f"{called} is a servo of unknown speed", help)
        moved = numbers.first(self.editing.effective(self.joint, "armature") or "0") + (written.inertia or 0.0)
        if not moved > 0:
            help = "write `inertia: …` of the moved parts, in kg·m²; or `error: 0.1` instead of `bandwidth`"
            self._lacks(f"the inertia that {called} moves is not known: the data sheet has none of the rotor", help)
        omega = 2 * math.pi * written.bandwidth
        if self.node.tag == "velocity":
            return 0.0, moved * omega
        return moved * omega**2, 2 * (1.0 if written.damping_ratio is None else written.damping_ratio) * moved * omega

    def _lacks(self, message: str, help: str, *key: str) -> NoReturn:
        fault = Fault("missing-key", message, (*self.at, *key), key=True, help=help)
        report_unusable(self.editing, self.node, fault, it="it")


def _without_dampratio(editing: Editing, node: Node, at: Path) -> None:
    """MuJoCo accepts only one of the two attributes, and an actuator cannot undo the value of its class."""
    # MuJoCo 4.0: "kv and dampratio cannot both be defined", even if one of them is 0.
    if node.get("dampratio") is not None:
        assign(editing, node, {"dampratio": None})
    if any(numbers.read(editing.effective(node, "dampratio") or "0")):
        message = f"a class gives {editing.called(node)} a `dampratio`, which excludes `kv`"
        help = "take it out of the class first: `{select: {default: CLASS}, set: {position: {dampratio: null}}}`"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help=help), it="it")


def _without_other(editing: Editing, node: Node, at: Path) -> None:
    if node.tag in (*_SERVOS, *_PLAIN):
        return
    message = f"{editing.called(node)} is a `{node.tag}`, whose gains a data sheet does not give"
    help = "write `convert: {to: position}` next to it, or `to: motor`"
    report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help=help), it="it")

"""Verb `motor`: what a data sheet says, as attributes of an actuator and its joint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, NoReturn

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.build.compose.editing import Editing
from mjcompose.build.compose.values import UnusableValue, report_unusable
from mjcompose.build.verbs.values import SET, Change, Entry
from mjcompose.language.motors import SHEETS, Motor, library
from mjcompose.language.verbs.motor import BANDWIDTH, ERROR, MODEL
from mjcompose.link import numbers
from mjcompose.link.key_layout import joint_type
from mjcompose.model.edit import assign

_SERVOS, _PLAIN = ("position", "velocity"), ("motor",)


def carry_out(entry: Entry, written: Mapping[str, Any], at: Path) -> None:
    """Write the data sheet onto each actuator and its joint."""
    editing = entry.editing
    sheet = _sheet(editing, written[MODEL], (*at, MODEL))
    effort = sheet.effort
    if written.get("effort") == "rated":
        if sheet.rated is None:
            message = f"the data sheet of `{written[MODEL]}` has no rated torque"
            editing.sink.error(
                "missing-key", message, editing.span((*at, "effort")), help="leave `effort` out"
            )
            raise UnusableValue
        effort = sheet.rated
    for index, node in enumerate(entry.found):
        joint, gear = _joint(editing, node, at)
        _without_other(editing, node, at)
        change = Change(editing, SET, entry.masses)
        change.carry_out(joint, index, _of_joint(sheet), at=at)
        values = _Drive(
            editing, node, joint, gear=gear, sheet=sheet, effort=effort, written=written, at=at
        ).values()
        change.carry_out(node, index, values, at=at)


def _sheet(editing: Editing, name: str, at: Path) -> Motor:
    known = {**library(), **SHEETS, **editing.motors}
    if name not in known:
        note = exists_note("motor", sorted(known), name)
        help = did_you_mean(name, known) or "describe it in the section `motors`"
        editing.sink.error(
            "unknown-name", f"the motor `{name}` does not exist", editing.span(at), notes=(note,), help=help,
            subjects=(name,),
        )  # fmt: skip
        raise UnusableValue
    return known[name]


def _joint(editing: Editing, node: Node, at: Path) -> tuple[Node, float]:
    """Return the hinge that an actuator turns, and its `gear`."""
    name = node.get("joint")
    joint = editing.find_node("joint", str(name)) if name else None
    if joint is None or joint_type(joint, editing.classes) != "hinge":
        message = f"{editing.called(node)} does not turn a hinge, and a motor does"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True), it="it")
    gear = numbers.read(editing.effective(node, "gear") or "1")[0]
    if gear == 0:
        message = f"the `gear` of {editing.called(node)} is 0"
        report_unusable(
            editing, node, Fault("wrong-type", message, at, key=True, help="set it to 1"), it="it"
        )
    return joint, gear


def _of_joint(sheet: Motor) -> dict[str, Any]:
    """Return the known attributes of the joint. The others stay as they are."""
    values = {"armature": sheet.reflected, "frictionloss": sheet.friction, "damping": sheet.damping}
    return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, slots=True)
class _Drive:
    """An actuator and the hinge that it turns, with the motor that they become.

    `effort` is the greatest torque at the joint, in N·m, and `gear` that of the actuator.
    """

    editing: Editing
    node: Node
    joint: Node
    gear: float
    sheet: Motor
    effort: float
    written: Mapping[str, Any]
    at: Path

    def values(self) -> dict[str, Any]:
        """Return the attributes of the actuator."""
        # The force of an actuator turns the joint `gear` times as strong, and its length is `gear` times the angle.
        limit = self.effort / abs(self.gear)
        values: dict[str, Any] = {"forcerange": [-limit, limit]}
        if self.node.tag in _SERVOS:
            kp, kv = self._gains()
            values["kv"] = kv / self.gear**2
            if self.node.tag == "position":
                values["kp"] = kp / self.gear**2
                _without_dampratio(self.editing, self.node, self.at)
        if delay := self.sheet.delay:
            values |= {"delay": delay, "nsample": math.ceil(round(delay / _timestep(self.editing), 9))}
        return values

    def _gains(self) -> tuple[float, float]:
        """Return the stiffness and damping of the joint, in N·m/rad and N·m·s/rad."""
        written = self.written
        if ERROR in written:
            if self.sheet.speed is None:
                message = f"the data sheet of `{written[MODEL]}` has no speed, from which `kv` would follow"
                self._lacks(message, "write `bandwidth` in place of `error`", ERROR)
            # A motor gives its whole torque at rest and none at its greatest speed.
            return self.effort / written[ERROR], self.effort / self.sheet.speed
        called = self.editing.called(self.node)
        if BANDWIDTH not in written:
            help = (
                "write `bandwidth: 5`, in Hz; or `error: 0.1`, in rad, at which it gives its greatest torque"
            )
            self._lacks(f"{called} is a servo, and nothing says how fast it is", help)
        armature = numbers.read(self.editing.effective(self.joint, "armature") or "0")[0]
        moved = armature + written.get("inertia", 0.0)
        if not moved > 0:
            message = f"nothing says what inertia {called} moves: the data sheet has none of the rotor"
            help = "write `inertia: …` of what it moves, in kg·m²; or `error: 0.1` in place of `bandwidth`"
            self._lacks(message, help)
        omega = 2 * math.pi * written[BANDWIDTH]
        if self.node.tag == "velocity":
            return 0.0, moved * omega
        return moved * omega**2, 2 * written.get("damping_ratio", 1.0) * moved * omega

    def _lacks(self, message: str, help: str, *key: str) -> NoReturn:
        fault = Fault("missing-key", message, (*self.at, *key), key=True, help=help)
        report_unusable(self.editing, self.node, fault, it="it")


def _without_dampratio(editing: Editing, node: Node, at: Path) -> None:
    """MuJoCo takes one of the two, and nothing on the actuator undoes that of its class."""
    # MuJoCo 4.0: "kv and dampratio cannot both be defined", also where one of them is 0.
    if node.get("dampratio") is not None:
        assign(editing, node, {"dampratio": None})
    if any(numbers.read(editing.effective(node, "dampratio") or "0")):
        message = f"a class gives {editing.called(node)} a `dampratio`, beside which there can be no `kv`"
        help = "`unset` it in the class first: `{select: {default: CLASS}, unset: {position: [dampratio]}}`"
        report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help=help), it="it")


def _without_other(editing: Editing, node: Node, at: Path) -> None:
    if node.tag in (*_SERVOS, *_PLAIN):
        return
    message = f"{editing.called(node)} is a `{node.tag}`, whose gains a data sheet does not give"
    help = "write `convert: {to: position}` beside it, or `to: motor`"
    report_unusable(editing, node, Fault("wrong-type", message, at, key=True, help=help), it="it")


def _timestep(editing: Editing) -> float:
    option = next(editing.root.iterchildren("option"), None)
    return numbers.read(str(option.get("timestep") or "0.002") if option is not None else "0.002")[0]

"""Actuators as MuJoCo compiles them, and the units of their controls and activations.

The control of a position servo is a position, and the control of a velocity servo is a velocity, of the element that
the servo moves. Only a joint determines whether that is an angle: a fixed tendon adds up hinges by coefficients, and
its `range` has no unit in MJCF either. A gear other than 1 and -1 scales the number, so it is not an angle of the
joint.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.sink import Sink
from mjcompose.compose.lengths import why_a_length
from mjcompose.link import numbers
from mjcompose.link.linking import Linking, ModelMeasure
from mjcompose.link.unit_keys import without_keys
from mjcompose.tree import journal
from mjcompose.tree.classes import text_in_effect
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit

_ARRAYS = (
    "actuator_user",
    "actuator_gaintype",
    "actuator_biastype",
    "actuator_dyntype",
    "actuator_gainprm",
    "actuator_biasprm",
    "actuator_dynprm",
    "actuator_ctrllimited",
    "actuator_ctrlrange",
    "actuator_actlimited",
    "actuator_actrange",
    "actuator_actearly",
    "actuator_ctrladr",
    "actuator_ctrlnum",
    "actuator_ctrlspec",
    "actuator_plugin",
    "actuator_trntype",
    "actuator_trnid",
    "actuator_outadr",
    "actuator_gear",
    "jnt_type",
)
PLUGIN = "plugin"
"""The gain and the bias of an actuator whose force a plugin computes."""
_JOINTS = (0, 1)  # mjTRN_JOINT, mjTRN_JOINTINPARENT
_ALONG = (2, 3)  # mjTRN_SLIDERCRANK, mjTRN_TENDON
_SLIDE = 2
_HINGE = 3  # mjJNT_SLIDE, mjJNT_HINGE
_FORCES = {_SLIDE: "N", _HINGE: "N·m"}
INPUTS = {"pos": "position", "vel": "velocity", "ff": "force"}
"""The inputs of a `pid`, in their order in MuJoCo's `actuator_ctrlspec`, each with its meaning."""


# With these dynamics, the control reaches the gain as it is, filtered, or integrated over time.
_PASSING = ("none", "filter", "filterexact", "integrator")


class JointScale(NamedTuple):
    """A control as a function of a number of its joint, `factor` · number + `offset`, and the quantity of that number.

    The quantity is `position`, `velocity` or `force`, or the rate of one of these.
    """

    quantity: str
    factor: float
    offset: float = 0.0

    def control(self, number: float) -> float:
        return self.factor * number + self.offset


class ActuatorModel(Struct):
    """The behavior of an actuator: force = gain · control + bias, by MuJoCo's own parameters."""

    gain: str
    bias: str
    dynamics: str
    gainprm: tuple[float, ...]
    biasprm: tuple[float, ...]
    dynprm: tuple[float, ...] = ()
    ctrl_limited: bool = False
    ctrlrange: tuple[float, float] = (0.0, 0.0)
    act_limited: bool = False
    actrange: tuple[float, float] = (0.0, 0.0)
    inputs: tuple[str, ...] = ()
    act_early: bool = False
    limited: tuple[str, ...] = ()
    """The inputs of a pid whose controls are limited; "" for those that are not."""
    gear: float = 0.0
    """The change of its length if its joint or tendon moves by 1; 0 if it moves none along one axis."""
    unit: str = ""
    """The unit of the force on its joint, N or N·m; "" except for a hinge or a slide."""
    axes: tuple[float, ...] = ()
    """Its `gear` on a ball, a free joint or a site, where the numbers are an axis; empty for other targets."""

    @property
    def turns(self) -> bool:
        """Return whether the actuator acts on a hinge."""
        return self.unit == _FORCES[_HINGE]

    @property
    def is_affine(self) -> bool:
        """Return whether the force is a gain with springs and dampers: a servo, or a plain force."""
        return self.gain == "fixed" and self.bias in ("none", "affine") and not any(self.gainprm[1:])

    @property
    def kp(self) -> float:
        # From 0.0, as a minus sign alone would make -0 of a zero.
        return 0.0 - self.biasprm[1] if self.bias == "affine" else 0.0

    @property
    def kv(self) -> float:
        return 0.0 - self.biasprm[2] if self.bias == "affine" else 0.0

    @property
    def slewmax(self) -> float:
        return self.dynprm[1] if self.dynamics == "pid" else 0.0

    @property
    def form(self) -> str:
        """Return the unit of the gain: `position`, `velocity`, `force`, `other`, or, for a pid, `position+velocity`."""
        if self.gain == "pid":
            return "+".join(INPUTS[each] for each in self.inputs)
        if not self.is_affine or (self.bias == "affine" and self.biasprm[0] != 0):
            return "other"
        # MuJoCo 4.0 compiles `<position kp="3" kv="0.5"/>` to a gain of 3 and a bias of 0 -3 -0.5, and `<velocity
        # kv="3"/>` to a gain of 3 and a bias of 0 0 -3.
        gain = self.gainprm[0]
        if self.kp and gain == self.kp:
            return "position"
        if self.kv and not self.kp and gain == self.kv:
            return "velocity"
        return "force" if not self.kp and not self.kv else "other"

    @property
    def control(self) -> str:
        """Return the quantity of the control: the quantity of `form`, or its rate if the activation integrates it."""
        return f"rate of {self.form}" if self.dynamics == "integrator" else self.form

    def joint_scales(self) -> tuple[JointScale, ...] | None:
        """Return how each control follows from a number of the joint; None if none does."""
        if not self.unit or not self.gear:
            return None
        if self.gain == "pid":
            return tuple(self._scale_of_input(INPUTS[name]) for name in self.inputs)
        if self.gain != "fixed" or self.bias not in ("none", "affine") or self.dynamics not in _PASSING:
            return None
        gain = self.gainprm[0]
        if not gain:
            return None
        bias, stiffness, damping = (0.0, 0.0, 0.0) if self.bias == "none" else self.biasprm[:3]
        rate = "rate of " if self.dynamics == "integrator" else ""
        offset = 0.0 if rate else 0.0 - bias / gain
        # In MuJoCo 4.0, force = gain · input + bias + stiffness · length + damping · velocity, and the joint feels the
        # force times `gear`: the control below gives no force at the position or the velocity.
        if stiffness:
            return (JointScale(f"{rate}position", self.gear * (-stiffness / gain), offset),)
        if damping:
            return (JointScale(f"{rate}velocity", self.gear * (-damping / gain), offset),)
        return (JointScale(f"{rate}force", 1 / (self.gear * gain), offset),)

    def _scale_of_input(self, quantity: str) -> JointScale:
        return JointScale(quantity, 1 / self.gear if quantity == "force" else self.gear)


def actuator_models(linking: Linking, sink: Sink, found: list[Node]) -> dict[Node, ActuatorModel] | None:
    """Return the model of each actuator, or None after a reported error if the model cannot be compiled."""
    if linking.measure is None:
        sink.error("mujoco-missing", "only MuJoCo knows the behavior of these actuators")
        return None
    return models_in(linking.flat(), linking.measure, found)


def models_in(unit: Unit, measure: ModelMeasure, found: list[Node]) -> dict[Node, ActuatorModel] | None:
    """Return the model of each of the actuators of a unit, or None if MuJoCo cannot compile it."""
    # `user` finds an actuator again: where a `<replicate>` multiplies some, MuJoCo puts their copies behind the others.
    marks = {node: (node.get("user"), str(number)) for number, node in enumerate(found, 1)}
    everything = unit.root.findall("actuator/*")
    users = {node: node.get("user") for node in everything}
    with journal.unrecorded():
        # MuJoCo 4.0 refuses a mark that is wider than `nuser_actuator`: "user has more values than nuser_actuator".
        sizes = [(size, journal.drop(size, "nuser_actuator")) for size in unit.root.iterchildren("size")]
        try:
            for node in everything:
                journal.write(node, "user", marks[node][1] if node in marks else "0")
            with without_keys(unit.root):
                arrays = measure(unit, _ARRAYS)
        finally:
            for node, user in users.items():
                journal.drop(node, "user")
                if user is not None:
                    journal.write(node, "user", user)
            for size, room in sizes:
                if room:
                    journal.write(size, "nuser_actuator", room)
    if not arrays:
        return None
    models: dict[Node, ActuatorModel] = {}
    count = len(arrays["actuator_gaintype"])
    width = len(arrays["actuator_user"]) // count
    general = GRAMMAR.element("actuator/general").attributes
    for row in range(count):
        if number := int(arrays["actuator_user"][row * width]):
            models[found[number - 1]] = _model(arrays, row, count, general=general)
    return models


def _model(arrays: Mapping[str, list[float]], row: int, count: int, general: Mapping[str, Attribute]) -> ActuatorModel:
    def numbers_of(name: str) -> tuple[float, ...]:
        values = arrays[f"actuator_{name}"]
        width = len(values) // count
        return tuple(values[row * width : (row + 1) * width])

    def word(name: str) -> str:
        # The keywords are in the order of MuJoCo's own enumerations.
        return general[name].keywords[int(arrays[f"actuator_{name}"][row])]

    first = int(arrays.get("actuator_ctrladr", range(count))[row])  # each of its controls has a row
    has_control = int(arrays.get("actuator_ctrlnum", [1] * count)[row]) > 0
    ctrlrange = arrays["actuator_ctrlrange"][2 * first :]
    actrange = numbers_of("actrange")
    spec = int(arrays["actuator_ctrlspec"][row]) if word("gaintype") == "pid" else 0
    # A plugin's force is its own: MuJoCo 4.0 leaves a gain of 1 and no bias next to it, as for a motor.
    by_plugin = int(arrays["actuator_plugin"][row]) >= 0
    gain, bias = (PLUGIN, PLUGIN) if by_plugin else (word("gaintype"), word("biastype"))
    inputs = tuple(name for bit, name in enumerate(INPUTS) if spec >> bit & 1)
    return ActuatorModel(
        gain,
        bias,
        word("dyntype"),
        numbers_of("gainprm")[:10],
        numbers_of("biasprm")[:10],
        numbers_of("dynprm")[:10],
        has_control and bool(arrays["actuator_ctrllimited"][first]),
        (ctrlrange[0], ctrlrange[1]) if has_control else (0.0, 0.0),
        bool(arrays["actuator_actlimited"][row]),
        (actrange[0], actrange[1]),
        inputs,
        bool(arrays["actuator_actearly"][row]),
        tuple(name if arrays["actuator_ctrllimited"][first + at] else "" for at, name in enumerate(inputs)),
        *_transmission(arrays, row),
    )


def _transmission(arrays: Mapping[str, list[float]], row: int) -> tuple[float, str, tuple[float, ...]]:
    """Return the gear of an actuator, the unit of its force on a joint, and the axes of its gear if it has some."""
    kind = int(arrays["actuator_trntype"][row])
    target = int(arrays["actuator_trnid"][2 * row])
    unit = _FORCES.get(int(arrays["jnt_type"][target]), "") if kind in _JOINTS else ""
    output = int(arrays["actuator_outadr"][row]) if "actuator_outadr" in arrays else row
    gear = tuple(arrays["actuator_gear"][6 * output : 6 * output + 6])
    if unit or kind in _ALONG:
        return gear[0], unit, ()
    return 0.0, unit, gear


_POSITION = "position"
_VELOCITY = "velocity"
_RATE = "rate of position"
_ANGLES = {_POSITION: "an angle", _VELOCITY: "an angular velocity", _RATE: "an angular velocity"}
_ANGLES_AT_JOINT = {**_ANGLES, "rate of velocity": "an angular acceleration"}
_BY_TAG = {"position": _POSITION, "velocity": _VELOCITY, "intvelocity": _RATE}
_UNLIKE = ("plugin", "motor", "damper", "cylinder", "muscle", "adhesion", "dcmotor", "orientation")
"""The controls of these actuators are never positions or velocities of a joint."""
_OF_FORCE = ("motor", "damper", "cylinder", "muscle", "adhesion")
_FORCE = "force"
_GENERAL = ("gaintype", "biastype", "dyntype", "gainprm", "biasprm")


class ControlMeaning(NamedTuple):
    """The meaning of each control, and of the activation, of an actuator, in words; None for a plain number."""

    controls: tuple[str | None, ...] = ()
    activation: str | None = None


@dataclass
class ControlUnits:
    """Determines the units for the actuators of a model without keys; `in_doubt` if MuJoCo may refuse it."""

    linking: Linking
    sink: Sink
    joints: Mapping[str, str]
    in_doubt: bool = False
    known: dict[Node, ControlMeaning] = field(default_factory=dict)

    def of(self, actuator: Node) -> ControlMeaning:
        if actuator not in self.known:
            self.known[actuator] = self._found(actuator)
        return self.known[actuator]

    def is_position(self, actuator: Node) -> bool:
        """Return whether the control of an actuator is the position of its target."""
        control = None if actuator.tag in _UNLIKE else self._control(actuator)
        if control is None and actuator.tag not in _UNLIKE and not self.in_doubt:
            control = self._models[actuator].control if actuator in self._models else "other"
        return control is not None and control.startswith(_POSITION)

    def at_joint(self, actuator: Node) -> tuple[tuple[JointScale, str | None], ...] | None:
        """Return for each control how it follows from a number of the joint, and words for that number as an angle.

        The words are None for a number that is not an angle. Return None if no number of the joint determines the
        control, as with a muscle.
        """
        model = self._models.get(actuator)
        scales = None if model is None else model.joint_scales()
        if model is None or scales is None:
            return None
        words = _ANGLES_AT_JOINT if model.turns else {}
        return tuple((scale, words.get(scale.quantity)) for scale in scales)

    def may_be_angles(self, actuator: Node) -> bool:
        """Return whether the controls of an actuator may be angles: not if they are forces or lengths."""
        if actuator.tag in _OF_FORCE or why_a_length(actuator, self.linking) is not None:
            return False
        control = None if actuator.tag in _UNLIKE else self._control(actuator)
        if control is None and actuator.tag not in _UNLIKE and not self.in_doubt:
            control = self._models[actuator].control if actuator in self._models else None
        return control is None or control.removeprefix("rate of ") != _FORCE

    def _found(self, actuator: Node) -> ControlMeaning:
        joint = actuator.get("joint") or actuator.get("jointinparent")
        if actuator.tag in _UNLIKE or self.joints.get(str(joint)) != "hinge":
            return ControlMeaning()
        gear = self._effective(actuator, "gear")
        if gear and abs(numbers.first(gear)) != 1:
            return ControlMeaning()
        if (control := self._control(actuator)) is None:
            if self.in_doubt:  # MuJoCo would only repeat the fault
                return ControlMeaning()
            control = self._models[actuator].control if actuator in self._models else "other"
        # The gain applies to the quantity that the activation integrates or filters.
        held = control.removeprefix("rate of ")
        return ControlMeaning(tuple(map(_ANGLES.get, control.split("+"))), _ANGLES.get(held))

    @property
    def are_unknown(self) -> bool:
        """Return whether MuJoCo cannot compile the model, for a reason that is reported."""
        return self.in_doubt or self._measured is None

    @cached_property
    def _measured(self) -> Mapping[Node, ActuatorModel] | None:
        """Return the models of all actuators. MuJoCo computes them once."""
        return actuator_models(self.linking, self.sink, self.linking.base.root.findall("actuator/*"))

    @property
    def _models(self) -> Mapping[Node, ActuatorModel]:
        return self._measured or {}

    def _control(self, actuator: Node) -> str | None:
        """Return the quantity of a control if the tree determines it. All actuator tags share settings of classes."""
        tag = str(actuator.tag)
        found = self.linking.base.classes.get(str(actuator.get("class") or "") or None)
        given = {each for each in GRAMMAR.section("actuator").children if found.sets(each)}
        if tag == "intvelocity":
            return _BY_TAG[tag]
        if tag in _BY_TAG:  # their gains are their own; dynamics may come from a class
            dynamic = found.lookup("general", "dyntype") or given - {"general", "position", "velocity", "motor"}
            # With `<default><position kp="50" kv="2"/></default>` MuJoCo 4.0 still compiles `<velocity joint="j"/>`
            # to a gain of 1.
            return None if dynamic else _BY_TAG[tag]
        if tag != "general" or given - {"general"}:
            return None
        words = {name: self._effective(actuator, name) or "" for name in _GENERAL}
        if words["gaintype"] not in ("", "fixed") or words["biastype"] not in ("", "none", "affine"):
            return "other"
        gain, bias = ((*numbers.read(words[name]), *[0.0] * 10)[:10] for name in ("gainprm", "biasprm"))
        return ActuatorModel(
            "fixed", words["biastype"] or "none", words["dyntype"] or "none", gainprm=gain, biasprm=bias
        ).control

    def _effective(self, actuator: Node, name: str) -> str | None:
        return text_in_effect(actuator, kind_of(actuator), name, classes=self.linking.base.classes)

"""The units of the controls and activations of actuators: angles, angular velocities, or plain numbers.

The control of a position servo is a position, that of a velocity servo a velocity, of whatever the servo moves;
`compiled/units.py` determines the same for a compiled model. Only a joint determines whether that is an angle: a
fixed tendon adds up hinges by coefficients, and MJCF gives its `range` no unit either. A gear other than 1 and -1
scales the number, so it is not an angle of the joint.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import cached_property
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.compose.actuator_model import ActuatorModel, actuator_models
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.link import numbers
from composer.link.linking import Linking
from composer.tree.classes import DefaultClass
from composer.tree.effective import text_in_effect
from composer.tree.kinds import kind_of

_POSITION, _VELOCITY, _RATE = "position", "velocity", "rate of position"
_ANGLES = {_POSITION: "an angle", _VELOCITY: "an angular velocity", _RATE: "an angular velocity"}
_BY_TAG = {"position": _POSITION, "velocity": _VELOCITY, "intvelocity": _RATE}
_UNLIKE = ("plugin", "motor", "damper", "cylinder", "muscle", "adhesion", "dcmotor", "orientation")
"""Those whose controls are never positions or velocities of a joint, whatever their gains."""
_GENERAL = ("gaintype", "biastype", "dyntype", "gainprm", "biasprm")


class ControlMeaning(NamedTuple):
    """The meaning of each control, and of the activation, of an actuator, in words; None for a plain number."""

    controls: tuple[str | None, ...] = ()
    activation: str | None = None


@dataclass
class ControlUnits:
    """Determines the units for the actuators of a model that is complete except for its keys.

    `joints` has the types of joints by name. `in_doubt` is set if there were errors before, so MuJoCo may not be
    able to read the model.
    """

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
        """Return whether an actuator's control is the position of what it moves."""
        control = None if actuator.tag in _UNLIKE else self._control(actuator)
        if control is None and actuator.tag not in _UNLIKE and not self.in_doubt:
            control = self._models[actuator].control if actuator in self._models else "other"
        return control is not None and control.startswith(_POSITION)

    def _found(self, actuator: Node) -> ControlMeaning:
        joint = actuator.get("joint") or actuator.get("jointinparent")
        if actuator.tag in _UNLIKE or self.joints.get(str(joint)) != "hinge":
            return ControlMeaning()
        gear = self._effective(actuator, "gear")
        if gear and abs(numbers.read(gear)[0]) != 1:
            return ControlMeaning()
        control = self._control(actuator)
        if control is None:
            if self.in_doubt:  # MuJoCo would only repeat what is wrong
                return ControlMeaning()
            control = self._models[actuator].control if actuator in self._models else "other"
        # What the activation is the integral of, or a filter for, is what the gain is for.
        held = control.removeprefix("rate of ")
        return ControlMeaning(tuple(map(_ANGLES.get, control.split("+"))), _ANGLES.get(held))

    @cached_property
    def _models(self) -> Mapping[Node, ActuatorModel]:
        """Return the actuator models of all actuators that may be servos. MuJoCo computes them once."""
        found = [each for each in self.linking.base.root.iterfind("actuator/*") if each.tag not in _UNLIKE]
        return actuator_models(self.linking, self.sink, found) or {}

    def _control(self, actuator: Node) -> str | None:
        """Return the quantity of an actuator's control as far as the tree tells it.

        As in MuJoCo, all actuator tags share the settings of classes.
        """
        tag, found = str(actuator.tag), self._class(actuator)
        given = {each for each in GRAMMAR.section("actuator").children if found.sets(each)}
        if tag == "intvelocity":
            return _BY_TAG[tag]
        if tag in _BY_TAG:  # their gains are their own; dynamics may come from a class
            dynamic = found.lookup("general", "dyntype") or given - {
                "general",
                "position",
                "velocity",
                "motor",
            }
            # With `<default><position kp="50" kv="2"/></default>` MuJoCo 4.0 compiles `<velocity joint="j"/>` to a gain
            # of 1 all the same.
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

    def _class(self, actuator: Node) -> DefaultClass:
        return self.linking.base.classes.get(str(actuator.get("class") or "") or None)

    def _effective(self, actuator: Node, name: str) -> str | None:
        return text_in_effect(actuator, kind_of(actuator), name, classes=self.linking.base.classes)

"""The behaviour of an actuator as MuJoCo compiled it: gain, bias, dynamics, controls and limits."""

from __future__ import annotations

from collections.abc import Mapping

from lxml.etree import _Element as Node

from composer.compose.without_keyframes import without_keys
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.link.linking import Linking

_ARRAYS = (
    "actuator_user", "actuator_gaintype", "actuator_biastype", "actuator_dyntype",
    "actuator_gainprm", "actuator_biasprm", "actuator_dynprm",
    "actuator_ctrllimited", "actuator_ctrlrange", "actuator_actlimited", "actuator_actrange", "actuator_actearly",
    "actuator_ctrladr", "actuator_ctrlspec",
)  # fmt: skip
INPUTS = {"pos": "position", "vel": "velocity", "ff": "force"}
"""The inputs of a `pid`, in their order in MuJoCo's `actuator_ctrlspec`, and what each is."""


@dataclass(frozen=True, slots=True)
class ActuatorModel:
    """The behaviour of an actuator: force = gain · control + bias, by MuJoCo's own parameters."""

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
        """Return what the gain is for: `position`, `velocity`, `force`, `other`, or of a pid `position+velocity`."""
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
        """Return what the control sets: the quantity of `form`, or its rate if the activation integrates it."""
        return f"rate of {self.form}" if self.dynamics == "integrator" else self.form


def actuator_models(linking: Linking, sink: Sink, found: list[Node]) -> dict[Node, ActuatorModel] | None:
    """Return the model of each actuator, or None after a reported error if the model cannot be compiled."""
    if linking.measure is None:
        sink.error("mujoco-missing", "only MuJoCo knows what these actuators do")
        return None
    unit = linking.flat()
    # `user` finds an actuator again: where a `<replicate>` multiplies some, MuJoCo puts their copies behind the others.
    marks = {node: (node.get("user"), str(number)) for number, node in enumerate(found, 1)}
    everything = unit.root.findall("actuator/*")
    users = {node: node.get("user") for node in everything}
    # MuJoCo 4.0 refuses a mark that is wider than `nuser_actuator`: "user has more values than nuser_actuator".
    sizes = [(size, size.attrib.pop("nuser_actuator", "")) for size in unit.root.iterchildren("size")]
    try:
        for node in everything:
            node.set("user", marks[node][1] if node in marks else "0")
        with without_keys(unit.root):
            arrays = linking.measure(unit, _ARRAYS)
    finally:
        for node, user in users.items():
            node.attrib.pop("user", "")
            if user is not None:
                node.set("user", user)
        for size, room in sizes:
            if room:
                size.set("nuser_actuator", room)
    if not arrays:
        return None
    models: dict[Node, ActuatorModel] = {}
    count = len(arrays["actuator_gaintype"])
    width = len(arrays["actuator_user"]) // count
    general = GRAMMAR.element("actuator/general").attributes
    for row in range(count):
        number = int(arrays["actuator_user"][row * width])
        if number:
            models[found[number - 1]] = _model(arrays, row, count, general)
    return models


def _model(
    arrays: Mapping[str, list[float]], row: int, count: int, general: Mapping[str, Attribute]
) -> ActuatorModel:
    def numbers_of(name: str) -> tuple[float, ...]:
        values = arrays[f"actuator_{name}"]
        width = len(values) // count
        return tuple(values[row * width : (row + 1) * width])

    def word(name: str) -> str:
        # The keywords stand in the order of MuJoCo's own enumerations.
        return general[name].keywords[int(arrays[f"actuator_{name}"][row])]

    first = int(arrays.get("actuator_ctrladr", range(count))[row])  # each of its controls has a row
    ctrlrange, actrange = arrays["actuator_ctrlrange"][2 * first :], numbers_of("actrange")
    spec = int(arrays["actuator_ctrlspec"][row]) if word("gaintype") == "pid" else 0
    inputs = tuple(name for bit, name in enumerate(INPUTS) if spec >> bit & 1)
    return ActuatorModel(
        word("gaintype"), word("biastype"), word("dyntype"),
        numbers_of("gainprm")[:10], numbers_of("biasprm")[:10], numbers_of("dynprm")[:10],
        bool(arrays["actuator_ctrllimited"][first]), (ctrlrange[0], ctrlrange[1]),
        bool(arrays["actuator_actlimited"][row]), (actrange[0], actrange[1]),
        inputs, bool(arrays["actuator_actearly"][row]),
        tuple(name if arrays["actuator_ctrllimited"][first + at] else "" for at, name in enumerate(inputs)),
    )  # fmt: skip

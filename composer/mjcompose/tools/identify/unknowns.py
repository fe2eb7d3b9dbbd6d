"""The unknown numbers of a fit, and the models that have other values of them. Runs in MuJoCo's process."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.base.second_moments import reshaped
from mjcompose.language.measured import COM, COUNTS, DELAY, SHAPE, ZERO
from mjcompose.mujoco.settable import DerivedValues, resolve_addresses
from mjcompose.tools.identify.tables import RecordingFault, Series

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_WITHOUT_CONSTANTS = ("dof_damping", "dof_frictionloss", "actuator_gainprm", "actuator_biasprm", "geom_friction")
"""Arrays on which nothing depends that MuJoCo computes once; `dof_armature` scales the softness of friction."""


class NumberPlace(Struct):
    """A number of mjModel: `sign` is the sign of the attribute, and a number that `follows` changes in proportion."""

    array: str
    index: int
    sign: float = 1.0
    follows: bool = False


class UnknownNumber(Struct):
    """A number to fit: its words, the number of the recipe, and its range, in MuJoCo's units.

    `places` has the places of its number in mjModel; a delay has none. `is_scaled` says that it is tried by factors.
    """

    field: str
    kind: str
    names: tuple[str, ...]
    attribute: str
    nominal: float
    low: float
    high: float
    places: tuple[NumberPlace, ...] = ()

    @property
    def word(self) -> str:
        return f"{self.kind} {self.names[0]} {self.attribute}"

    @property
    def prior(self) -> float:
        """The standard deviation of a number that is anywhere in the range."""
        return (self.high - self.low) / math.sqrt(12)

    @property
    def is_scaled(self) -> bool:
        return self.low == 0 or (self.low > 0 and self.high > 5 * self.low)


def unknowns_of(mujoco: Any, model: MjModel, fields: Iterable[dict[str, Any]]) -> list[UnknownNumber]:
    """Return the unknowns of the fields, element by element. Raises RecordingFault for a field that cannot be fitted.

    Each field has `name`, `kind`, `groups` of elements with `name` and `tag`, `attribute`, and `bounds`: the word and
    two numbers.
    """
    found: list[UnknownNumber] = []
    for field in fields:
        found += [_unknown(mujoco, model, field, group) for group in field["groups"]]
    taken: dict[tuple[str, str, str], UnknownNumber] = {}
    for unknown in found:
        for name in unknown.names:
            first = taken.setdefault((unknown.kind, name, unknown.attribute), unknown)
            if first is not unknown:
                message = f"field `{first.field}` has {unknown.attribute} of {unknown.kind} `{name}`, too"
                raise RecordingFault("name-clash", message, "let one of them select less", field=unknown.field)
    order = {owner: index for index, owner in enumerate(dict.fromkeys((each.kind, each.names) for each in found))}
    return sorted(found, key=lambda each: order[each.kind, each.names])


def _unknown(mujoco: Any, model: MjModel, field: dict[str, Any], group: list[dict[str, str]]) -> UnknownNumber:
    kind = field["kind"]
    attribute = field["attribute"]
    names = tuple(element["name"] for element in group)
    places: list[NumberPlace] = []
    if attribute == ZERO:
        nominal = 0.0
        places = [_zero_place(mujoco, model, name, field) for name in names]
    elif _base(attribute) in COUNTS:
        nominal = 0.0
        places = [NumberPlace("body", int(model.body(name).id)) for name in names]
    elif attribute == DELAY:
        nominal = float(model.actuator_delay[model.actuator(names[0]).id]) if hasattr(model, "actuator_delay") else 0.0
    else:
        for element in group:
            places += _places(mujoco, model, element, field)
        lead = places[0]
        nominal = float(getattr(model, lead.array).reshape(-1)[lead.index]) * lead.sign
    low, high = _bounds(field, nominal, f"{attribute} of {kind} `{names[0]}`")
    _check_moves(model, kind, names, attribute, field)
    return UnknownNumber(field["name"], kind, names, attribute, nominal, low, high, tuple(places))


def _base(attribute: str) -> str:
    return attribute.partition("[")[0]


def _index(attribute: str) -> int:
    return int(attribute.partition("[")[2][:-1])


def _zero_place(mujoco: Any, model: MjModel, name: str, field: dict[str, Any]) -> NumberPlace:
    joint = model.joint(name)
    # An enum of MuJoCo 4.0 equals an int, and not a number of an array.
    if int(joint.type[0]) not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
        message = f"`{name}` is neither a hinge nor a slide, so it has no zero"
        raise RecordingFault("not-identifiable", message, "select hinges and slides", field=field["name"])
    return NumberPlace("jnt", int(joint.id))


def _places(mujoco: Any, model: MjModel, element: dict[str, str], field: dict[str, Any]) -> list[NumberPlace]:
    base, _, index = field["attribute"].partition("[")
    question = {"tag": element["tag"], "family": field["kind"], "name": element["name"], "place": None}
    start = int(index[:-1]) if index else 0
    asked = {**question, "attribute": base, "start": start, "count": 1}
    (answer,) = resolve_addresses(mujoco, model, [asked])
    if "error" in answer:
        help = "only numbers of the compiled model can be fitted"
        raise RecordingFault("not-identifiable", answer["error"], help, field=field["name"])
    places = []
    for target in answer["targets"][0]:
        array = getattr(model, target["array"])
        flat = int(np.ravel_multi_index(target["index"], array.shape))
        places.append(NumberPlace(target["array"], flat, target.get("sign", 1), bool(target.get("follows"))))
    return places


def _bounds(field: dict[str, Any], nominal: float, what: str) -> tuple[float, float]:
    word, first, second = field["bounds"]
    low, high = {
        "range": (first, second),
        "scale": tuple(sorted((nominal * first, nominal * second))),
        "offset": (nominal + first, nominal + second),
    }[word]
    name = field["name"]
    if not low < high:
        help = "a `scale` of a number that is 0 is 0: write `range`" if word == "scale" else "write a wider range"
        raise RecordingFault("out-of-range", f"{what} cannot be between {low:g} and {high:g}", help, field=name)
    if not low <= nominal <= high:
        message = f"{what} is {nominal:g} in the recipe, outside of [{low:g}, {high:g}]"
        help = "the recipe's number is the best guess before the recording: widen the range, or `edit` the number"
        raise RecordingFault("out-of-range", message, help, field=name)
    return low, high


def _check_moves(model: MjModel, kind: str, names: Sequence[str], attribute: str, field: dict[str, Any]) -> None:
    for name in names:
        if kind == "body" and model.body_weldid[model.body(name).id] == 0:
            message = f"body `{name}` is fixed to the world, so its inertia moves nothing"
            raise RecordingFault("not-identifiable", message, "select a body that a joint moves", field=field["name"])


class ModelPool:
    """Copies of a model, each with its own values of the unknowns."""

    def __init__(self, mujoco: Any, model: MjModel, unknowns: Sequence[UnknownNumber]) -> None:
        self._mujoco = mujoco
        self.nominal = model
        self.unknowns = unknowns
        self._copies: list[tuple[MjModel, DerivedValues]] = []
        arrays = {place.array for unknown in unknowns for place in unknown.places}
        self._derives = not arrays <= set(_WITHOUT_CONSTANTS)

    def write(self, values: Series, slot: int) -> MjModel:
        """Return the copy with this number, with these values of the unknowns."""
        model, derived = self._copy(slot)
        for unknown, value in zip(self.unknowns, values, strict=True):
            if unknown.attribute == ZERO:
                for place in unknown.places:
                    self._move_zero(model, place.index, float(value))
            elif _base(unknown.attribute) not in COUNTS:
                self._put(model, unknown, float(value))
        self._put_inertias(model, values)
        if self._derives:
            derived.settle()
        return model

    def _copy(self, slot: int) -> tuple[MjModel, DerivedValues]:
        while len(self._copies) <= slot:
            model = copy.copy(self.nominal)
            self._copies.append((model, DerivedValues(self._mujoco, model, self._mujoco.MjData(model))))
        return self._copies[slot]

    def _put(self, model: MjModel, unknown: UnknownNumber, value: float) -> None:
        ratio = 1.0
        for place in unknown.places:
            numbers = getattr(model, place.array).reshape(-1)
            before = float(getattr(self.nominal, place.array).reshape(-1)[place.index])
            if place.follows:
                numbers[place.index] = before * ratio
            else:
                numbers[place.index] = place.sign * value
                ratio = value / (place.sign * before) if before else 1.0

    def _put_inertias(self, model: MjModel, values: Series) -> None:
        """Write centers of mass and shapes of inertias, which the verb `calibrate` writes in the same way."""
        shapes: dict[int, list[float]] = {}
        for unknown, value in zip(self.unknowns, values, strict=True):
            base = _base(unknown.attribute)
            if base not in COUNTS:
                continue
            for place in unknown.places:
                index = _index(unknown.attribute)
                if base == COM:
                    model.body_ipos[place.index, index] = self.nominal.body_ipos[place.index, index] + float(value)
                else:
                    shapes.setdefault(place.index, [0.0] * COUNTS[SHAPE])[index] = float(value)
        for body, shape in shapes.items():
            ratio = model.body_mass[body] / self.nominal.body_mass[body]
            moments = (self.nominal.body_inertia[body] * ratio).tolist()
            tensor = np.array(reshaped(moments, tuple(self.nominal.body_iquat[body].tolist()), shape))
            model.body_inertia[body], axes = np.linalg.eigh(tensor)
            if np.linalg.det(axes) < 0:
                axes[:, 0] *= -1
            self._mujoco.mju_mat2Quat(model.body_iquat[body], axes.reshape(-1))

    def _move_zero(self, model: MjModel, joint: int, zero: float) -> None:
        """Move the reference, the spring and the range of a joint together, as the verb `calibrate` does."""
        address = model.jnt_qposadr[joint]
        model.qpos0[address] = self.nominal.qpos0[address] + zero
        has_spring = bool(np.any(self.nominal.jnt_stiffness[joint]))
        model.qpos_spring[address] = self.nominal.qpos_spring[address] + (zero if has_spring else 0.0)
        if self.nominal.jnt_limited[joint]:
            model.jnt_range[joint] = self.nominal.jnt_range[joint] + zero

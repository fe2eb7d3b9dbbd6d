"""The check `equal`: the value of an attribute."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.build.checks.check import Scope, failed, unknown
from mjcompose.model.values import is_in_degrees
from mjcompose.mujoco.addresses import rows_of
from mjcompose.mujoco.arrays import JOINT_TYPES
from mjcompose.mujoco.attributes import ANGLES, array_of

_ROUNDING = {4: 1e-6, 8: 1e-9}
"""Rounding tolerance by the bytes of a number, relative to the larger of 1 and the value."""
_SHOWN = 8


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with its unit as written; `per_unit` is one such unit in the unit of the compiled model."""

    number: float
    unit: str | None
    per_unit: float

    @property
    def value(self) -> float:
        """The number in the compiled model's unit."""
        return self.number * self.per_unit

    def __str__(self) -> str:
        if isinstance(self.number, bool):
            return str(self.number).lower()
        return f"{self.number:.9g}{self.unit or ''}"

    def like(self, value: float) -> str:
        """Return a value of the compiled model as text, in the unit of this quantity."""
        if isinstance(value, bool):
            return str(value).lower()
        return str(Quantity(value / self.per_unit, self.unit, self.per_unit))


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report elements with another value."""
    tag, glob = asked["tag"], asked["element"]
    matched = scope.matching(tag, glob)
    if not matched:
        return [unknown(tag, glob, scope.names(tag), tag)]
    wrong: list[tuple[str, str, str]] = []
    for index in matched:
        actual = value_of(scope, tag, index, attr=asked["attr"])
        if isinstance(actual, Fault):
            return [actual]
        if asked["index"] is not None:
            if asked["index"] >= actual.size:
                message = f"`{asked['attr']}` of {tag} `{glob}` has {actual.size} numbers"
                note = Note(f"the first is `{asked['attr']}[0]`")
                return [Fault("wrong-length", message, ("attr",), notes=(note,))]
            actual = actual[asked["index"]][None]
        scope.values[scope.written(tag, index)] = _plain(actual)
        expected = expected_of(scope, tag, index, asked=asked)
        if isinstance(expected, Fault):
            return [expected]
        if len(expected) != actual.size:
            message = (
                f"`{asked['attr']}` of {tag} `{glob}` has {actual.size} numbers, `value` has {len(expected)}"
            )
            return [Fault("wrong-length", message, ("value",))]
        tol = None if asked["tol"] is None else _quantity(asked["tol"][0], asked["tol"][1], asked["attr"])
        if not equal(actual, [each.value for each in expected], None if tol is None else tol.value):
            tolerance = "" if tol is None else f" ± {tol}"
            have = [each.like(value) for each, value in zip(expected, actual.tolist(), strict=True)]
            wanted = _listed([str(each) for each in expected])
            wrong.append((scope.called(tag, index), wanted + tolerance, _listed(have)))
    if not wrong:
        return []
    name, wanted, found = wrong[0]
    attr = asked["attr"] + ("" if asked["index"] is None else f"[{asked['index']}]")
    more = [f"{other}: {value}" for other, _, value in wrong[1:_SHOWN]]
    more += [f"and {len(wrong) - _SHOWN} more"] if len(wrong) > _SHOWN else []
    return [failed(f"`{attr}` of {name} is {found}, not {wanted}", wanted, found, "value", more=more)]


def _plain(numbers: Any) -> Any:
    """Return one number or a list of numbers for JSON; single-precision numbers are rounded to six digits."""
    single = numbers.dtype == np.float32
    found = [float(f"{each:.6g}") if single else each for each in numbers.tolist()]
    return found[0] if len(found) == 1 else found


def value_of(scope: Scope, tag: str, index: int, attr: str) -> Any | Fault:
    """Return the numbers of an attribute as a flat array."""
    model, name = scope.model, array_of(tag, attr)
    array = getattr(model, name, None)
    if array is None:
        return Fault("unknown-attribute", f"this MuJoCo has no `{attr}` of a {tag}", ("attr",))
    row = rows_of(
        model, tag, name, index=index
    ).start  # a joint has one value; for an actuator the first counts
    return np.atleast_1d(array[row]).ravel()


def expected_of(scope: Scope, tag: str, index: int, asked: dict[str, Any]) -> list[Quantity] | Fault:
    """Return the expected numbers in the unit of the compiled model."""
    attr = asked["attr"]
    joint = JOINT_TYPES[int(scope.model.jnt_type[index])].word if tag == "joint" else ""
    angular = attr in ANGLES.get(joint, ())
    found: list[Quantity] = []
    for number, unit in asked["value"]:
        if unit is None and angular and number != 0:
            unit = {"degree": "deg", "radian": "rad", None: None}[asked["angle"]]
            if unit is None:
                help = f"write `{number:.9g}deg` or `{number:.9g}rad`, or `angle: degree` at the top of the recipe"
                message = f"`{attr}` of {joint} {scope.called(tag, index)} is an angle, `value` has no unit"
                return Fault("bare-angle", message, ("value",), help=help)
        found.append(_quantity(number, unit, "deg" if is_in_degrees(tag, attr) else "rad"))
    return found


def _quantity(number: float, unit: str | None, own: str) -> Quantity:
    if unit in (None, own):
        return Quantity(number, unit, 1.0)
    return Quantity(number, unit, math.radians(1) if own == "rad" else math.degrees(1))


def equal(actual: Any, expected: list[float], tol: float | None) -> bool:
    wanted = np.array(expected, dtype=np.float64)
    if tol is None:
        part = _ROUNDING[4 if actual.dtype == np.float32 else 8]
        return bool(
            np.all(np.abs(actual.astype(np.float64) - wanted) <= part * np.maximum(1.0, np.abs(wanted)))
        )
    return bool(np.all(np.abs(actual.astype(np.float64) - wanted) <= tol))


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"[{', '.join(words)}]"

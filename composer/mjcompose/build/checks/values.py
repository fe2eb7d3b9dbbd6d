"""Values of elements in a compiled model, and whether they are those that a recipe writes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.build.checks.check import Scope
from mjcompose.mujoco.arrays import JOINT_TYPES, words
from mjcompose.mujoco.attributes import ANGLES, ENUMERATED, array_of
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.pattern import paths_of
from mjcompose.tree.values import is_in_degrees

SUBTREE_MASS = "subtree_mass"
"""An attribute of bodies that MJCF does not have: the mass of a body and all below it."""
Number = tuple[float, str | None]
"""A number and the unit that is written behind it, `deg` or `rad`."""
ROUNDING = {4: 1e-6, 8: 1e-9}
"""Rounding tolerance by the bytes of a number, relative to the larger of 1 and the value."""
_NAMING = ("geom", "site", "camera", "light", "skin", "material", "pair", "exclude", "equality", "tendon", "actuator",
           "sensor")  # fmt: skip
_NOT_COMPILED = ("default", "instance")


@cache
def keywords(tag: str) -> Mapping[str, tuple[str, ...]]:
    """Return the attributes of a tag that have keywords, with these. The keywords of a family's `type` are its tags."""
    paths = paths_of(tag)
    found: dict[str, tuple[str, ...]] = {}
    for name in sorted(ENUMERATED.get(tag, ())):
        words = {word for path in paths for word in _words(path, name)}
        found[name] = tuple(sorted(words or {GRAMMAR.element(path).tag for path in paths}))
    return found


def _words(path: str, name: str) -> tuple[str, ...]:
    attribute = GRAMMAR.element(path).attributes.get(name)
    return attribute.keywords if attribute is not None else ()


@cache
def naming(tag: str) -> Mapping[str, str | None]:
    """Return the attributes of a tag that name another element, with its kind.

    The kind is None if another attribute gives it.
    """
    if tag not in _NAMING:
        return {}
    return {
        name: attribute.refers
        for path in sorted(paths_of(tag))
        for name, attribute in GRAMMAR.element(path).attributes.items()
        if (attribute.is_reference or attribute.refers_by) and attribute.refers not in _NOT_COMPILED
    }


_SECOND = ("refsite", "slidersite", "refname")


def words_of(scope: Scope, tag: str, index: int, attr: str) -> Iterator[str]:
    """Yield the value of an attribute.

    There are several if MuJoCo does not store which of two it is, and none if the attribute is not set.
    """
    if attr in ENUMERATED.get(tag, ()):
        array = array_of(tag, attr)
        values = getattr(scope.model, array, None)
        if values is not None:
            yield words(scope.mujoco, array)[int(values[index])]
        return
    from mjcompose.mujoco.references import links

    kind = naming(tag)[attr]
    for link in links(scope.model, tag, index):
        if link.index >= 0 and (kind is None or link.kind == kind) and _is_meant(link.field, tag, attr):
            yield scope.written(link.kind, link.index)


def _is_meant(field: str, tag: str, attr: str) -> bool:
    """Return whether the attribute writes the reference that the field of mjModel stores."""
    if attr == "target":
        return "target" in field
    if tag == "sensor":
        return field == ("sensor_refid" if attr in _SECOND or attr.endswith("2") else "sensor_objid")
    if tag == "equality":
        return field == ("eq_obj2id" if attr.endswith("2") else "eq_obj1id")
    if tag == "actuator":
        return field == f"actuator_trnid[{int(attr in _SECOND)}]"
    return True


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


def pair_of(
    scope: Scope, tag: str, index: int, asked: Mapping[str, Any], numbers: Sequence[Number]
) -> tuple[Any, list[Quantity]] | Fault:
    """Return the numbers that an element has, as a flat array, and those that are written."""
    actual = values_of(scope, tag, index, asked)
    if isinstance(actual, Fault):
        return actual
    quantities = quantities_of(scope, tag, index, asked, numbers)
    return quantities if isinstance(quantities, Fault) else (actual, quantities)


def values_of(scope: Scope, tag: str, index: int, asked: Mapping[str, Any]) -> Any | Fault:
    """Return the numbers of an attribute as a flat array, or the number at its `index`."""
    import numpy as np

    from mjcompose.mujoco.addresses import rows_of

    attr = asked["attr"]
    name = "body_subtreemass" if attr == SUBTREE_MASS else array_of(tag, attr)
    array = getattr(scope.model, name, None)
    if array is None:
        return Fault("unknown-attribute", f"this MuJoCo has no `{attr}` of a {tag}", ("attr",))
    row = rows_of(scope.model, tag, name, index=index).start  # a joint has one value; for an actuator the first counts
    numbers = np.atleast_1d(array[row]).ravel()
    if asked["index"] is None:
        return numbers
    if asked["index"] >= numbers.size:
        message = f"`{attr}` of {scope.called(tag, index)} has {numbers.size} numbers"
        return Fault("wrong-length", message, ("attr",), notes=(Note(f"the first is `{attr}[0]`"),))
    return numbers[asked["index"]][None]


def quantities_of(
    scope: Scope, tag: str, index: int, asked: Mapping[str, Any], numbers: Sequence[Number]
) -> list[Quantity] | Fault:
    """Return the expected numbers in the unit of the compiled model."""
    attr = asked["attr"]
    joint = JOINT_TYPES[int(scope.model.jnt_type[index])].word if tag == "joint" else ""
    angular = attr in ANGLES.get(joint, ())
    quantities: list[Quantity] = []
    for number, unit in numbers:
        if unit is None and angular and number != 0:
            unit = {"degree": "deg", "radian": "rad", None: None}[asked["angle"]]
            if unit is None:
                help = f"write `{number:.9g}deg` or `{number:.9g}rad`, or `angle: degree` at the top of the recipe"
                message = f"`{attr}` of {joint} {scope.called(tag, index)} is an angle, and `{number:.9g}` has no unit"
                return Fault("bare-angle", message, help=help)
        quantities.append(quantity(number, unit, unit_of(tag, attr)))
    return quantities


def unit_of(tag: str, attr: str) -> str:
    return "deg" if is_in_degrees(tag, attr) else "rad"


def quantity(number: float, unit: str | None, own: str) -> Quantity:
    if unit in (None, own):
        return Quantity(number, unit, 1.0)
    return Quantity(number, unit, math.radians(1) if own == "rad" else math.degrees(1))


def equal(actual: Any, expected: Sequence[Quantity], tol: float | None) -> bool:
    import numpy as np

    meant = np.array([each.value for each in expected], dtype=np.float64)
    apart = np.abs(actual.astype(np.float64) - meant)
    if tol is None:
        part = ROUNDING[4 if actual.dtype == np.float32 else 8]
        return bool(np.all(apart <= part * np.maximum(1.0, np.abs(meant))))
    return bool(np.all(apart <= tol))


def plain(numbers: Any) -> Any:
    """Return one number or a list of numbers for JSON; single-precision numbers are rounded to six digits."""
    plain = [float(f"{each:.6g}") if numbers.dtype.itemsize == 4 and numbers.dtype.kind == "f" else each
             for each in numbers.tolist()]  # fmt: skip
    return plain[0] if len(plain) == 1 else plain


def like(quantities: Sequence[Quantity], numbers: Sequence[float]) -> list[str]:
    """Return numbers as text, each in the unit of its quantity, or all in the first number's unit."""
    if len(quantities) != len(numbers):
        quantities = [quantities[0]] * len(numbers)
    return [each.like(number) for each, number in zip(quantities, numbers, strict=True)]

"""The check `equal`: that an attribute has a value in the compiled model."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, ClassVar

from composer.compiled.attributes import TAGS, attributes
from composer.diagnostics.suggest import closest, exists_note
from composer.expr.angle import Angle
from composer.recipe.checks.keys import Keys
from composer.recipe.checks.kind import NAME, Kind, mapping_schema
from composer.recipe.fault import Path, Remark
from composer.recipe.pattern import GLOB
from composer.recipe.reference import reference

_INDEXED = re.compile(r"([A-Za-z]\w*)(?:\[(\d{1,3})\])?")

Number = tuple[float, str | None]
"""A number and the unit that is written behind it, `deg` or `rad`."""


@dataclass(frozen=True, slots=True)
class Equal:
    """`attr` of every element that the glob `element` names is `value`; with `index`, one number of it is.

    A `tol` without a unit is in that of the compiled model; None is rounding.
    """

    word: ClassVar[str] = "equal"
    name: str
    tag: str
    element: str
    attr: str
    index: int | None
    value: tuple[Number, ...]
    tol: Number | None
    at: Path


def read(keys: Keys, at: Path) -> Equal | None:
    """The check, or None where there was a fault."""
    before = len(keys.faults)
    keys.known((*TAGS, "attr", "value", "tol"))
    tag = keys.one_of(*TAGS)
    if tag is None:
        message = f"`equal` of {keys.owner} does not say of what"
        remark = Remark(exists_note("tag", TAGS).message)
        keys.add("missing-key", message, key=True, remarks=(remark,), help="write for instance `joint: NAME`")
    keys.required("attr", "damping")
    keys.required("value", "0.5")
    element = keys.glob_of(keys.value[tag], "a name or a glob", tag) if tag else None
    attr, index = _attribute(keys, tag)
    value = _value(keys, index) if "value" in keys.value else None
    tol = _tolerance(keys)
    if len(keys.faults) > before or tag is None or element is None or attr is None or value is None:
        return None
    return Equal(keys.name, tag, element, attr, index, value, tol, at)


def _tolerance(keys: Keys) -> Number | None:
    """How far off it may be: a number, or an angle with its unit."""
    written = keys.value.get("tol")
    angle = Angle.read(written) if isinstance(written, str) else None
    if angle is not None and angle.value >= 0:
        return angle.value, angle.unit
    number = keys.number("tol", least=0)
    return None if number is None else (number, None)


def _attribute(keys: Keys, tag: str | None) -> tuple[str | None, int | None]:
    """The attribute and the index in brackets behind it."""
    written = keys.text("attr", "an attribute of MJCF")
    return (None, None) if written is None or tag is None else attribute_of(keys, tag, written, "attr")


def attribute_of(
    keys: Keys, tag: str, written: str, *at: str | int, others: Collection[str] = ()
) -> tuple[str | None, int | None]:
    """The attribute that is written at a place, and the index behind it; what no model can be asked for is told.

    `others` are attributes of which no numbers are asked for, but which may be meant.
    """
    match = _INDEXED.fullmatch(written)
    if match is None:
        message = f"`{at[-1]}` of {keys.owner} is `{written}`, which is not an attribute"
        keys.add("wrong-type", message, *at, help='write for instance `damping`, or `"range[1]"`')
        return None, None
    name, index = match.groups()
    if tag not in TAGS or name not in attributes(tag):
        known = [*(attributes(tag) if tag in TAGS else ()), *others]
        near = closest(name, known)
        remark = Remark(exists_note("attribute", known, name).message)
        message = f"`{name}` of a {tag} is nothing that {keys.owner} could ask for"
        help = f"write `{near[0]}`" if near else None
        keys.add("unknown-attribute", message, *at, remarks=(remark,), help=help)
        return None, None
    return name, None if index is None else int(index)


def _value(keys: Keys, index: int | None) -> tuple[Number, ...] | None:
    return numbers_of(keys, keys.value["value"], index, "value")


def numbers_of(keys: Keys, value: Any, index: int | None, *at: str | int) -> tuple[Number, ...] | None:
    """The numbers that are written at a place, one where the attribute has an `index`."""
    if not isinstance(value, list):
        number = _number(keys, value, *at)
        return None if number is None else (number,)
    if not value:
        keys.add("wrong-length", f"`value` of {keys.owner} is an empty list", *at)
        return None
    if index is not None:
        message = f"`value` of {keys.owner} expects one number, got a list"
        help = "without an index, `attr` means all numbers of the attribute"
        keys.add("wrong-type", message, *at, help=help)
        return None
    found = [_number(keys, each, *at, place) for place, each in enumerate(value)]
    return None if None in found else tuple(each for each in found if each is not None)


def _number(keys: Keys, value: Any, *at: str | int) -> Number | None:
    if isinstance(value, bool):
        return value, None
    angle = Angle.read(value) if isinstance(value, str) else None
    if angle is not None:
        return angle.value, angle.unit
    number = keys.number_of(value, *at)
    return None if number is None else (number, None)


KIND = Kind(
    "equal",
    read,
    mapping_schema(
        "An attribute has a value in the compiled model.",
        {
            **{tag: {**GLOB, "description": f"a {tag}, or a glob for several"} for tag in TAGS},
            "attr": {
                **NAME,
                "description": "an attribute of MJCF, with an index for one of its numbers: `range[1]`",
            },
            "value": {
                "type": ["number", "boolean", "string", "array"],
                "items": {"anyOf": [reference("number"), {"type": "boolean"}]},
                "minItems": 1,
                "pattern": r"^[-+.0-9eE]+(?:deg|rad)$|\$\{",
                "patternErrorMessage": "expected a number, an angle such as 90deg, a boolean, a list of these, or ${…}",
                "description": "what it must be: a number, an angle, a boolean, or a list",
            },
            "tol": {
                **reference("number"),
                "description": "how far off each number may be; without it, rounding",
            },
        },
        "attr",
        "value",
    ),
    "{joint: NAME, attr: damping, value: 0.5}",
)

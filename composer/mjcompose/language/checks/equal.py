"""The check `equal`: an attribute has a value in the compiled model."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.base.suggest import advised, exists_note
from mjcompose.language.checks import form
from mjcompose.language.checks.form import Glob, Key, Keyed, Keys, Kind, Name
from mjcompose.language.form import Schema, reference
from mjcompose.mujoco.attributes import TAGS, attributes
from mjcompose.text.expression_values import Angle

_INDEXED = re.compile(r"([A-Za-z]\w*)(?:\[(\d{1,3})\])?")

Number = tuple[float, str | None]
"""A number and the unit that is written behind it, `deg` or `rad`."""


@dataclass(frozen=True, slots=True)
class Equal:
    """`attr` of every element that the glob `element` matches is `value`. With `index`, only that number counts.

    A `tol` without a unit is in the unit of the compiled model. Without it, only rounding is allowed.
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


def attribute_of(
    keys: Keys, tag: str, written: str, *at: str | int, others: Collection[str] = ()
) -> tuple[str | None, int | None]:
    """Return the attribute that is written at a place, and its index, each None if there is none.

    An attribute that no model has is reported. `others` are attributes without numbers, which the message offers too.
    """
    match = _INDEXED.fullmatch(written)
    if match is None:
        message = f"`{at[-1]}` of {keys.owner} is `{written}`, which is not an attribute"
        keys.add("wrong-type", message, *at, help='write for instance `damping`, or `"range[1]"`')
        return None, None
    name, index = match.groups()
    if tag not in TAGS or name not in attributes(tag):
        known = [*(attributes(tag) if tag in TAGS else ()), *others]
        help, fix = advised(name, known)
        note = exists_note("attribute", known, name)
        message = f"`{name}` of a {tag} is nothing that {keys.owner} could ask for"
        keys.add("unknown-attribute", message, *at, notes=(note,), help=help, fix=fix)
        return None, None
    return name, None if index is None else int(index)


def numbers_of(keys: Keys, value: Any, *at: str | int) -> tuple[Number, ...] | None:
    """Return the numbers that are written at a place, or None after a reported fault."""
    if not isinstance(value, list):
        number = _number(keys, value, *at)
        return None if number is None else (number,)
    if not value:
        keys.add("wrong-length", f"`value` of {keys.owner} is an empty list", *at)
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


def check_one(keys: Keys, value: Any, index: int | None, *at: str | int) -> None:
    """Report a list if the attribute has an index, which means one number."""
    if index is not None and isinstance(value, list) and value:
        message = f"`value` of {keys.owner} expects one number, got a list"
        help = "without an index, `attr` means all numbers of the attribute"
        keys.add("wrong-type", message, *at, help=help)


class Values:
    """Form of a number, an angle, a boolean, or a list of these, read as a tuple of numbers with their units."""

    def read(self, keys: Keys, value: Any, *at: str | int) -> tuple[Number, ...] | None:
        return numbers_of(keys, value, *at)

    def schema(self) -> Schema:
        return {
            "type": ["number", "boolean", "string", "array"],
            "items": {"anyOf": [reference("number"), {"type": "boolean"}]},
            "minItems": 1,
            "pattern": r"^[-+.0-9eE]+(?:deg|rad)$|\$\{",
            "patternErrorMessage": "expected a number, an angle such as 90deg, a boolean, a list of these, or ${…}",
        }


class Tolerance:
    """Form of a tolerance: a number, or an angle with its unit."""

    number = form.Number(least=0)

    def read(self, keys: Keys, value: Any, *at: str | int) -> Number | None:
        angle = Angle.read(value) if isinstance(value, str) else None
        if angle is not None and angle.value >= 0:
            return angle.value, angle.unit
        number = self.number.read(keys, value, *at)
        return None if number is None else (number, None)

    def schema(self) -> Schema:
        return self.number.schema()


FORM = Keyed(
    "An attribute has a value in the compiled model.",
    *(
        Key(tag, Glob("a name or a glob"), f"{'an' if tag[0] in 'ae' else 'a'} {tag}, or a glob for several")
        for tag in TAGS
    ),
    Key(
        "attr",
        Name("an attribute of MJCF"),
        "an attribute of MJCF, with an index for one of its numbers: `range[1]`",
        needed="damping",
    ),
    Key("value", Values(), "what it must be: a number, an angle, a boolean, or a list", needed="0.5"),
    Key("tol", Tolerance(), "how far off each number may be; without it, rounding"),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Equal | None:
    tag = keys.one_of(*TAGS)
    if tag is None:
        message = f"`equal` of {keys.owner} does not say of what"
        note = exists_note("tag", TAGS)
        keys.add("missing-key", message, key=True, notes=(note,), help="write for instance `joint: NAME`")
        return None
    if found["attr"] is None:
        return None
    attr, index = attribute_of(keys, tag, found["attr"], "attr")
    check_one(keys, keys.value.get("value"), index, "value")
    return (
        Equal(
            keys.name, tag, found[tag], attr=attr, index=index, value=found["value"], tol=found["tol"], at=at
        )
        if attr
        else None
    )


KIND = Kind("equal", FORM, make, example="{joint: NAME, attr: damping, value: 0.5}")

"""`replicate`: rows of copies of a part."""

from __future__ import annotations

import math
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import advised
from composer.diagnostics.unknown import unknown_attribute
from composer.grammar import GRAMMAR
from composer.limits import advice, in_force
from composer.recipe.angles import bare_angle
from composer.recipe.attribute_schema import attribute_schema
from composer.recipe.element import Single, Value
from composer.recipe.element_schema import mapping
from composer.recipe.fault import Fault, Path, fault_at
from composer.recipe.form import Form
from composer.recipe.presence import missing_key
from composer.recipe.reader import Reader
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.value import read_value

COUNT = "count"
ATTRIBUTES = (COUNT, "offset", "euler")
"""What an axis has of MJCF's `<replicate>`."""
_STILL: tuple[Single, ...] = (0, 0, 0)


@dataclass(frozen=True, slots=True)
class Axis:
    """A row of copies. Each is `offset` (metres) from the one before and turned by `euler`."""

    count: int
    offset: tuple[Single, ...] = _STILL
    euler: tuple[Single, ...] = _STILL


@dataclass(frozen=True, slots=True)
class Axes(Form):
    """Form of the field `replicate`: a list of axes, each of which copies what the ones after it make."""

    def schema(self) -> Schema:
        kind = GRAMMAR.element("replicate")
        axis = mapping({name: attribute_schema(kind.attributes[name]) for name in ATTRIBUTES})
        return {"type": "array", "minItems": 1, "items": {**axis, "required": [COUNT]}}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Axis, ...]:
        reader = Reader(settings, faults)
        axes: list[Axis] = []
        if not isinstance(value, list) or not value:
            got = "an empty list" if value == [] else kind_of(value)
            message = f"`replicate` expects a list of axes, got {got}"
            faults.append(
                Fault("wrong-type", message, help="write `replicate: [{count: 3, offset: [0.1, 0, 0]}]`")
            )
        else:
            axes = [each for at, item in enumerate(value) if (each := _axis(reader, item, (at,)))]
        if not faults and (total := math.prod(axis.count for axis in axes)) > in_force().copies:
            message = f"`replicate` makes {total} copies, and at most {in_force().copies} are allowed"
            faults.append(Fault("limit-exceeded", message, help=advice("copies", total)))
        return tuple(axes)


def _axis(reader: Reader, value: Any, at: Path) -> Axis | None:
    owner = "an axis of `replicate`"
    if not isinstance(value, dict):
        message = f"{owner} is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help="write `{count: 3, offset: [0.1, 0, 0]}`"))
        return None
    kind = GRAMMAR.element("replicate")
    read: dict[str, Value] = {}
    for name, item in value.items():
        path = (*at, name)
        if name not in ATTRIBUTES:
            help, fix = advised(name, ATTRIBUTES)
            unknown = unknown_attribute(name, owner, ATTRIBUTES)
            reader.faults.append(fault_at(unknown, path, key=True, help=help, fix=fix))
            continue
        found = read_value(kind.attributes[name], item, path, owner=owner, faults=reader.faults)
        if found is not None:
            read[name] = found
            if not reader.settings.bare_angles:
                bare = bare_angle(kind.attributes[name], found, None, at=path, owner=owner)
                reader.faults += [bare] if bare is not None else []
    if COUNT not in value:
        reader.faults.append(missing_key(owner, COUNT, at))
    count, offset, euler = read.get(COUNT, 1), read.get("offset", _STILL), read.get("euler", _STILL)
    if not isinstance(count, int | float) or not isinstance(offset, tuple) or not isinstance(euler, tuple):
        return None
    if count < 1:
        message = f"`{COUNT}` of {owner} is at least 1, got {count}"
        reader.faults.append(Fault("out-of-range", message, (*at, COUNT)))
    return Axis(int(count), offset, euler)

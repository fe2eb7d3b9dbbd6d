"""Values, functions and angles of expressions."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

from mjcompose.base.dataclass import dataclass

Value = bool | int | float | str | tuple["Value", ...]

MAX_INTEGER = 2**63


def kind(value: Value) -> str:
    """Return the noun in messages for a value's type.

    >>> kind(True), kind(2), kind(2.0), kind("x"), kind((1, 2))
    ('a boolean', 'a number', 'a number', 'text', 'a vector')
    """
    if isinstance(value, bool):
        return "a boolean"
    if isinstance(value, (int, float)):
        return "a number"
    return "text" if isinstance(value, str) else "a vector"


def shown(value: Value) -> str:
    """Return a value as text: the shortest one that reads back as the same number.

    >>> shown(0.1), shown(2.0), shown(2), shown(True), shown((1, 0.5)), shown("left")
    ('0.1', '2.0', '2', 'true', '[1, 0.5]', 'left')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(shown(each) for each in value) + "]"
    return value if isinstance(value, str) else repr(value)


Number = int | float


class ArgumentError(ValueError):
    """An argument that a function does not accept; the text says why."""


class Function(NamedTuple):
    """A function of expressions; `apply` takes `least` to `most` numbers (None: any number)."""

    apply: Callable[..., Number]
    least: int = 1
    most: int | None = 1


def _round(value: Number, digits: Number = 0) -> Number:
    if isinstance(digits, float) or not -20 <= digits <= 20:
        raise ArgumentError("the second argument is the number of digits, a whole number up to 20")
    return round(value, digits) if digits else round(value)


def _clamp(value: Number, low: Number, high: Number) -> Number:
    if low > high:
        raise ArgumentError(f"the lower bound {low} is above the upper bound {high}")
    return min(max(value, low), high)


CONSTANTS: Mapping[str, Value] = {"pi": math.pi}
FUNCTIONS: Mapping[str, Function] = {
    "abs": Function(abs), "min": Function(min, 2, None), "max": Function(max, 2, None),
    "round": Function(_round, 1, 2), "floor": Function(math.floor), "ceil": Function(math.ceil),
    "sqrt": Function(math.sqrt), "exp": Function(math.exp), "log": Function(math.log, 1, 2),
    "sin": Function(math.sin), "cos": Function(math.cos), "tan": Function(math.tan), "asin": Function(math.asin),
    "acos": Function(math.acos), "atan": Function(math.atan), "atan2": Function(math.atan2, 2, 2),
    "hypot": Function(math.hypot, 2, None), "clamp": Function(_clamp, 3, 3), "deg": Function(math.degrees),
    "rad": Function(math.radians),
}  # fmt: skip


UNITS: Mapping[str, Literal["deg", "rad"]] = {"deg": "deg", "rad": "rad"}
ANGLE_PATTERN = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?(?:deg|rad)"
_ANGLE = re.compile(ANGLE_PATTERN)


@dataclass(frozen=True, slots=True)
class Angle:
    """A number with its unit: `90deg`, `1.57rad`."""

    value: float
    unit: Literal["deg", "rad"]

    @property
    def radians(self) -> float:
        return self.in_unit("rad")

    @classmethod
    def read(cls, text: str) -> Angle | None:
        """Return the angle in a text, or None if it is not an angle.

        >>> Angle.read("-90deg"), Angle.read("90"), Angle.read("deg")
        (Angle(value=-90.0, unit='deg'), None, None)
        """
        if text[-3:] not in UNITS or _ANGLE.fullmatch(text) is None:
            return None
        value = float(text[:-3])
        return cls(value, UNITS[text[-3:]]) if math.isfinite(value) else None

    def in_unit(self, unit: str) -> float:
        """Return the number in another unit, `deg` or `rad`."""
        if unit == self.unit:
            return self.value
        return math.radians(self.value) if unit == "rad" else math.degrees(self.value)

    def __str__(self) -> str:
        return f"{self.value:.17g}{self.unit}"

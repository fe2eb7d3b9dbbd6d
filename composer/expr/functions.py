"""The functions and constants of expressions. Angles are in radians, as in mathematical libraries."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from composer.expr.value import Value

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
        raise ArgumentError("the second argument is how many digits are kept, a whole number up to 20")
    return round(value, digits) if digits else round(value)


def _clamp(value: Number, low: Number, high: Number) -> Number:
    if low > high:
        raise ArgumentError(f"the lower bound {low} is above the upper bound {high}")
    return min(max(value, low), high)


CONSTANTS: Mapping[str, Value] = {"pi": math.pi}
FUNCTIONS: Mapping[str, Function] = {
    "abs": Function(abs),
    "min": Function(min, 2, None),
    "max": Function(max, 2, None),
    "round": Function(_round, 1, 2),
    "floor": Function(math.floor),
    "ceil": Function(math.ceil),
    "sqrt": Function(math.sqrt),
    "exp": Function(math.exp),
    "log": Function(math.log, 1, 2),
    "sin": Function(math.sin),
    "cos": Function(math.cos),
    "tan": Function(math.tan),
    "asin": Function(math.asin),
    "acos": Function(math.acos),
    "atan": Function(math.atan),
    "atan2": Function(math.atan2, 2, 2),
    "hypot": Function(math.hypot, 2, None),
    "clamp": Function(_clamp, 3, 3),
    "deg": Function(math.degrees),
    "rad": Function(math.radians),
}

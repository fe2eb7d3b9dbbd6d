"""What `set`, `scale` and `offset` do to a number."""

from __future__ import annotations

from collections.abc import Callable
from operator import add, mul

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Operation:
    """One of the verbs.

    `combine` gives the new number, of the present one and the one that the recipe writes. With `is_factor` the written
    number has no unit; otherwise it is in the unit of the attribute.
    """

    verb: str
    combine: Callable[[float, float], float]
    is_factor: bool = False


def _written(now: float, written: float) -> float:
    return written


SET = Operation("set", _written)
SCALE = Operation("scale", mul, is_factor=True)
OFFSET = Operation("offset", add)

OPERATIONS = {each.verb: each for each in (SET, SCALE, OFFSET)}

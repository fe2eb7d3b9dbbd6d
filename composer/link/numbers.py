"""Numbers of MJCF attributes: read as MuJoCo reads them, written so that they read back to the same bits."""

from __future__ import annotations

import math
from collections.abc import Iterable

from composer.grammar.number import items, parse_real

RADIANS_PER_DEGREE = math.pi / 180


def read(text: str) -> list[float]:
    """Parse numbers. Raises ValueError for `1_0`, digits of other scripts and `1e400`, which MuJoCo refuses."""
    if not _RARE.isdisjoint(text) or not text.isascii():
        return [_rare(item) for item in items(text)]
    values = [float(token) for token in text.split()]
    if math.inf in values or -math.inf in values:
        return [_rare(item) for item in items(text)]
    return values


# MuJoCo 4.0 reads `timestep="0x1p-8"` as 0.00390625, and refuses `size="1,2"` and `group="1.0"`.
_RARE = frozenset("xX_(")
"""Hexadecimals and `nan(…)`; and what only Python takes for part of a number."""


def _rare(item: str) -> float:
    value = parse_real(item)
    if value is None:
        raise ValueError(f"not a number: {item}")
    return value


def text(values: Iterable[float]) -> str:
    """Return the shortest decimals that read back exactly, whole numbers without a point."""
    return " ".join(_one(value) for value in values)


def _one(value: float) -> str:
    if value == 0 or not math.isfinite(value):
        return "-0" if value == 0 and math.copysign(1, value) < 0 else f"{value:g}"
    whole = repr(value)
    return whole[:-2] if whole.endswith(".0") else whole


# MuJoCo 4.0 rounds the two in different ways: `<joint ref="0.30000000000000004"/>` compiles to v * (pi / 180), which is
# not v / 180 * pi to the last bit; `euler` is the other way round.
def orientation_radians(degrees: float) -> float:
    """Convert degrees to radians as MuJoCo does for orientations."""
    return degrees / 180.0 * math.pi


def joint_radians(degrees: float) -> float:
    """Convert degrees to radians as MuJoCo does for the range and reference of a joint."""
    return degrees * RADIANS_PER_DEGREE

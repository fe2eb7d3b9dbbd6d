"""Angles in recipes: numbers with a unit."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Literal

from composer.dataclass import dataclass

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
        """Return the angle in a text, or None if it is not one.

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

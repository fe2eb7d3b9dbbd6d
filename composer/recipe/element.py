"""An element of MJCF as a recipe has it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from composer.recipe.fault import Path

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
        return self.value if self.unit == "rad" else math.radians(self.value)

    @classmethod
    def read(cls, text: str) -> Angle | None:
        """The angle that a text is, or None.

        >>> Angle.read("-90deg"), Angle.read("90"), Angle.read("deg")
        (Angle(value=-90.0, unit='deg'), None, None)
        """
        if text[-3:] not in UNITS or _ANGLE.fullmatch(text) is None:
            return None
        value = float(text[:-3])
        return cls(value, UNITS[text[-3:]]) if math.isfinite(value) else None

    def __str__(self) -> str:
        return f"{self.value:.17g}{self.unit}"


Single = bool | int | float | str | Angle
Value = Single | tuple[Single, ...]


@dataclass(frozen=True, slots=True)
class Element:
    """An element with its attributes in the order of the file, and its children.

    `at` is its path from the top of the recipe: `locate(node, at)` is its place, `locate(node, (*at, name))`
    that of an attribute. An element that the recipe names by its key has that name as its attribute `name`;
    its place is `locate(node, at, key=True)`.

    Where `xml` is given, the element is that fragment of MJCF, checked against the grammar and kept as text:
    `tag` is the fragment's, there are no `children`, and `attributes` has at most the name that a key gives.
    Paths of files are relative to the recipe.
    """

    tag: str
    attributes: Mapping[str, Value] = field(default_factory=dict)
    children: tuple[Element, ...] = ()
    xml: str | None = None
    at: Path = ()

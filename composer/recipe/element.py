"""An element of MJCF as a recipe has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from composer.expr.angle import Angle
from composer.recipe.fault import Path

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

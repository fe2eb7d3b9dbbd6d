"""Elements of MJCF in a recipe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from composer.dataclass import dataclass
from composer.expr.angle import Angle
from composer.recipe.fault import Path

Single = bool | int | float | str | Angle
Value = Single | tuple[Single, ...]


@dataclass(frozen=True, slots=True)
class Element:
    """An element with its children, and its attributes in the order of the file.

    `at` is its path from the top of the recipe: `locate(node, at)` is its place, and `locate(node, (*at, name))`
    that of an attribute. An element that the recipe names by its key has that name as its attribute `name`, whose
    place is `locate(node, at, key=True)`.

    With `xml`, the element is that fragment of MJCF, checked against the grammar and kept as text. Then `tag` is
    that of the fragment, there are no `children`, and `attributes` has at most the name that a key gives. Paths of
    files are relative to the recipe.
    """

    tag: str
    attributes: Mapping[str, Value] = field(default_factory=dict)
    children: tuple[Element, ...] = ()
    xml: str | None = None
    at: Path = ()

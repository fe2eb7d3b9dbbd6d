"""Keys of the language that this version does not carry out yet."""

from __future__ import annotations

from composer.recipe.fault import Path

# The keys by the kind of mapping that they stand in. One that works is taken out here.
UNSUPPORTED: dict[str, frozenset[str]] = {
    "recipe": frozenset("params extends edit variants matrix randomize check".split()),
    "base": frozenset("with drop edit".split()),
    "attach": frozenset("with drop edit when".split()),
    "add": frozenset({"id", "when"}),
    "element": frozenset({"when"}),
}
EXPRESSIONS = False
"""Whether `${…}` may stand for a value."""


def is_unsupported(path: Path) -> bool:
    """Whether the key at the end of the path is one of the language that does not work yet.

    >>> is_unsupported(("attach", "arm", "edit")), is_unsupported(("attach", "edit"))
    (True, False)
    """
    return path[-1] in UNSUPPORTED.get(_kind(path), ())


def _kind(path: Path) -> str:
    """The kind of mapping in which the last key of the path stands."""
    section, depth = path[0], len(path)
    if depth == 1:
        return "recipe"
    if (section, depth) in (("base", 2), ("attach", 3), ("add", 3)):
        return str(section)
    return "element" if depth == _ITEM_DEPTH.get(section) else ""


# How long the path to a key of an item is.
_ITEM_DEPTH: dict[str | int, int] = {
    **dict.fromkeys(("sensor", "actuator", "equality", "tendon", "default", "keyframe"), 3),
    **dict.fromkeys(("asset", "contact", "custom", "deformable", "extension"), 4),
}

"""Keys of the language that this version does not carry out yet."""

from __future__ import annotations

from composer.recipe.fault import Path

# The keys by the kind of mapping that they stand in. One that works is taken out here.
UNSUPPORTED: dict[str, frozenset[str]] = {
    "recipe": frozenset({"randomize"}),
    "base": frozenset(),
    "attach": frozenset(),
}


def is_unsupported(path: Path) -> bool:
    """Whether the key at the end of the path is one of the language that does not work yet.

    >>> is_unsupported(("randomize",)), is_unsupported(("attach", "randomize"))
    (True, False)
    """
    return path[-1] in UNSUPPORTED.get(_kind(path), ())


def _kind(path: Path) -> str:
    """The kind of mapping in which the last key of the path stands."""
    section, depth = path[0], len(path)
    if depth == 1:
        return "recipe"
    return str(section) if (section, depth) in (("base", 2), ("attach", 3)) else ""

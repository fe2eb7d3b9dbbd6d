"""The paths in a recipe, or in a piece of one, that several stages treat specially."""

from __future__ import annotations

from functools import lru_cache

Path = tuple[str | int, ...]

_EDITS: tuple[Path, ...] = (("edit",), ("base", "edit"), ("attach", "*", "edit"))
# The verbs whose values may refer to the current value.
_OF_ELEMENTS = ("set", "scale", "offset", "convert", "move", "rename")
# Paths with selectors, besides edits.
_SELECTING: tuple[Path, ...] = (
    ("base", "drop"),
    ("attach", "*", "drop"),
    ("check", "*", "*"),
    ("randomize", "fields", "*", "select"),
)


def in_own_model(path: Path) -> Path:
    """Return the path within its own model, if that is written in place.

    >>> in_own_model(("attach", "table", "model", "add", 0)), in_own_model(("base", "model", "edit"))
    (('add', 0), ('edit',))
    >>> in_own_model(("attach", "table", "model"))
    ('attach', 'table', 'model')
    """
    while True:
        depth = 2 if path[:2] == ("base", "model") else 3 if path[:1] == ("attach",) else 0
        if not depth or len(path) <= depth or path[depth - 1] != "model":
            return path
        path = path[depth:]


def is_edits(path: Path) -> bool:
    """Return whether there is a list of edits at this path: the recipe's own, the base's or a part's.

    >>> is_edits(("base", "edit")), is_edits(("attach", "arm", "edit")), is_edits(("sensor", "edit"))
    (True, True, False)
    """
    path = in_own_model(path)
    return any(len(path) == len(edits) and _is_below(path, edits) for edits in _EDITS)


def is_appended(path: Path) -> bool:
    """Return whether merging appends to the list at this path, matching items by `id`."""
    return in_own_model(path) == ("add",) or is_edits(path)


@lru_cache(4096)  # each cell and each sample needs the same paths
def is_of_elements(path: Path) -> bool:
    """Return whether `${…}` at this path is evaluated for each element: in edits, and in `where` of selectors.

    >>> is_of_elements(("edit", 0, "set", "mass")), is_of_elements(("base", "drop", 1, "where"))
    (True, True)
    >>> is_of_elements(("edit", 0, "select", "geom")), is_of_elements(("edit", 0, "expect"))
    (False, False)
    >>> is_of_elements(("attach", "where", "pos")), is_of_elements(("sensor", "edit", "noise"))
    (False, False)
    """
    path = in_own_model(path)
    for edits in _EDITS:
        if len(path) > len(edits) + 1 and _is_below(path, edits):
            verb, *inner = path[len(edits) + 1 :]
            return (verb in _OF_ELEMENTS and (verb, *inner) != ("convert", "to")) or (
                verb == "select" and "where" in inner
            )
    return any(_is_below(path, place) and "where" in path[len(place) :] for place in _SELECTING)


def _is_below(path: Path, place: Path) -> bool:
    return len(path) >= len(place) and all(b in (a, "*") for a, b in zip(path, place, strict=False))

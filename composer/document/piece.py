"""Where in a recipe, or a piece of one, the things stand that more than one stage treats in a way of their own."""

from __future__ import annotations

from functools import lru_cache

Path = tuple[str | int, ...]

_EDITS: tuple[Path, ...] = (("edit",), ("base", "edit"), ("attach", "*", "edit"))
# The verbs whose values may contain the present value.
_OF_ELEMENTS = ("set", "scale", "offset", "convert", "move", "rename")
# What may have selectors in it, beside edits.
_SELECTING: tuple[Path, ...] = (
    ("base", "drop"),
    ("attach", "*", "drop"),
    ("check", "*", "*"),
    ("randomize", "fields", "*", "select"),
)


def in_own_model(path: Path) -> Path:
    """The path in the model that it stands in, where that is written in place.

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
    """Whether it is a list of edits that stands there: the recipe's own, the base's or a part's.

    >>> is_edits(("base", "edit")), is_edits(("attach", "arm", "edit")), is_edits(("sensor", "edit"))
    (True, True, False)
    """
    path = in_own_model(path)
    return any(len(path) == len(edits) and _is_below(path, edits) for edits in _EDITS)


def is_appended(path: Path) -> bool:
    """Whether the list that stands there is continued by that of an upper tree, which merging does by `id`."""
    return in_own_model(path) == ("add",) or is_edits(path)


@lru_cache(4096)  # each cell and each sample asks for the same places
def is_of_elements(path: Path) -> bool:
    """Whether `${…}` there is evaluated for each element: in the values of edits, and in what selectors compare.

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

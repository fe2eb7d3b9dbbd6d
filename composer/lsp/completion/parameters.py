"""Completion of parameters and variants where they get values: in `with`, `when`, `matrix` and `randomize`."""

from __future__ import annotations

from collections.abc import Iterator

from composer.lsp.answers import Item
from composer.lsp.cursor import Path
from composer.lsp.parameters import Settable, of_nested, settables
from composer.lsp.question import Question


def offer(question: Question) -> Iterator[Item]:
    """Yield the names that can get a value at the cursor, or the possible values of the name there."""
    cursor = question.cursor
    if cursor.role in ("key", "either") and (found := _at(cursor.path, question)) is not None:
        for each in found.values():
            colon = "" if cursor.has_colon else ": "
            yield Item(
                each.name, each.kind, each.detail, each.doc, 15, each.name + colon, again=bool(each.values)
            )
    if cursor.role in ("value", "either") and cursor.path:
        path = cursor.path[:-1] if isinstance(cursor.path[-1], int) else cursor.path
        found = _at(path[:-1], question) or {}
        settable = found.get(str(path[-1])) if path else None
        for at, value in enumerate(settable.values if settable is not None else ()):
            yield Item(value, "word", settable.detail if settable else "", rank=10 + at)
        if cursor.path[0] == "randomize" and cursor.path[-1] == "param":
            own = settables(question.data).values()
            yield from (
                Item(each.name, each.kind, each.detail, each.doc) for each in own if each.kind == "parameter"
            )


def _at(path: Path, question: Question) -> dict[str, Settable] | None:
    """Return the parameters and variants that the mapping at a path can set, or None for any other mapping."""
    if path and path[-1] == "with":
        return of_nested(path[:-1], question)
    is_matrix = path[:1] == ("matrix",) and (path[1:] == ("axes",) or len(path) == 3)
    if is_matrix or (path and path[-1] == "when"):
        return settables(question.data)
    return None

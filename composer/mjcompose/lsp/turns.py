"""The values of names in the turns of a `for`, and those that expressions read from tables."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping as Map
from itertools import islice
from typing import NamedTuple

from mjcompose.language.expand import scope_of
from mjcompose.language.repeat import turns_at
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.subject import TurnName
from mjcompose.text.evaluate import Template, evaluate
from mjcompose.text.expression import DataTable, Expression, ExpressionError, Subscript, Value, Variable, parse
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, find

MOST_TURNS = 200
"""The number of turns that an answer of the editor computes."""


def scopes(document: Mapping, path: Path, given: Map[str, Node]) -> list[dict[str, Value]]:
    """Return the values of all names at a path in each turn of the `for` around it, at most `MOST_TURNS`."""
    scope = scope_of(document, given)
    return [{**scope, **turn} for turn in islice(turns_at(document, path, scope), MOST_TURNS)]


def values_of(name: TurnName, document: Mapping) -> list[Value]:
    """Return the different values of a name of a `for`, in their order."""
    found: list[Value] = []
    for scope in scopes(document, name.path, {}):
        value = scope.get(name.key.name)
        if value is not None and value not in found:
            found.append(value)
    return found


def readings_in(text: str, scope: Map[str, Value]) -> Iterator[tuple[str, Map[str, Value]]]:
    """Yield the values that a text reads from tables by an unknown name, such as `gains[name].kp`, by row.

    >>> gains = DataTable({"hip": DataTable({"kp": 20}), "knee": DataTable({"kp": 40})})
    >>> list(readings_in("${gains[name].kp}", {"gains": gains}))
    [('gains[name].kp', {'hip': 20, 'knee': 40})]
    """
    try:
        pieces = Template.parse(text).pieces
    except ExpressionError:
        return
    for piece in pieces:
        if not isinstance(piece, str):
            for tree in _items(piece.tree):
                first, last = tree.at
                values = {label: value for label, value in _read(tree, scope) if label}
                if values:
                    yield text[piece.start + first : piece.start + last], values


def _items(tree: Expression) -> Iterator[Subscript]:
    """Yield the longest readings of an expression."""
    if isinstance(tree, Subscript):
        yield tree
        return
    for value in (getattr(tree, name) for name in tree.__dataclass_fields__):
        children = value if isinstance(value, tuple) else (value,)
        for child in children:
            if isinstance(child, Expression):
                yield from _items(child)


def _read(tree: Expression, scope: Map[str, Value]) -> Iterator[tuple[str, Value]]:
    """Yield the values that an expression reads, each with the rows that were chosen because their name is unknown."""
    if isinstance(tree, Subscript):
        for label, whole in _read(tree.of, scope):
            yield from ((f"{label} {row}".strip(), value) for row, value in _chosen(whole, tree.index, scope))
    elif isinstance(tree, Variable) and tree.key in scope:
        yield "", scope[tree.key]


def _chosen(whole: Value, index: Expression, scope: Map[str, Value]) -> Iterator[tuple[str, Value]]:
    try:
        step = evaluate(index, scope)
    except ExpressionError:
        rows = whole.items() if isinstance(whole, DataTable) else ()
        yield from rows
        return
    if isinstance(whole, DataTable):
        is_there = isinstance(step, str) and step in whole
    else:
        is_there = isinstance(whole, tuple) and isinstance(step, int) and -len(whole) <= step < len(whole)
    if is_there:
        value: Value = whole[step]  # type: ignore[index]  # checked above
        yield "", value


_READING = re.compile(r"(?P<of>[^\W\d]\w*(?:\.[^\W\d]\w*|\[[^\[\]]*\])*)(?P<opening>\.|\[\s*['\"]?)(?P<begun>[\w]*)\Z")


class Reading(NamedTuple):
    """A reading that is being written, such as `gains[j].k`: the keys that fit, and the text of the key so far."""

    keys: list[str]
    begun: str
    is_dotted: bool
    is_quoted: bool


def reading_at(before: str, document: Mapping, path: Path) -> Reading | None:
    """Return the row or column that is being written at the end of a text, or None."""
    found = _READING.search(before)
    if found is None:
        return None
    try:
        tree = parse(found["of"])
    except ExpressionError:
        return None
    keys: dict[str, None] = {}
    for scope in scopes(document, path, {}):
        for _, value in _read(tree, scope):
            keys.update(dict.fromkeys(value) if isinstance(value, DataTable) else {})
    if not keys and isinstance(tree, Subscript) and isinstance(tree.of, Variable):
        keys.update(dict.fromkeys(_declared_columns(document, tree.of.name)))
    opening = found["opening"]
    return Reading(list(keys), found["begun"], opening == ".", opening[-1:] in ("'", '"'))


def _declared_columns(document: Mapping, name: str) -> list[str]:
    """Return the columns that a parameter lists, for a table without a default."""
    listed = find(document, ("params", name, "columns"))
    return [item.text for item in listed.items if isinstance(item, Scalar)] if isinstance(listed, Sequence) else []

"""Completion inside `${…}`: parameters, variants, functions, and the values that an edit defines."""

from __future__ import annotations

import re
from collections.abc import Iterator

from composer.expr.functions import CONSTANTS, FUNCTIONS
from composer.lsp.answers import Item
from composer.lsp.cursor import Path
from composer.lsp.parameters import settables
from composer.lsp.question import Question

_NAME = re.compile(r"[A-Za-z_]\w*\Z")
_IN_EDITS = {
    "value": "what is there now, after defaults",
    "name": "the name of the element",
    "parent": "the name of its parent",
    "index": "its number among those that are selected, from 0",
}


def begun(question: Question) -> str | None:
    """Return the name that is being written inside `${…}`, or None if the cursor is not in an expression."""
    before = question.cursor.word
    opening = before.rfind("${")
    if opening < 0 or "}" in before[opening:]:
        return None
    found = _NAME.search(before)
    return found.group() if found else ""


def offer(question: Question) -> Iterator[Item]:
    """Yield the names and functions that the expression may use."""
    if begun(question) is None:
        return
    for each in settables(question.data).values():
        yield Item(each.name, each.kind, each.detail, each.doc, 10)
    if _is_edit(question.path):
        yield from (Item(name, "parameter", "of the element", doc, 15) for name, doc in _IN_EDITS.items())
    for name, function in FUNCTIONS.items():
        count = f"{function.least}" if function.most == function.least else f"{function.least} or more"
        yield Item(name, "function", f"{count} argument{'s' * (count != '1')}", rank=30, insert=f"{name}(")
    for name, value in CONSTANTS.items():
        yield Item(name, "constant", str(value), rank=30)


def _is_edit(path: Path) -> bool:
    return "edit" in path

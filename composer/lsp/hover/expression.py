"""Hover for `${…}`: its value, or its value in each cell of the matrix if they differ."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from composer.diagnostics.sink import Sink
from composer.document.node import Mapping as Located
from composer.document.node import Node
from composer.expand.expand import scope_of
from composer.expand.matrix import Cell, cells
from composer.expr.error import ExpressionError
from composer.expr.opening import is_template
from composer.expr.template import Template
from composer.expr.value import Value, shown
from composer.lsp.answers import Hover
from composer.lsp.parameters import names_in, settables
from composer.lsp.question import Question

_MOST = 12


def show(question: Question) -> Hover | None:
    """Return the value of the text with `${…}` at the cursor, or None."""
    text = question.cursor.whole
    if not is_template(text) or not isinstance(question.tree, Located):
        return None
    values = values_of(text, question.tree)
    if not values:
        return None
    lines = [f"`{text}`", ""]
    if len(set(values.values())) == 1:
        lines.append(f"= **{next(iter(values.values()))}**")
    else:
        lines += ["| cell | value |", "|---|---|"]
        lines += [f"| {cell} | **{value}** |" for cell, value in list(values.items())[:_MOST]]
        if len(values) > _MOST:
            lines.append(f"| … and {len(values) - _MOST} more | |")
    named = settables(question.data)
    about = [f"- `{name}`: {named[name].detail}{'; ' if named[name].doc else ''}{named[name].doc}"
             for name in dict.fromkeys(each for each, _, _ in names_in(text)) if name in named]  # fmt: skip
    return Hover("\n".join([*lines, "", *about]), question.word)


def values_of(text: str, document: Located) -> dict[str, str]:
    """Return the value of a text in each cell, by the name of the cell; without a matrix, under an empty name.

    The result is empty if a name in the text has no value yet, such as `${value}` in an edit.
    """
    try:
        template = Template.parse(text)
    except ExpressionError:
        return {}
    found: dict[str, str] = {}
    for name, scope in scopes(document):
        try:
            found[name] = shown(template.value(scope))
        except ExpressionError:
            return {}
    return found


def scopes(document: Located) -> Iterator[tuple[str, Mapping[str, Value]]]:
    """Yield the values of parameters and variants in each cell; without a matrix, their defaults."""
    every = cells(document, "", Sink())
    if not every:
        yield "", scope_of(document, {})
    for cell in every:
        yield _label(cell), scope_of(document, cell.given)


def _label(cell: Cell) -> str:
    given: Mapping[str, Node] = cell.given
    return ", ".join(f"{name} {getattr(node, 'text', '…')}" for name, node in given.items())

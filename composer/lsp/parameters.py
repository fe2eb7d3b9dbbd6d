"""The parameters and variants of a recipe, as its text has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from composer.context import Context
from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar, Sequence, to_python
from composer.expr.error import ExpressionError
from composer.expr.template import Template
from composer.lsp.cursor import Path
from composer.lsp.places import part_at
from composer.lsp.question import Question
from composer.lsp.uses import scalars
from composer.plan.plan import Plan
from composer.plan.read import read_recipe
from composer.sources.fetching import Fetching


@dataclass(frozen=True, slots=True)
class Settable:
    """A parameter, or an axis of variants: its default as it is written, its values where it has a choice."""

    name: str
    kind: str
    default: str = ""
    values: tuple[str, ...] = ()
    unit: str = ""
    doc: str = ""

    @property
    def detail(self) -> str:
        """What it is, on one line.

        >>> Settable("reach", "parameter", "0.45", unit="m").detail
        'parameter, default 0.45 m'
        """
        default = f", default {self.default}" if self.default else ""
        choice = f", one of {', '.join(self.values)}" if self.values and self.kind == "parameter" else ""
        return f"{self.kind}{default}{' ' + self.unit if self.unit else ''}{choice}"


def settables(data: Any) -> dict[str, Settable]:
    """The parameters and axes that a recipe declares, by name; what is half written is left out."""
    found: dict[str, Settable] = {}
    if not isinstance(data, dict):
        return found
    for name, written in _entries(data, "params"):
        said = written if isinstance(written, dict) else {"default": written}
        choices = said.get("choices")
        values = tuple(map(text, choices)) if isinstance(choices, list) else ()
        default = said.get("default")
        if isinstance(default, bool):
            values = ("true", "false")
        found[name] = Settable(
            name, "parameter", text(default), values, text(said.get("unit")), text(said.get("doc"))
        )
    for name, written in _entries(data, "variants"):
        values = tuple(written) if isinstance(written, dict) else ()
        found[name] = Settable(name, "variant", values[0] if values else "", values)
    return found


def of_nested(at: Path, question: Question) -> dict[str, Settable]:
    """Those of the recipe that the part at a path is made of."""
    tree = nested_document(at, question)
    return {} if tree is None else settables(to_python(tree))


def nested_document(at: Path, question: Question) -> Mapping | None:
    """The tree of the recipe that the part at a path is made of."""
    analysis = question.analysis
    if analysis.plan is None:
        return None
    step = analysis.plan.base if at == ("base",) else part_at(at, analysis.plan)
    model = None if step is None else step.model
    if not isinstance(model, Plan):
        return None
    node = read_recipe(model.path, Context(folder=analysis.folder, fetching=Fetching(offline=True)))
    return node if isinstance(node, Mapping) else None


def _entries(data: dict[str, Any], section: str) -> list[tuple[str, Any]]:
    found = data.get(section)
    return list(found.items()) if isinstance(found, dict) else []


def text(value: Any) -> str:
    """A value as a recipe writes it.

    >>> text(None), text(True), text([1, 2.5])
    ('', 'true', '[1, 2.5]')
    """
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(map(text, value))}]"
    return str(value)


def parameter_at(question: Question) -> tuple[str, Path | None] | None:
    """The parameter or variant at the cursor, and the part whose it is where it is set for one."""
    cursor = question.cursor
    if cursor.role in ("key", "either") and cursor.whole:
        if cursor.path in (("params",), ("variants",), ("matrix", "axes")) or cursor.path[-1:] == ("when",):
            return cursor.whole, None
        if cursor.path[-1:] == ("with",):
            return cursor.whole, cursor.path[:-1]
    if "${" not in cursor.whole:
        return None
    at = question.column - cursor.start
    for name, start, end in names_in(cursor.whole):
        if start <= at <= end:
            return name, None
    return None


def names_in(template: str) -> list[tuple[str, int, int]]:
    """The names in a text with `${…}`, and their characters in it; none where it cannot be read."""
    try:
        return [(each.name, each.start, each.end) for each in Template.parse(template).names()]
    except ExpressionError:
        return []


def parameter_uses(name: str, tree: Node | None) -> list[Span]:
    """Where a recipe uses a parameter or variant of its own: in expressions, `when` and the matrix."""
    found = [span for _, node in scalars(tree) for each, span in _names_of(node) if each == name]
    return [*_keys(tree, (), name), *found]


def _names_of(node: Scalar) -> Iterator[tuple[str, Span]]:
    """The names in the expressions of a value, each with its place."""
    if node.block is None:
        begin = node.span.column + (0 if node.plain else 1)
        for name, start, end in names_in(_written(node)):
            yield name, replace(node.span, column=begin + start, end_column=begin + end)
        return
    line, column = node.block
    for name, start, end in names_in(node.text):
        above, last = node.text[:start].count("\n"), start - (node.text.rfind("\n", 0, start) + 1)
        row = line + above
        yield name, Span(node.span.file, row, column + last, row, column + last + end - start)


def _keys(node: Node | None, path: Path, name: str) -> list[Span]:
    if isinstance(node, Sequence):
        return [span for at, item in enumerate(node.items) for span in _keys(item, (*path, at), name)]
    if not isinstance(node, Mapping):
        return []
    sets = path in (("params",), ("variants",), ("matrix", "axes")) or path[-1:] == ("when",)
    sets = sets or (path[:1] == ("matrix",) and len(path) == 3)
    own = [node.entries[name][0].span] if sets and name in node.entries else []
    return own + [
        span for key, (_, value) in node.entries.items() for span in _keys(value, (*path, key), name)
    ]


def _written(node: Scalar) -> str:
    """A value as its characters stand in the file, as far as that can be told: without escapes it is its text."""
    span = node.span
    width = (span.end_column or span.column) - span.column
    return node.text if width in (len(node.text), len(node.text) + 2) else ""

"""The parameters and variants of a recipe, as its text declares them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from composer.context import Context
from composer.dataclass import dataclass
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
    """A parameter or an axis of variants.

    It has its default as it is written, and the allowed values if they are listed.
    """

    name: str
    kind: str
    default: str = ""
    values: tuple[str, ...] = ()
    unit: str = ""
    doc: str = ""

    @property
    def detail(self) -> str:
        """Return a description in one line.

        >>> Settable("reach", "parameter", "0.45", unit="m").detail
        'parameter, default 0.45 m'
        """
        default = f", default {self.default}" if self.default else ""
        choice = f", one of {', '.join(self.values)}" if self.values and self.kind == "parameter" else ""
        return f"{self.kind}{default}{' ' + self.unit if self.unit else ''}{choice}"


def settables(data: Any) -> dict[str, Settable]:
    """Return the declared parameters and axes by name. Half-written declarations are left out."""
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
    """Return the parameters and axes of the nested recipe of the part at a path."""
    tree = nested_document(at, question)
    return {} if tree is None else settables(to_python(tree))


def nested_document(at: Path, question: Question) -> Mapping | None:
    """Return the tree of the nested recipe of the part at a path, or None."""
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
    """Return a value as YAML.

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
    """Return the parameter or variant at the cursor, and the part to which it belongs where it is set for one."""
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
    """Return the names in a text with `${…}`, with the columns that they cover. A text with errors has none."""
    try:
        return [(each.name, each.start, each.end) for each in Template.parse(template).names()]
    except ExpressionError:
        return []


def parameter_uses(name: str, tree: Node | None) -> list[Span]:
    """Return the places where a recipe uses one of its own parameters or variants."""
    found = [span for _, node in scalars(tree) for each, span in _names_of(node) if each == name]
    return [*_keys(tree, (), name), *found]


def _names_of(node: Scalar) -> Iterator[tuple[str, Span]]:
    """Yield the names in the expressions of a value, each with its place."""
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
    """Return the characters of a value in the file. They are known only for a value without escapes."""
    span = node.span
    width = (span.end_column or span.column) - span.column
    return node.text if width in (len(node.text), len(node.text) + 2) else ""

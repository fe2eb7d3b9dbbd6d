"""Names in a recipe, the elements that they mean, and declared parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.build.plan.plan import Plan
from mjcompose.build.plan.read import read_recipe
from mjcompose.lsp.analysis import Analysis, Known, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.language import Form, forms_at, forms_below
from mjcompose.lsp.places import PART, Wanted, fitting, part_at, wanted_key, wanted_value
from mjcompose.model.unit import Unit
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, to_python


@dataclass(frozen=True, slots=True)
class Use:
    """A name in a recipe, as a value or a key, and the names that are allowed there."""

    text: str
    span: Span
    path: Path
    wanted: Wanted
    is_key: bool = False


def uses_in(tree: Node | None) -> Iterator[Use]:
    """Yield the names in a recipe, in the order of the text."""
    if isinstance(tree, Mapping):
        data = to_python(tree)
        yield from _walk(tree, data, (), forms_at((), data), [], None)


def _walk(node: Node, data: Any, path: Path, forms: list[Form], above: list[Form], around: Any) -> Iterator[Use]:
    if isinstance(node, Scalar):
        wanted = wanted_value(path, above, around) if path and isinstance(node.value, str) else None
        if wanted is not None:
            yield Use(node.text, node.span, path, wanted)
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            inner = data[index]
            below = forms_below(forms, index, inner)
            yield from _walk(item, inner, (*path, index), below, [*forms, *above], around)
    else:
        wanted = wanted_key(path)
        for name, (key, value) in node.entries.items():
            if wanted is not None:
                yield Use(name, key.span, (*path, name), wanted, True)
            inner = data[name]
            yield from _walk(value, inner, (*path, name), forms_below(forms, name, inner), forms, data)


def scalars(node: Node | None, path: Path = ()) -> Iterator[tuple[Path, Scalar]]:
    """Yield every value of a tree with its path."""
    if isinstance(node, Scalar):
        yield path, node
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from scalars(item, (*path, index))
    elif node is not None:
        for name, (_, value) in node.entries.items():
            yield from scalars(value, (*path, name))


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
        found[name] = Settable(name, "parameter", text(default), values, text(said.get("unit")), text(said.get("doc")))
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
    step = part_at(at, analysis.plan)
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
        return [(each.name, *each.at) for each in Template.parse(template).names()]
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
    return own + [span for key, (_, value) in node.entries.items() for span in _keys(value, (*path, key), name)]


def _written(node: Scalar) -> str:
    """Return the characters of a value in the file. They are known only for a value without escapes."""
    span = node.span
    width = (span.end_column or span.column) - span.column
    return node.text if width in (len(node.text), len(node.text) + 2) else ""


def wanted_as_value(question: Question) -> Wanted | None:
    """Return which names the value at the cursor can be."""
    path = question.path
    if question.cursor.role not in ("value", "either") or not path:
        return None
    around = path[:-2] if isinstance(path[-1], int) else path[:-1]
    forms = [*forms_at(path[:-1], question.data), *(forms_at(around, question.data) if around != path[:-1] else ())]
    return wanted_value(path, forms, question.at(around))


def wanted_at(question: Question) -> Wanted | None:
    """Return which names can be at the cursor, or None if no names can."""
    found = wanted_as_value(question)
    if found is None and question.cursor.role in ("key", "either"):
        return wanted_key(question.path)
    return found


def named_at(question: Question) -> list[Known]:
    """Return the elements that the name at the cursor means, of the most likely kind. A pattern means none."""
    wanted, name, analysis = wanted_at(question), question.cursor.whole.strip(), question.analysis
    if wanted is None or not name:
        return []
    found = [(rank, each) for rank, each in fitting(wanted, analysis.names, analysis.plan) if each.name == name]
    best = min((rank for rank, _ in found), default=0)
    return [each for rank, each in found if rank == best and each.namespace != PART]


def part_named_at(question: Question) -> Path | None:
    """Return the path of the part that the cursor names: at its key, or where another entry refers to it."""
    cursor, plan = question.cursor, question.analysis.plan
    if cursor.role in ("key", "either") and cursor.path == ("attach",) and cursor.whole:
        return ("attach", cursor.whole)
    wanted = wanted_at(question)
    if wanted is None or PART not in wanted.namespaces or plan is None:
        return None
    at: Path = ("base",) if cursor.whole == "base" else ("attach", cursor.whole)
    return None if part_at(at, plan) is None else at


def declared_at(known: Known, analysis: Analysis) -> Iterator[Span]:
    """Yield where an element is written: in a model, in this recipe or in another one."""
    node, traced = known.node, analysis.traced
    if node is None:
        return
    if traced is not None and node in traced.watch.lives:
        life = traced.watch.life(node)
        named = traced.written_at(node, "class" if node.tag == "default" else "name") if known.name else None
        places = [named] if named is not None else [each.span for each in traced.written(life)]
        for span in dict.fromkeys(places):
            if span is not None and (now := analysis.now(span, analysis.model_of)) is not None:
                yield now
        return
    unit = unit_of(known, analysis)
    if unit is not None:
        yield unit.origins.span(node, unit.file, "name")


def unit_of(known: Known, analysis: Analysis) -> Unit | None:
    """Return the source of an element that is not in the composed model, or None."""
    if known.node is None:
        return None
    root = known.node.getroottree().getroot()
    return next((unit for unit in analysis.names.sources.values() if unit.root is root), None)


def in_model(known: Known, analysis: Analysis) -> Known:
    """Return the element in the composed model, given one with a name inside a part."""
    traced = analysis.traced
    if known.node is None or traced is None or known.node in traced.watch.lives:
        return known
    unit = unit_of(known, analysis)
    part = next((part for part, each in analysis.names.sources.items() if each is unit), None)
    prefix = analysis.names.prefixes.get(part or "", "")
    found = analysis.names.find(known.namespace, prefix + known.name)
    return known if found is None else replace(found)

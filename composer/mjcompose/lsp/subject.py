"""Names in a recipe, the elements that they mean, and declared parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.language.condition import is_item
from mjcompose.language.repeat import FOR
from mjcompose.lsp.analysis import Analysis, Known, Question
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.language import ValueForm, forms_at, forms_below
from mjcompose.lsp.markup import ModelQuestion
from mjcompose.lsp.places import PART, Wanted, fitting, part_at, wanted_key, wanted_value
from mjcompose.plan.plan import Plan
from mjcompose.plan.read import read_recipe
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, find, is_template, to_python, walk
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


class Use(Struct):
    """A name in a recipe, as a value or a key, and the names that are allowed there."""

    text: str
    span: Span
    path: Path
    wanted: Wanted


class Formed(NamedTuple):
    """A value of a recipe. `forms` are the ways to write it; `above` and `around` are forms and data outside it."""

    path: Path
    key: Key | None
    node: Node
    data: Any
    forms: list[ValueForm]
    above: list[ValueForm]
    around: Any


def formed(tree: Node | None) -> Iterator[Formed]:
    """Yield the values of a recipe with the forms that the language allows there, in the order of the text."""
    if isinstance(tree, Mapping):
        data = to_python(tree)
        yield from _below(Formed((), None, tree, data=data, forms=forms_at((), data), above=[], around=None))


def _below(at: Formed) -> Iterator[Formed]:
    yield at
    node = at.node
    data = at.data
    if isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            forms = forms_below(at.forms, index, data[index])
            above = [*at.forms, *at.above]
            inner = Formed((*at.path, index), None, item, data=data[index], forms=forms, above=above, around=at.around)
            yield from _below(inner)
    elif isinstance(node, Mapping):
        for name, (key, value) in node.entries.items():
            forms = forms_below(at.forms, name, data[name])
            inner = Formed((*at.path, name), key, value, data=data[name], forms=forms, above=at.forms, around=data)
            yield from _below(inner)


def uses_in(tree: Node | None) -> Iterator[Use]:
    for at in formed(tree):
        if at.key is not None and (wanted := wanted_key(at.path[:-1])) is not None:
            yield Use(at.key.name, at.key.span, at.path, wanted)
        wanted = wanted_value(at.path, at.above, at.around) if isinstance(at.node, Scalar) else None
        if wanted is not None and isinstance(at.node, Scalar) and isinstance(at.node.value, str):
            yield Use(at.node.text, at.node.span, at.path, wanted)


class Settable(Struct):
    """A parameter or an axis of variants. `default` is as written; `values` are the allowed values, if listed."""

    name: str
    kind: str
    default: str = ""
    values: tuple[str, ...] = ()
    unit: str = ""
    doc: str = ""

    @property
    def detail(self) -> str:
        default = f", default {self.default}" if self.default else ""
        choice = f", one of {', '.join(self.values)}" if self.values and self.kind == "parameter" else ""
        return f"{self.kind}{default}{' ' + self.unit if self.unit else ''}{choice}"


def settables(data: Any) -> dict[str, Settable]:
    """Return the declared parameters and axes by name. Half-written declarations are left out."""
    found: dict[str, Settable] = {}
    for name, written in _entries(data, "params"):
        entry = written if isinstance(written, dict) else {"default": written}
        choices = entry.get("choices")
        default = entry.get("default")
        values = tuple(map(text, choices)) if isinstance(choices, list) else ()
        values = ("true", "false") if isinstance(default, bool) else values
        unit = text(entry.get("unit"))
        doc = text(entry.get("doc"))
        found[name] = Settable(name, "parameter", text(default), values, unit, doc)
    for name, written in _entries(data, "variants"):
        values = tuple(written) if isinstance(written, dict) else ()
        found[name] = Settable(name, "variant", values[0] if values else "", values)
    return found


def of_nested(at: Path, question: Question) -> dict[str, Settable]:
    tree = nested_document(at, question)
    return {} if tree is None else settables(to_python(tree))


def nested_document(at: Path, question: Question) -> Mapping | None:
    step = part_at(at, question.analysis.plan)
    if step is None or not isinstance(step.model, Plan):
        return None
    node = read_recipe(step.model.path, Context(folder=question.analysis.folder, fetching=Fetching(offline=True)))
    return node if isinstance(node, Mapping) else None


def _entries(data: Any, section: str) -> list[tuple[str, Any]]:
    entries = data.get(section) if isinstance(data, dict) else None
    return list(entries.items()) if isinstance(entries, dict) else []


def text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{name}: {text(each)}' for name, each in value.items())}}}"
    return f"[{', '.join(map(text, value))}]" if isinstance(value, list) else str(value)


def parameter_at(question: Question) -> tuple[str, Path | None] | None:
    """Return the parameter or variant at the cursor, and the part for which it is set, if any."""
    cursor = question.cursor
    if cursor.role in ("key", "either") and cursor.whole:
        if cursor.path in (("params",), ("variants",), ("matrix", "axes")) or cursor.path[-1:] == ("when",):
            return cursor.whole, None
        if cursor.path[-1:] == ("with",):
            return cursor.whole, cursor.path[:-1]
    name = _name_at(question)
    return None if name is None else (name, None)


def names_in(template: str) -> list[tuple[str, int, int]]:
    """Return the names in a text with `${…}`, with the columns that they cover. A text with errors has none."""
    try:
        return [(each.name, *each.at) for each in Template.parse(template).parameters()]
    except ExpressionError:
        return []


def parameter_uses(name: str, tree: Node | None) -> list[Span]:
    if tree is None:
        return []
    keys = [at.key.span for at in walk(tree) if at.key is not None and at.key.name == name and sets(at.path[:-1])]
    return [*keys, *expression_uses(name, tree)]


def expression_uses(name: str, tree: Node) -> list[Span]:
    """Return the places of a name in the expressions of a tree, in values and in keys."""
    return [span for text in _texts(tree) for each, span in _names_of(text) if each == name]


def _texts(tree: Node) -> Iterator[Scalar]:
    for _, key, node in walk(tree):
        if key is not None and is_template(key.name):
            width = (key.span.end_column or key.span.column) - key.span.column
            yield Scalar(key.name, key.span, key.name, plain=width == len(key.name))
        if isinstance(node, Scalar):
            yield node


class TurnName(NamedTuple):
    """A name of a `for`: the path of the repeated entry, the entry with its own key, and the key of the name."""

    path: Path
    entry: Mapping
    key: Key

    @property
    def uses(self) -> list[Span]:
        """The places of the name: its declaration, and the expressions of the entry."""
        return [self.key.span, *expression_uses(self.key.name, self.entry)]


def turn_names(tree: Node | None, path: Path) -> Iterator[TurnName]:
    """Yield the names of each `for` around a path, the outermost first. A `for` does not see its own names."""
    holder = tree
    for size, step in enumerate(path, 1):
        entry = None if holder is None else find(holder, (step,))
        is_repeated = isinstance(entry, Mapping) and is_item(path[:size]) and path[size : size + 1] != (FOR,)
        names = find(entry, (FOR,)) if isinstance(entry, Mapping) and is_repeated else None
        if isinstance(names, Mapping) and isinstance(entry, Mapping):
            own = entry
            if isinstance(holder, Mapping) and isinstance(step, str):
                own = Mapping({step: holder.entries[step]}, holder.span)
            yield from (TurnName(path[:size], own, key) for key, _ in names.entries.values())
        holder = entry


def turn_name_at(question: Question, tree: Node | None) -> TurnName | None:
    """Return the name of a `for` at the cursor: where `for` declares it, or where an expression uses it."""
    cursor = question.cursor
    path = place_of(question)
    if cursor.role != "value" and path[-2:-1] == (FOR,):
        declared = turn_names(tree, path[:-2])
        return next((each for each in declared if each.path == path[:-2] and each.key.name == path[-1]), None)
    name = _name_at(question)
    return next((each for each in turn_names(tree, path) if each.key.name == name), None)


def _name_at(question: Question) -> str | None:
    """Return the name at the cursor in an expression."""
    at = question.column - question.cursor.start
    return next((name for name, start, end in names_in(question.cursor.whole) if start <= at <= end), None)


def is_in_expression(question: Question) -> bool:
    return _name_at(question) is not None


def place_of(question: Question) -> Path:
    """Return the path of the cursor. At a key, it ends with that key."""
    cursor = question.cursor
    if cursor.role == "value" or not cursor.whole or isinstance(question.at(cursor.path), list):
        return cursor.path
    return (*cursor.path, cursor.whole)


def sets(path: Path) -> bool:
    """Return whether the keys of the mapping at a path are parameters or variants of the recipe."""
    if path in (("params",), ("variants",), ("matrix", "axes")) or path[-1:] == ("when",):
        return True
    return path[:1] == ("matrix",) and len(path) == 3


def _names_of(node: Scalar) -> Iterator[tuple[str, Span]]:
    if node.block is None:
        begin = node.span.column + (0 if node.plain else 1)
        width = (node.span.end_column or node.span.column) - node.span.column
        has_escapes = width not in (len(node.text), len(node.text) + 2)  # their length in the file is not known
        if not has_escapes:
            for name, start, end in names_in(node.text):
                yield name, replace(node.span, column=begin + start, end_column=begin + end)
        return
    line, column = node.block
    for name, start, end in names_in(node.text):
        above = node.text[:start].count("\n")
        last = start - (node.text.rfind("\n", 0, start) + 1)
        row = line + above
        yield name, Span(node.span.file, row, column + last, end_line=row, end_column=column + last + end - start)


def wanted_as_value(question: Question) -> Wanted | None:
    path = question.path
    if question.cursor.role not in ("value", "either") or not path:
        return None
    around = path[:-2] if isinstance(path[-1], int) else path[:-1]
    forms = [*forms_at(path[:-1], question.data), *(forms_at(around, question.data) if around != path[:-1] else ())]
    return wanted_value(path, forms, question.at(around))


def wanted_at(question: Question) -> Wanted | None:
    if isinstance(question, ModelQuestion):
        return question.named
    found = wanted_as_value(question)
    return wanted_key(question.path) if found is None and question.cursor.role in ("key", "either") else found


def named_at(question: Question) -> list[Known]:
    """Return the elements that the name at the cursor refers to, of the most likely kind. A pattern refers to none."""
    wanted = wanted_at(question)
    name = question.cursor.whole.strip()
    analysis = question.analysis
    if wanted is None or not name:
        return []
    found = [(rank, each) for rank, each in fitting(wanted, analysis.names, analysis.plan) if each.name == name]
    best = min((rank for rank, _ in found), default=0)
    return [each for rank, each in found if rank == best and each.namespace != PART]


def part_named_at(question: Question) -> Path | None:
    """Return the path of the part that the cursor names: at its key, or where another entry refers to it."""
    cursor = question.cursor
    plan = question.analysis.plan
    if cursor.role in ("key", "either") and cursor.path == ("attach",) and cursor.whole:
        return ("attach", cursor.whole)
    wanted = wanted_at(question)
    if wanted is None or PART not in wanted.namespaces or plan is None:
        return None
    at: Path = ("base",) if cursor.whole == "base" else ("attach", cursor.whole)
    return None if part_at(at, plan) is None else at


def declared_by(node: Element) -> str:
    """Return the attribute from which an element has its name."""
    return "class" if node.tag == "default" else "name" if node.get("name") or "file" not in node.attrib else "file"


def declared_at(known: Known, analysis: Analysis) -> Iterator[Span]:
    node = known.node
    traced = analysis.traced
    if node is None:
        return
    if traced is not None and node in traced.watch.lives:
        life = traced.watch.life(node)
        named = traced.written_at(node, "class" if node.tag == "default" else "name") if known.name else None
        places = [named] if named is not None else [each.span for each in traced.written(life)]
        yield from analysis.all_now(dict.fromkeys(places), analysis.model_of)
    elif (unit := unit_of(known, analysis)) is not None:
        yield from analysis.all_now([unit.origins.span(node, unit.file, declared_by(node))], analysis.model_of)


def unit_of(known: Known, analysis: Analysis) -> Unit | None:
    if known.node is None:
        return None
    root = known.node.getroottree().getroot()
    return next((unit for unit in analysis.names.sources.values() if unit.root is root), None)


def in_model(known: Known, analysis: Analysis) -> Known:
    """Return the element in the composed model for an element with a name inside a part."""
    traced = analysis.traced
    if known.node is None or traced is None or known.node in traced.watch.lives:
        return known
    unit = unit_of(known, analysis)
    part = next((part for part, each in analysis.names.sources.items() if each is unit), None)
    prefix = analysis.names.prefixes.get(part or "", "")
    found = analysis.names.find(known.namespace, prefix + known.name)
    return known if found is None else replace(found)

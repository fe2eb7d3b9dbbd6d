"""Definitions, references, symbols, folding, hints and lenses."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator
from collections.abc import Sequence as AbcSequence
from dataclasses import replace
from pathlib import Path as File
from typing import TYPE_CHECKING, Any, NamedTuple

from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.build.plan.plan import Plan
from mjcompose.language.expand import cells
from mjcompose.language.value import angle_places
from mjcompose.lsp import subject
from mjcompose.lsp.analysis import Analysis, Change, Fold, Hint, Hover, Known, Lens, Question, Symbol, lines_of, shown
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.hover import describe, values_of
from mjcompose.lsp.language import Form, forms_at, forms_below, kinds_of
from mjcompose.lsp.places import PART, is_selector, label, matches, part_called, part_of_reference
from mjcompose.model.names import NameIndex
from mjcompose.text.layout import format_recipe
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, find, is_template, locate, spans, to_python

if TYPE_CHECKING:
    from lxml.etree import _Element as _EtreeElement


def definition(question: Question) -> list[Span]:
    """Return the places where what is at the cursor is defined."""
    return list(dict.fromkeys([*_elements(question), *_part(question), *_parameter(question), *_model(question)]))


def _elements(question: Question) -> Iterator[Span]:
    for known in subject.named_at(question):
        yield from subject.declared_at(subject.in_model(known, question.analysis), question.analysis)


def _part(question: Question) -> Iterator[Span]:
    at, tree = subject.part_named_at(question), question.analysis.mapping
    if at is not None and tree is not None and find(tree, at) is not None:
        span = question.analysis.now(locate(tree, at, key=True), question.analysis.tree_of)
        yield from () if span is None else (span,)


def _parameter(question: Question) -> Iterator[Span]:
    found = subject.parameter_at(question)
    if found is None:
        return
    name, nested = found
    tree = question.analysis.mapping if nested is None else subject.nested_document(nested, question)
    for section in ("params", "variants"):
        if isinstance(tree, Mapping) and find(tree, (section, name)) is not None:
            span = question.analysis.now(locate(tree, (section, name), key=True), question.analysis.tree_of)
            yield from () if span is None else (span,)


def _model(question: Question) -> Iterator[Span]:
    """Yield the start of the file that a model reference leads to."""
    plan = question.analysis.plan
    if question.cursor.role == "key" or plan is None:
        return
    if question.path == ("extends",):
        yield from (Span(str(source.path), 1, 1, 1, 1) for source, _ in plan.extended[:1])
    name = part_of_reference(question.path, plan)
    for place in plan.walk():
        if place.part == name and place.model is not None:
            file: File = place.model.path
            if not (isinstance(place.model, Plan) and place.model.at):
                yield Span(str(file), 1, 1, 1, 1)
            return


def folds(lines: AbcSequence[str]) -> list[Fold]:
    """Return the first and last lines of the blocks and comments of a text.

    >>> folds(["a:", "  b: 1", "", "  c: 2", "d: 3"])
    [Fold(first=0, last=3, kind='region')]
    """
    return sorted([*_blocks(lines), *_comments(lines)], key=lambda each: (each.first, each.last))


def _blocks(lines: AbcSequence[str]) -> Iterator[Fold]:
    open: list[tuple[int, int]] = []
    last = -1
    for number, line in enumerate([*lines, "end"]):
        if number < len(lines) and (not line.strip() or line.lstrip().startswith("#")):
            continue
        indent = len(line) - len(line.lstrip()) if number < len(lines) else -1
        while open and open[-1][0] >= indent:
            _, first = open.pop()
            if last > first:
                yield Fold(first, last)
        open.append((indent, number))
        last = number


def _comments(lines: AbcSequence[str]) -> Iterator[Fold]:
    first = None
    for number, line in enumerate([*lines, ""]):
        is_comment = line.lstrip().startswith("#")
        if is_comment and first is None:
            first = number
        elif not is_comment and first is not None:
            if number - first > 1:
                yield Fold(first, number - 1, "comment")
            first = None


_FROM_MODEL_MOST = 4
"""How many elements are described that one line has become."""


def elements_at(path: File, line: int, analysis: Analysis) -> list[Known]:
    """Return the named elements of a composed model that come from a line of a file, counted from 0."""
    traced = analysis.traced
    if traced is None:
        return []
    nodes = set(traced.on_line(shown(path, analysis.folder), line + 1))
    every = (known for names in analysis.names.known.values() for known in names.values())
    return [known for known in every if known.node in nodes]


def hover_in_model(path: File, line: int, analyses: Iterable[Analysis]) -> Hover | None:
    """Return what the element on a line becomes in each recipe, or None."""
    found = [(known, each) for each in analyses for known in elements_at(path, line, each)]
    if not found:
        return None
    texts = [f"in `{each.file}`: {describe(known, each)}" for known, each in found[:_FROM_MODEL_MOST]]
    if len(found) > _FROM_MODEL_MOST:
        texts.append(f"… and {len(found) - _FROM_MODEL_MOST} more")
    return Hover("\n\n---\n\n".join(texts))


def references_in_recipes(path: File, line: int, analyses: Iterable[Analysis]) -> list[Span]:
    """Return the places in recipes and models that refer to the element on a line."""
    found = [span for each in analyses for known in elements_at(path, line, each) for span in uses_of(known, each)]
    return list(dict.fromkeys(found))


_HINTS_MOST = 4
_UNITS = {"degree": "deg", "radian": "rad"}


def hints(analysis: Analysis) -> list[Hint]:
    """Return the hints of a recipe whose current text can be read."""
    tree = analysis.mapping
    if tree is None or not analysis.is_current:
        return []
    angle = find(tree, ("angle",))
    unit = _UNITS.get(angle.text, "") if isinstance(angle, Scalar) else ""
    data = to_python(tree)
    return list(_walk(tree, data, (), forms_at((), data), _Around(analysis, tree, unit)))


class _Around(NamedTuple):
    analysis: Analysis
    tree: Mapping
    unit: str


def _walk(node: Node, data: Any, path: Path, forms: list[Form], around: _Around) -> Iterator[Hint]:
    if isinstance(node, Scalar):
        if is_template(node.text) and path[:1] != ("params",):
            yield from _value(node, around.tree)
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            below = forms_below(forms, index, data[index])
            yield from _walk(item, data[index], (*path, index), below, around)
    else:
        if is_selector(path, data):
            yield from _count(node, path, data, around.analysis)
        for name, (_, value) in node.entries.items():
            if around.unit:
                yield from _angles(name, value, data, forms, around.unit)
            below = forms_below(forms, name, data[name])
            yield from _walk(value, data[name], (*path, name), below, around)


def _value(node: Scalar, tree: Mapping) -> Iterator[Hint]:
    values = list(dict.fromkeys(values_of(node.text, tree).values()))
    if values:
        more = f" | … {len(values) - _HINTS_MOST} more" if len(values) > _HINTS_MOST else ""
        yield Hint(node.span, f"= {' | '.join(values[:_HINTS_MOST])}{more}")


def _count(node: Mapping, path: Path, data: dict[str, Any], analysis: Analysis) -> Iterator[Hint]:
    if path[-1] in ("parent", "in") or "where" in data or not analysis.is_composed:
        return
    found = matches(path, data, analysis)
    tag = next(iter(node.entries))
    if found:  # what matches nothing is an error, unless an edit before it renames or removes
        yield Hint(node.entries[tag][1].span, f"× {len(found)}", ", ".join(map(label, found[:20])))


def _angles(name: str, value: Node, data: dict[str, Any], forms: list[Form], unit: str) -> Iterator[Hint]:
    """Yield the unit of each angle that is written without one."""
    items = value.items if isinstance(value, Sequence) else (value,)
    numbers = [item for item in items if isinstance(item, Scalar)]
    if len(numbers) != len(items) or not any(isinstance(each.value, int | float) for each in numbers):
        return
    for kind in kinds_of(forms):
        attribute = kind.attributes.get(name)
        if attribute is None or attribute.angle is None:
            continue
        joint = str(data.get("type", "hinge")) if kind.tag == "joint" else None
        for index in angle_places(attribute, len(items), joint):
            each = numbers[index]
            if isinstance(each.value, int | float) and not isinstance(each.value, bool) and each.value:
                word = "degree" if unit == "deg" else "radian"
                yield Hint(each.span, unit, f"an angle, in the unit of `angle: {word}`")
        return


_LINE = re.compile(r"[^\r\n]*(?:\r\n|\n|\r)|[^\r\n]+\Z")


def formatted(text: str, file: str) -> list[Change]:
    """Return the changes that `fmt` would make, or none if the text is not a recipe that it can format."""
    result = format_recipe(text.encode("utf-8", "replace"), file, Sink())
    if result is None:
        return []
    before, after = _LINE.findall(text), _LINE.findall(result.decode("utf-8"))
    return [
        Change(_span(file, first, last, text), "".join(after[low:high]))
        for kind, first, last, low, high in difflib.SequenceMatcher(None, before, after, False).get_opcodes()
        if kind != "equal"
    ]


def _span(file: str, first: int, last: int, text: str) -> Span:
    """Return the span of whole lines, counted from 0.

    A last line without a line break ends after its last character.
    """
    lines = lines_of(text)
    if last >= len(lines):
        return Span(file, first + 1, 1, len(lines), len(lines[-1]) + 1)
    return Span(file, first + 1, 1, last + 1, 1)


COMMANDS = ("view", "build", "check")
_LENSES_MOST = 12


def lenses(analysis: Analysis) -> list[Lens]:
    """Return the commands for the model, and for each cell of the matrix if there are not too many."""
    tree = analysis.mapping
    return [] if tree is None else list(_of_lenses(tree, analysis))


def _of_lenses(tree: Mapping, analysis: Analysis) -> Iterator[Lens]:
    top = next((name for name in ("recipe", "extends") if name in tree.entries), None)
    if top is None:
        return
    at = analysis.now(locate(tree, (top,), key=True), analysis.tree_of)
    if at is not None:
        for command in COMMANDS:
            yield Lens(at, command, f"mjcompose.{command}", (str(analysis.path),))
    if "matrix" not in tree.entries:
        return
    at = analysis.now(locate(tree, ("matrix",), key=True), analysis.tree_of)
    if at is None:
        return
    named = find(tree, ("name",))
    every = cells(tree, named.text if isinstance(named, Scalar) else analysis.path.stem, Sink())
    for cell in every[:_LENSES_MOST]:
        for command in COMMANDS:
            yield Lens(at, f"{command} {cell.name}", f"mjcompose.{command}", (str(analysis.path), cell.name))


def references(question: Question, declaration: bool = True) -> list[Span]:
    """Return the places that use what is at the cursor. With `declaration`, its declaration comes first."""
    analysis = question.analysis
    found: list[Span] = []
    for known in subject.named_at(question):
        meant = subject.in_model(known, analysis)
        found += subject.declared_at(meant, analysis) if declaration else ()
        found += uses_of(meant, analysis)
    if (at := subject.part_named_at(question)) is not None:
        found += _now([use.span for use in uses_of_part(part_called(at, analysis.plan), analysis)], analysis)
    if (parameter := subject.parameter_at(question)) is not None and parameter[1] is None:
        found += _now(subject.parameter_uses(parameter[0], analysis.tree), analysis)
    return list(dict.fromkeys(found))


def _now(spans: Iterable[Span], analysis: Analysis) -> Iterator[Span]:
    """Yield places of the tree at their positions in the current text."""
    for span in spans:
        if (now := analysis.now(span, analysis.tree_of)) is not None:
            yield now


def uses_of(known: Known, analysis: Analysis) -> Iterator[Span]:
    """Yield the places that refer to an element, in the recipe and in the composed model."""
    for use in subject.uses_in(analysis.tree):
        if use.text == name_there(known, use, analysis) and known.namespace in use.wanted.namespaces:
            yield from _now([use.span], analysis)
    traced = analysis.traced
    if traced is None:
        return
    for node, attribute in NameIndex.of(traced.model.root).users(known.namespace, known.name):
        if (span := _written(node, attribute, analysis)) is not None:
            yield span


def _written(node: _EtreeElement, attribute: str, analysis: Analysis) -> Span | None:
    traced = analysis.traced
    if traced is None or node not in traced.watch.lives:
        return None
    span = traced.written_at(node, attribute)
    return None if span is None else analysis.now(span, analysis.model_of)


def name_there(known: Known, use: subject.Use, analysis: Analysis) -> str | None:
    """Return the name of an element at a place that uses it: the final name, or the name inside its part."""
    if not use.wanted.of:
        return known.name
    prefix = analysis.names.prefixes.get(part_called(use.wanted.of, analysis.plan))
    if prefix is None or not known.name.startswith(prefix):
        return None
    return known.name[len(prefix) :]


def uses_of_part(part: str, analysis: Analysis) -> Iterator[subject.Use]:
    """Yield the places that name a part, or anything in it by its prefix."""
    prefix = analysis.names.prefixes.get(part)
    for use in subject.uses_in(analysis.tree):
        if use.wanted.of:
            continue
        is_part = PART in use.wanted.namespaces
        if (is_part and (use.text == part or use.text.startswith(f"{part}/"))) or (
            prefix and not is_part and use.text.startswith(prefix)
        ):
            yield use


_DEPTH = 4
_TELLING = ("model", "type", "to", "select", "default")
_NAMING = ("name", "id", "to")


def symbols(analysis: Analysis) -> list[Symbol]:
    """Return the outline down to elements and their settings; of half-written text, what can be read."""
    found = _of_symbols(analysis.tree, 0) if isinstance(analysis.tree, Mapping) else ()
    return list(_standing(found, analysis))


def _standing(found: Iterable[Symbol], analysis: Analysis) -> Iterator[Symbol]:
    for each in found:
        span, whole = (analysis.now(place, analysis.tree_of) for place in (each.span, each.whole))
        if span is not None:
            yield replace(each, span=span, whole=whole or span, children=tuple(_standing(each.children, analysis)))


def _of_symbols(node: Node, depth: int) -> Iterator[Symbol]:
    if depth >= _DEPTH:
        return
    if isinstance(node, Mapping):
        for name, (key, value) in node.entries.items():
            kind = "section" if depth == 0 else "value" if isinstance(value, Scalar) else "element"
            whole = _around(key.span, value)
            yield Symbol(name, kind, key.span, whole, _detail(value), tuple(_of_symbols(value, depth + 1)))
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            if not isinstance(item, Scalar):
                yield Symbol(_label(item, index), "element", item.span, _around(item.span, item), _detail(item),
                             tuple(_of_symbols(item, depth + 1)))  # fmt: skip


def _around(first: Span, node: Node) -> Span:
    """Return the span from a place to the end of a value."""
    line, column = first.end_line or first.line, first.end_column or first.column
    for span in spans(node):
        end = span.end_line or span.line, span.end_column or span.column
        if span.file == first.file and end > (line, column):
            line, column = end
    return replace(first, end_line=line, end_column=column)


def _label(node: Node, index: int) -> str:
    for key in _NAMING:
        found = find(node, (key,))
        if isinstance(found, Scalar):
            return found.text
    return f"[{index}]"


def _detail(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text if len(node.text) <= 60 else f"{node.text[:59]}…"
    found = (find(node, (key,)) for key in _TELLING)
    return next((each.text for each in found if isinstance(each, Scalar)), "")

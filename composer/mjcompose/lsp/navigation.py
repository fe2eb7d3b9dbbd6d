"""Definitions, references, symbols, folding, hints and lenses."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence as AbcSequence
from dataclasses import replace
from pathlib import Path as File
from typing import Any

from mjcompose.base.alignment import Alignment
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.language.expand import cells
from mjcompose.language.value import angle_places
from mjcompose.lsp import mjcf, subject
from mjcompose.lsp.analysis import Analysis, Fold, Hint, Hover, Known, Lens, Question, Symbol, shown
from mjcompose.lsp.cursor import Path
from mjcompose.lsp.hover import describe, values_of
from mjcompose.lsp.language import ValueForm, kinds_of
from mjcompose.lsp.markup import ModelAnalysis, ModelQuestion
from mjcompose.lsp.places import PART, is_selector, label, matches, part_at, part_called, part_of_reference
from mjcompose.plan.plan import Plan
from mjcompose.text.layout import format_recipe
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, TextChange, find, is_template, lines_of, locate, spans
from mjcompose.tree.names import NameIndex
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_layout import format_mjcf
from mjcompose.tree.xml_text import kind_of


def definition(question: Question) -> list[Span]:
    if isinstance(question, ModelQuestion):
        return list(dict.fromkeys([*_named(question), *mjcf.file_at(question)]))
    return list(dict.fromkeys([*_named(question), *_declared(question), *_model(question)]))


def _named(question: Question) -> Iterator[Span]:
    for known in subject.named_at(question):
        yield from subject.declared_at(subject.in_model(known, question.analysis), question.analysis)


def _declared(question: Question) -> Iterator[Span]:
    analysis = question.analysis
    turn = subject.turn_name_at(question, analysis.tree)
    if turn is not None:
        yield from analysis.all_now([turn.key.span], analysis.tree_of)
        return
    at = subject.part_named_at(question)
    step = None if at is None else part_at(at, analysis.plan)
    if step is not None and step.span.turn is not None:
        yield from analysis.all_now([step.span], analysis.tree_of)
        return
    tree = analysis.mapping
    paths = [] if at is None else [at]
    parameter = subject.parameter_at(question)
    if parameter is not None:
        name, nested = parameter
        tree = tree if nested is None else subject.nested_document(nested, question)
        paths += [("params", name), ("variants", name)]
    if tree is not None:
        spans = (locate(tree, path, key=True) for path in paths if find(tree, path) is not None)
        yield from analysis.all_now(spans, analysis.tree_of)


def _model(question: Question) -> Iterator[Span]:
    plan = question.analysis.plan
    if question.cursor.role == "key" or plan is None:
        return
    if question.path == ("extends",):
        yield from (Span(str(source.path), 1, 1, end_line=1, end_column=1) for source, _ in plan.extended[:1])
    name = part_of_reference(question.path, plan)
    model = next((place.model for place in plan.walk() if place.part == name and place.model is not None), None)
    if model is not None and not (isinstance(model, Plan) and model.at):
        yield Span(str(model.path), 1, 1, end_line=1, end_column=1)


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


def elements_at(path: File, line: int, analysis: Analysis) -> list[Known]:
    """Return the named elements of a composed model that come from a line of a file, counted from 0."""
    traced = analysis.traced
    if traced is None:
        return []
    nodes = set(traced.on_line(shown(path, analysis.folder), line + 1))
    every = (known for names in analysis.names.known.values() for known in names.values())
    return [known for known in every if known.node in nodes]


def hover_in_model(path: File, line: int, analyzes: Iterable[Analysis]) -> Hover | None:
    found = [(known, each) for each in analyzes for known in elements_at(path, line, each)]
    if not found:
        return None
    texts = [f"in `{each.file}`: {describe(known, each)}" for known, each in found[:_FROM_MODEL_MOST]]
    if len(found) > _FROM_MODEL_MOST:
        texts.append(f"… and {len(found) - _FROM_MODEL_MOST} more")
    return Hover("\n\n---\n\n".join(texts))


_HINTS_MOST = 4
_UNITS = {"degree": "deg", "radian": "rad"}


def hints(analysis: Analysis) -> list[Hint]:
    tree = analysis.mapping
    if tree is None or not analysis.is_current:
        return []
    angle = find(tree, ("angle",))
    unit = _UNITS.get(angle.text, "") if isinstance(angle, Scalar) else ""
    hints: list[Hint] = []
    for at in subject.formed(tree):
        if at.key is not None and unit:
            hints += _angles(at.key.name, at.node, at.around, at.above, unit)
        if isinstance(at.node, Scalar):
            if is_template(at.node.text) and at.path[:1] != ("params",):
                hints += _value(at.node, tree, at.path)
        elif isinstance(at.node, Mapping) and is_selector(at.path, at.data):
            hints += _count(at.node, at.path, at.data, analysis)
    return hints


def _value(node: Scalar, tree: Mapping, path: Path) -> Iterator[Hint]:
    values = list(dict.fromkeys(values_of(node.text, tree, path).values()))
    if values:
        more = f" | … {len(values) - _HINTS_MOST} more" if len(values) > _HINTS_MOST else ""
        yield Hint(node.span, f"= {' | '.join(values[:_HINTS_MOST])}{more}")


def _count(node: Mapping, path: Path, data: dict[str, Any], analysis: Analysis) -> Iterator[Hint]:
    if path[-1] in ("parent", "in") or "where" in data or not analysis.is_composed:
        return
    found = matches(path, data, analysis)
    tag = next(iter(node.entries))
    if found:  # a selector without a match is an error, unless an edit before it renames or removes
        yield Hint(node.entries[tag][1].span, f"× {len(found)}", ", ".join(map(label, found[:20])))


def _angles(name: str, value: Node, data: dict[str, Any], forms: list[ValueForm], unit: str) -> Iterator[Hint]:
    items = value.items if isinstance(value, Sequence) else (value,)
    numbers = [item for item in items if isinstance(item, Scalar)]
    if len(numbers) != len(items):
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


def formatted(text: str, file: str) -> list[TextChange]:
    """Return the changes that `fmt` would make, or none if it cannot format the text."""
    layout = format_mjcf if kind_of(File(file), text) == "model" else format_recipe
    result = layout(text.encode("utf-8", "replace"), file, Sink())
    if result is None:
        return []
    before = _LINE.findall(text)
    after = _LINE.findall(result.decode("utf-8"))
    steps = Alignment(before, after).get_opcodes()
    changed = (rows for kind, *rows in steps if kind != "equal")
    return [TextChange(_span(file, first, last, text), "".join(after[low:high])) for first, last, low, high in changed]


def _span(file: str, first: int, last: int, text: str) -> Span:
    """Return the span of whole lines, counted from 0. A last line without a line break ends after its text."""
    lines = lines_of(text)
    if last >= len(lines):
        return Span(file, first + 1, 1, end_line=len(lines), end_column=len(lines[-1]) + 1)
    return Span(file, first + 1, 1, end_line=last + 1, end_column=1)


COMMANDS = ("view", "build", "check")
_LENSES_MOST = 12


def lenses(analysis: Analysis) -> list[Lens]:
    tree = analysis.mapping
    top = next((name for name in ("recipe", "extends") if tree is not None and name in tree.entries), None)
    if tree is None or top is None:
        return []
    lenses = []
    path = str(analysis.path)
    for at in analysis.all_now([locate(tree, (top,), key=True)], analysis.tree_of):
        lenses += [Lens(at, command, f"mjcompose.{command}", (path,)) for command in COMMANDS]
    places = [locate(tree, ("matrix",), key=True)] if "matrix" in tree.entries else []
    for at in analysis.all_now(places, analysis.tree_of):
        named = find(tree, ("name",))
        for cell in cells(tree, named.text if isinstance(named, Scalar) else analysis.path.stem, Sink())[:_LENSES_MOST]:
            lenses += [
                Lens(at, f"{command} {cell.name}", f"mjcompose.{command}", (path, cell.name)) for command in COMMANDS
            ]
    return lenses


def references(question: Question, declaration: bool = True, others: Iterable[tuple[Unit, str]] = ()) -> list[Span]:
    """Return the places that use the name at the cursor. With `declaration`, its declaration comes first.

    `others` are models that include or attach the file of the question, with the prefix of its names there.
    """
    analysis = question.analysis
    found: list[Span] = []
    for known in subject.named_at(question):
        meant = subject.in_model(known, analysis)
        found += subject.declared_at(meant, analysis) if declaration else ()
        found += uses_of(meant, analysis)
        for unit, prefix in others:
            found += mjcf.uses(replace(known, name=prefix + known.name), unit)
    if isinstance(question, ModelQuestion):
        return list(dict.fromkeys(found))
    at = subject.part_named_at(question)
    if at is not None:
        uses = [use.span for use in uses_of_part(part_called(at, analysis.plan), analysis)]
        found += analysis.all_now(uses, analysis.tree_of)
    turn = subject.turn_name_at(question, analysis.tree)
    if turn is not None:
        found += analysis.all_now(turn.uses, analysis.tree_of)
    elif (parameter := subject.parameter_at(question)) is not None and parameter[1] is None:
        found += analysis.all_now(subject.parameter_uses(parameter[0], analysis.tree), analysis.tree_of)
    return list(dict.fromkeys(found))


def uses_of(known: Known, analysis: Analysis) -> Iterator[Span]:
    if isinstance(analysis, ModelAnalysis) and analysis.unit is not None:
        yield from analysis.all_now(mjcf.uses(known, analysis.unit), analysis.model_of)
    for use in subject.uses_in(analysis.tree):
        if use.text == name_there(known, use, analysis) and known.namespace in use.wanted.namespaces:
            yield from analysis.all_now([use.span], analysis.tree_of)
    traced = analysis.traced
    if traced is not None:
        users = NameIndex.of(traced.model.root).users(known.namespace, known.name)
        spans = (traced.written_at(node, attribute) for node, attribute in users if node in traced.watch.lives)
        yield from analysis.all_now(spans, analysis.model_of)


def name_there(known: Known, use: subject.Use, analysis: Analysis) -> str | None:
    """Return the name of an element at a place that uses it: the final name, or the name inside its part."""
    if not use.wanted.of:
        return known.name
    prefix = analysis.names.prefixes.get(part_called(use.wanted.of, analysis.plan))
    return None if prefix is None or not known.name.startswith(prefix) else known.name[len(prefix) :]


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
_DESCRIBING = ("model", "type", "to", "select", "default")
_NAMING = ("name", "id", "to")


def symbols(analysis: Analysis) -> list[Symbol]:
    """Return the outline down to elements and their settings; of half-written text, the readable part."""
    if isinstance(analysis, ModelAnalysis):
        return mjcf.symbols("\n".join(analysis.lines), analysis)
    return list(_symbols(analysis.tree, 0, analysis)) if isinstance(analysis.tree, Mapping) else []


def _symbols(node: Node, depth: int, analysis: Analysis) -> Iterator[Symbol]:
    entries: list[tuple[str, str, Span, Node]] = []
    if isinstance(node, Mapping):
        for name, (key, value) in node.entries.items():
            kind = "section" if depth == 0 else "value" if isinstance(value, Scalar) else "element"
            entries.append((name, kind, key.span, value))
    elif isinstance(node, Sequence):
        items = ((index, item) for index, item in enumerate(node.items) if not isinstance(item, Scalar))
        entries += [(_label(item, index), "element", item.span, item) for index, item in items]
    if depth < _DEPTH:
        for name, kind, place, value in entries:
            span, whole = (analysis.now(each, analysis.tree_of) for each in (place, _around(place, value)))
            if span is not None:
                below = tuple(_symbols(value, depth + 1, analysis))
                yield Symbol(name, kind, span, whole=whole or span, detail=_detail(value), children=below)


def _around(first: Span, node: Node) -> Span:
    line = first.end_line or first.line
    column = first.end_column or first.column
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
    return next((each.text for each in (find(node, (key,)) for key in _DESCRIBING) if isinstance(each, Scalar)), "")

"""The lines of recipes and sources behind a value."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterator
from contextlib import suppress
from functools import cached_property
from itertools import chain, takewhile
from pathlib import Path
from textwrap import dedent

from mjcompose.base.alignment import Alignment, common_ends
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import RECIPES
from mjcompose.contrast.changes import CauseLines
from mjcompose.language.repeat import FOR
from mjcompose.link.linking import Part
from mjcompose.plan.plan import AttachPart, Plan
from mjcompose.sides.side import Side
from mjcompose.sources.context import ReadRecipe
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError
from mjcompose.text.node import Mapping, Node, Scalar, find, is_template, spans, walk

_SHOWN = 6


def block(span: Span | None, side: Side) -> list[str]:
    """Return the lines of a place without empty ones."""
    if span is None:
        return []
    lines = side.lines(span.file)
    return [lines[number - 1] for number in extent(span, side) if lines[number - 1].strip()]


def extent(span: Span, side: Side) -> range:
    """Return the numbers of the lines that belong to a place.

    For a key or a mapping these are its line and the deeper-indented lines below it, for an element its whole start
    tag, for a value only its own line.
    """
    lines = side.lines(span.file)
    if not 0 < span.line <= len(lines):
        return range(0)
    first = lines[span.line - 1]
    end = span.line
    ahead = first[: span.column - 1]
    if is_yaml(span) and not ahead.replace("-", " ").strip():
        depth = len(first) - len(first.lstrip())
        below = ((number, line) for number, line in enumerate(lines[span.line :], span.line + 1) if line.strip())
        deeper = takewhile(lambda each: len(each[1]) - len(each[1].lstrip()) > depth, below)
        end = max((number for number, _ in deeper), default=end)
    elif not is_yaml(span) and first[span.column - 1 : span.column] == "<":
        while ">" not in lines[end - 1] and end < len(lines):
            end += 1
    return range(span.line, end + 1)


def excerpt(lines: list[str]) -> tuple[str, ...]:
    cut = [line.rstrip() for line in lines[:_SHOWN]]
    if len(lines) > _SHOWN:
        cut.append(cut[-1][: len(cut[-1]) - len(cut[-1].lstrip())] + "…")
    return tuple(dedent("\n".join(cut)).split("\n")) if cut else ()


def is_yaml(span: Span | None) -> bool:
    return span is not None and span.file.endswith(RECIPES)


def different(lines: list[str], others: list[str]) -> list[str]:
    """Return the lines that are not among the others, ignoring indentation."""
    known = {line.strip() for line in others}
    return [line for line in lines if line.strip() not in known]


_Place = tuple[str, int, int]


class Recipes:
    """The recipe of a side and its nested recipes; empty for a side that is not a recipe."""

    def __init__(self, side: Side) -> None:
        self.side = side
        self.plans: list[Plan] = []
        self.attached: dict[tuple[Span, str | None], tuple[Plan, AttachPart]] = {}
        """The parts by their place, and the turn of a `for` there."""
        self._given: dict[str, list[Span]] = defaultdict(list)
        if side.plan is not None:
            for plan in side.plan.plans():
                if any(plan is each for each in self.plans):
                    continue
                self.plans.append(plan)
                self.attached |= {(step.span, step.span.turn): (plan, step) for step in plan.parts}
                blocks = (find(plan.document, (*step.at, "with")) for step in plan.members)
                for entries in (each.entries for each in blocks if isinstance(each, Mapping)):
                    for name, (_, node) in entries.items():
                        self._given[name].append(node.span)
        for name, node in side.given.items():
            self._given[name].append(node.span)

    def attachment(self, part: Part | None, there: Recipes | None = None) -> Mapping | None:
        """Return the entry that attaches a part; for a part of another side, the entry at the same path here."""
        there = there or self
        if part is None or part.span is None:
            return None
        attached = there.attached.get((part.span, part.span.turn))
        if attached is None:
            return None
        plan, step = attached
        number = next(number for number, each in enumerate(there.plans) if each is plan)
        found = find(self.plans[number].document, step.at) if number < len(self.plans) else None
        return found if isinstance(found, Mapping) else None

    def base(self) -> Mapping | None:
        """Return the entry of the recipe's base, if it is more than the model."""
        found = None if self.side.plan is None else find(self.side.plan.document, ("base",))
        return found if isinstance(found, Mapping) else None

    def names_at(self, span: Span | None) -> tuple[str, ...]:
        """Return the parameters and variants in the expressions at a place."""
        if span is None:
            return ()
        lines = extent(span, self.side)
        end = span.end_column if span.end_line == span.line and len(lines) == 1 else None
        found = (
            names
            for (file, line, column), names in self._expressions.items()
            if file == span.file and line in lines and (end is None or span.column <= column < end)
        )
        turns = self._turns.get((span.file, span.line, span.column), ()) if span.turn is not None else ()
        return (*chain.from_iterable(found), *turns)

    def parameter(self, name: str) -> Iterator[Span]:
        """Yield the place where a parameter gets its value: its given value, or else its declaration."""
        yield from self._given.get(name, ())
        for node in self._documents:
            for piece in (node, *_pieces(node)):
                declared = find(piece, ("params", name))
                if isinstance(declared, Mapping):
                    yield from (each.node.span for each in walk(declared) if isinstance(each.node, Scalar))
                elif declared is not None:
                    yield declared.span

    def conditions(self) -> Iterator[tuple[Span, Node]]:
        """Yield the place of every item with a `when`, and its condition."""
        for document in self._documents:
            for _, _, node in walk(document):
                if isinstance(node, Mapping) and "when" in node.entries:
                    yield node.span, node.entries["when"][1]

    @property
    def files(self) -> Iterator[str]:
        """The recipe files as messages name them, including extended ones."""
        for recipe in self._read:
            yield from recipe.said

    @property
    def settings(self) -> Iterator[tuple[str, Span]]:
        """The places where recipe files set the reading of angles."""
        for recipe in self._read:
            for said in recipe.said.values():
                if isinstance(said, Mapping):
                    yield from ((key, node.span) for key, (_, node) in said.entries.items())

    @cached_property
    def _read(self) -> list[ReadRecipe]:
        known = self.side.operand.context.recipes
        return [known[path] for path in dict.fromkeys(plan.path for plan in self.plans) if path in known]

    @property
    def _documents(self) -> list[Node]:
        return [recipe.node for recipe in self._read if recipe.node is not None]

    @cached_property
    def _turns(self) -> dict[_Place, tuple[str, ...]]:
        """The names in the `for` of the entry around each place."""
        found: dict[_Place, tuple[str, ...]] = {}
        for _, key, entry in chain.from_iterable(map(walk, self._documents)):
            if isinstance(entry, Mapping) and FOR in entry.entries:
                values = [(each.file, each.line, each.column) for each in spans(entry.entries[FOR][1])]
                names = tuple(chain.from_iterable(self._expressions.get(place, ()) for place in values))
                for span in (*spans(entry), *([] if key is None else [key.span])):
                    place = span.file, span.line, span.column
                    found[place] = (*found.get(place, ()), *names)
        return found

    @cached_property
    def _expressions(self) -> dict[_Place, tuple[str, ...]]:
        found: dict[_Place, tuple[str, ...]] = {}
        for document in self._documents:
            for _, _, scalar in walk(document):
                if isinstance(scalar, Scalar) and isinstance(scalar.value, str) and is_template(scalar.value):
                    span = scalar.span
                    with suppress(ExpressionError):
                        names = dict.fromkeys(each.name for each in Template.parse(scalar.value).parameters())
                        found[span.file, span.line, span.column] = tuple(names)
        return found


def _pieces(document: Node) -> Iterator[Node]:
    axes = find(document, ("variants",))
    if isinstance(axes, Mapping):
        for _, values in axes.entries.values():
            if isinstance(values, Mapping):
                for _, piece in values.entries.values():
                    yield piece


class FilePairs:
    """The files of both sides, each with its counterpart on the other side."""

    def __init__(self, a: Recipes, b: Recipes) -> None:
        self.sides = a.side, b.side
        self._known: dict[tuple[str, str], tuple[frozenset[int], frozenset[int]]] = {}
        self._named = tuple({name(each.side, file): file for file in _files(each.side, each)} for each in (a, b))
        self._paths = tuple({real(each.side, file): file for file in _files(each.side, each)} for each in (a, b))

    def changed(self, side: int, span: Span | None) -> Span | None:
        """Return the first line of a place that the other side does not have, or None if it has all of them."""
        if span is None:
            return None
        lines = extent(span, self.sides[side])
        there = self._counterpart(side, span.file)
        if there is None:
            return span
        pair = (span.file, there) if side == 0 else (there, span.file)
        first = next((number for number in lines if number in self._lines(*pair)[side]), None)
        if first is None:
            return None
        return span if first == span.line else _line(self.sides[side], span.file, first)

    def twin(self, side: int, span: Span) -> Span | None:
        """Return the line of the other side that replaces a differing line."""
        there = self._counterpart(side, span.file)
        if there is None:
            return None
        for ends in self._stretches(*((span.file, there) if side == 0 else (there, span.file))):
            here, other = (ends[:2], ends[2:]) if side == 0 else (ends[2:], ends[:2])
            if here[0] < span.line <= here[1] and here[1] - here[0] == other[1] - other[0]:
                return _line(self.sides[1 - side], there, span.line + other[0] - here[0])
        return None

    def is_within(self, side: int, item: Span, span: Span) -> bool:
        """Return whether a place lies in an item of a recipe."""
        return item.file == span.file and span.line in extent(item, self.sides[side])

    def only(self) -> CauseLines | None:
        """Return the differing stretch of lines if it is the only one in all files, and so the only possible cause."""
        found: list[CauseLines] = []
        pairs = {(file, self._counterpart(0, file)) for file in self._named[0].values()}
        for a, b in pairs | {(self._counterpart(1, file), file) for file in self._named[1].values()}:
            if a is None or b is None:
                return None
            for first, last, start, end in self._stretches(a, b):
                before = _line(self.sides[0], a, first + 1) if last > first else None
                after = _line(self.sides[1], b, start + 1) if end > start else None
                found.append(CauseLines("line", before, after))
        return found[0] if len(found) == 1 else None

    def _counterpart(self, side: int, file: str) -> str | None:
        """Return the file at the same place on the other side; the counterpart of A itself is B."""
        here = self.sides[side]
        there = self.sides[1 - side]
        found = self._paths[1 - side].get(real(here, file))
        if found is not None:
            return found
        found = self._named[1 - side].get(name(here, file))
        if found is not None:
            return found
        mains = [each.operand.context.shown(each.operand.path) for each in (here, there)]
        alike = Path(mains[0]).suffix == Path(mains[1]).suffix and here.operand.kind is there.operand.kind
        if file == mains[0] and alike and name(there, mains[1]) not in self._named[side]:
            return mains[1]
        lines = here.lines(file)  # in a renamed file, every line is known
        return next((each for each in self._named[1 - side].values() if there.lines(each) == lines), None)

    def _lines(self, a: str, b: str) -> tuple[frozenset[int], frozenset[int]]:
        """Return the numbers of the lines that only A has, and of the lines that only B has."""
        if (a, b) not in self._known:
            stretches = self._stretches(a, b)
            ours = frozenset(number for first, last, _, _ in stretches for number in range(first + 1, last + 1))
            theirs = frozenset(number for _, _, start, end in stretches for number in range(start + 1, end + 1))
            self._known[a, b] = ours, theirs
        return self._known[a, b]

    def _stretches(self, a: str, b: str) -> list[tuple[int, int, int, int]]:
        lines = ([line.strip() for line in side.lines(file)] for side, file in zip(self.sides, (a, b), strict=True))
        return list(_different(*lines))


def name(side: Side, file: str | None) -> str:
    """Return a file's path relative to A or B, so two folders with the same layout have equal paths.

    A fetched file has the name of its reference, regardless of the commit or archive.
    """
    operand = side.operand
    there = operand.context.folder / (file or "")
    return operand.fetched(there) or os.path.relpath(there, operand.path.parent)


def real(side: Side, file: str | None) -> str:
    """Return the real path of a file, by which two sides can share one."""
    return os.path.realpath(side.operand.context.folder / (file or ""))


def _files(side: Side, recipes: Recipes) -> Iterator[str]:
    yield side.operand.context.shown(side.operand.path)
    yield from recipes.files
    if side.traced is not None:
        yield from dict.fromkeys(life.owner for life in side.traced.watch.lives.values() if isinstance(life.owner, str))


def _different(ours: list[str], theirs: list[str]) -> Iterator[tuple[int, int, int, int]]:
    """Yield the stretches of lines that differ. Common lines at the start and the end are skipped quickly."""
    head, tail = common_ends(ours, theirs)
    mine = ours[head : len(ours) - tail]
    yours = theirs[head : len(theirs) - tail]
    for tag, first, last, start, end in Alignment(mine, yours).get_opcodes():
        if tag != "equal":
            yield first + head, last + head, start + head, end + head


def _line(side: Side, file: str, number: int) -> Span:
    text = side.lines(file)[number - 1]
    return Span(file, number, len(text) - len(text.lstrip()) + 1)

"""Look up what lies behind a value in the recipes of one side: parameters, conditions, attachments of parts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from composer.diagnostics.span import Span
from composer.diff.excerpt import extent
from composer.diff.side import Side
from composer.document.node import Mapping, Node, Scalar, Sequence, find
from composer.expr.error import ExpressionError
from composer.expr.opening import is_template
from composer.expr.template import Template
from composer.plan.plan import AttachPart, Plan

if TYPE_CHECKING:
    from composer.context import ReadRecipe
    from composer.link.part import Part

_Place = tuple[str, int, int]


class Recipes:
    """The recipe of a side and its nested recipes; empty for a side that is not a recipe."""

    def __init__(self, side: Side) -> None:
        self.side = side
        self.plans: list[Plan] = []
        self.attached: dict[Span, tuple[Plan, AttachPart]] = {}
        self._given: dict[str, list[Span]] = {}
        for plan in () if side.plan is None else side.plan.plans():
            if all(plan is not each for each in self.plans):
                self._collect(plan)
        for name, node in side.given.items():
            self._given.setdefault(name, []).append(node.span)

    def _collect(self, plan: Plan) -> None:
        self.plans.append(plan)
        for step in plan.parts:
            self.attached[step.span] = plan, step
        for at in (("base", "with"), *((*step.at, "with") for step in plan.parts)):
            given = find(plan.document, at)
            if isinstance(given, Mapping):
                for name, (_, node) in given.entries.items():
                    self._given.setdefault(name, []).append(node.span)

    def attachment(self, part: Part) -> Mapping | None:
        """Return the entry of the recipe that attaches a part."""
        if part.span is None or part.span not in self.attached:
            return None
        plan, step = self.attached[part.span]
        found = find(plan.document, step.at)
        return found if isinstance(found, Mapping) else None

    def same(self, other: Recipes, part: Part) -> Mapping | None:
        """Return what this side has at the path where the other side attaches a part."""
        if part.span is None or part.span not in other.attached:
            return None
        plan, step = other.attached[part.span]
        number = next(number for number, each in enumerate(other.plans) if each is plan)
        if number >= len(self.plans):
            return None
        found = find(self.plans[number].document, step.at)
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
        return tuple(
            name
            for (file, line, column), names in self._expressions.items()
            if file == span.file and line in lines and (end is None or span.column <= column < end)
            for name in names
        )

    def parameter(self, name: str) -> Iterator[Span]:
        """Yield where a parameter gets its value: where it is given, else where it is declared."""
        yield from self._given.get(name, ())
        for node in self._documents:
            for piece in (node, *_pieces(node)):
                declared = find(piece, ("params", name))
                if isinstance(declared, Mapping):
                    yield from (value.span for _, value in declared.entries.values())
                elif declared is not None:
                    yield declared.span

    def conditions(self) -> Iterator[tuple[Span, Node]]:
        """Yield the place of every item with a `when`, and its condition."""
        for document in self._documents:
            for node in _mappings(document):
                if "when" in node.entries:
                    yield node.span, node.entries["when"][1]

    @property
    def files(self) -> Iterator[str]:
        """The recipe files as messages name them, including extended ones."""
        for recipe in self._read:
            yield from recipe.said

    @property
    def settings(self) -> Iterator[tuple[str, Span]]:
        """Where the recipe files set how angles are read."""
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
    def _expressions(self) -> dict[_Place, tuple[str, ...]]:
        found: dict[_Place, tuple[str, ...]] = {}
        for document in self._documents:
            for scalar in _scalars(document):
                if isinstance(scalar.value, str) and is_template(scalar.value):
                    span = scalar.span
                    found[span.file, span.line, span.column] = _names(scalar.value)
        return found


def _names(text: str) -> tuple[str, ...]:
    try:
        return tuple(dict.fromkeys(each.name for each in Template.parse(text).names()))
    except ExpressionError:
        return ()


def _pieces(document: Node) -> Iterator[Node]:
    """Yield the recipe pieces of the variants."""
    axes = find(document, ("variants",))
    for _, values in axes.entries.values() if isinstance(axes, Mapping) else ():
        for _, piece in values.entries.values() if isinstance(values, Mapping) else ():
            yield piece


def _scalars(node: Node) -> Iterator[Scalar]:
    if isinstance(node, Scalar):
        yield node
    elif isinstance(node, Sequence):
        for item in node.items:
            yield from _scalars(item)
    else:
        for _, value in node.entries.values():
            yield from _scalars(value)


def _mappings(node: Node) -> Iterator[Mapping]:
    if isinstance(node, Mapping):
        yield node
        for _, value in node.entries.values():
            yield from _mappings(value)
    elif isinstance(node, Sequence):
        for item in node.items:
            yield from _mappings(item)

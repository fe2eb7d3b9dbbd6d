"""Look up where elements are written on either side, and which parts they belong to."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.diagnostics.span import Span
from composer.diff.recipes import Recipes
from composer.diff.side import Side
from composer.diff.written import name, real
from composer.explain.trace import Life
from composer.tree.effective import class_in_force

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.link.part import Part


class Places:
    """Looks up elements in the traces of both sides; `side` is 0 for A and 1 for B."""

    def __init__(self, a: Side, b: Side, recipes: tuple[Recipes, Recipes]) -> None:
        self.sides = a, b
        self.recipes = recipes
        self.parts = _parts(a), _parts(b)

    def span(self, side: int, node: Node | None, attribute: str | None) -> Span | None:
        traced = self.sides[side].traced
        if traced is None or node is None:
            return None
        if attribute is None:
            return next(
                (reason.span for reason in traced.written(traced.watch.life(node)) if reason.span), None
            )
        return traced.written_at(node, attribute)

    def written(self, side: int, node: Node | None, attribute: str | None) -> list[Span]:
        """Return where an attribute was first written, and where it was changed since."""
        traced = self.sides[side].traced
        if traced is None or node is None:
            return []
        if attribute is None:
            span = self.span(side, node, None)
            return [] if span is None else [span]
        return traced.history(node, attribute)

    def class_in_force(self, side: int, node: Node) -> Span | None:
        """Return where the class in force for an element is written."""
        force = class_in_force(node)
        return None if force.attribute is None else self.span(side, force.writer, force.attribute)

    def life(self, side: int, node: Node | None) -> Life | None:
        traced = self.sides[side].traced
        return None if traced is None or node is None else traced.watch.life(node)

    def parts_of(self, side: int, node: Node | None) -> Iterator[Part]:
        """Yield the parts that an element belongs to, the outermost first."""
        traced = self.sides[side].traced
        if traced is None or node is None:
            return
        life = traced.watch.life(node)
        for each in (life, *life.sources):
            yield from reversed(each.parts)

    def part(self, side: int, node: Node) -> Part | None:
        """Return the outermost part of an element that the other side does not have with the same file."""
        for part in self.parts_of(side, node):
            there = self.parts[1 - side].get(part.called)
            if there is None or not self.same_file(side, part.unit.file, there.unit.file):
                return part
        return None

    def same_file(self, side: int, file: str, there: str) -> bool:
        """Return whether both sides name the same file, or files at the same place."""
        here, other = self.sides[side], self.sides[1 - side]
        return real(here, file) == real(other, there) or name(here, file) == name(other, there)

    def compiler_settings(self, side: int, life: Life | None) -> dict[str, Span]:
        """Return where the file of an element, or the recipe, writes the compiler settings that apply to it."""
        traced = self.sides[side].traced
        if traced is None or life is None:
            return {}
        found: dict[str, Span] = {}
        for source in (life, *life.sources):
            for each in traced.watch.lives.values():
                if each.tag == "compiler" and each.root is source.root and isinstance(each.owner, str):
                    found |= {key: each.span(traced.model.origins, key) for key in each.attributes}
        here = self.sides[side]
        found |= {f"{key} of {name(here, span.file)}": span for key, span in self.recipes[side].settings}
        return found

    def of_the_same_line(self, node: Node, side: int) -> Node | None:
        """Return the other side's element that was read from the same line of a model, or None if there is none."""
        here, there = self.sides[side].traced, self.sides[1 - side].traced
        if here is None or there is None:
            return None
        mine = here.watch.life(node)
        return next(
            (
                life.node
                for life in there.watch.lives.values()
                if (life.tag, life.line, life.attributes) == (mine.tag, mine.line, mine.attributes)
                and life.made_by is None
                and life.gone is None
            ),
            None,
        )


def _parts(side: Side) -> dict[str, Part]:
    """Return the parts of a side by name."""
    if side.traced is None:
        return {}
    return {part.called: part for life in side.traced.watch.lives.values() for part in life.parts}

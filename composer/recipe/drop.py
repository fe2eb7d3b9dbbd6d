"""Entries of `drop`: what is left out of a model, by section, tag or selector."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.suggest import advised
from composer.grammar import GRAMMAR
from composer.recipe.count import COUNT, read_count
from composer.recipe.edit_schema import drops
from composer.recipe.fault import Fault, Path
from composer.recipe.form import Form
from composer.recipe.reference import Schema
from composer.recipe.select import read_selector
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.tree.selector import EVERYTHING, Selector, known_tags, paths_of

# Without these, nothing else in a model can be read.
_KEPT = ("worldbody", "compiler")


@dataclass(frozen=True, slots=True)
class Drop:
    """One entry: a whole section, or a selector. `index` is its place in the list.

    `expect` is the number of elements, None for at least one; with `optional`, none is allowed.
    """

    section: str | None
    select: Selector | None
    index: int
    expect: int | None = None
    optional: bool = False

    def __str__(self) -> str:
        if self.section is not None:
            return self.section
        assert self.select is not None
        return self.select.tag if self.select == Selector(self.select.tag, EVERYTHING) else str(self.select)


@dataclass(frozen=True, slots=True)
class Drops(Form):
    """Form of a field `drop`: `[light, contact, {geom: "visual_*"}]`, read as a tuple of `Drop`."""

    def schema(self) -> Schema:
        return drops()

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Drop, ...]:
        found: list[Drop | None] = []
        if isinstance(value, list):
            found = [_drop(item, index, (index,), faults=faults) for index, item in enumerate(value)]
        else:
            help = f"write `drop: [{value}]`" if isinstance(value, str) else "write `drop: [light, contact]`"
            faults.append(Fault("wrong-type", f"`drop` expects a list, got {kind_of(value)}", help=help))
        return tuple(each for each in found if each is not None)


def _drop(value: Any, index: int, at: Path, faults: list[Fault]) -> Drop | None:
    if not isinstance(value, str):
        selector = read_selector(value, at, "an entry of `drop`", faults=faults, beside=COUNT)
        if selector is None:
            return None
        expect, optional = read_count(value, at, faults, owner="an entry of `drop`")
        return Drop(None, selector, index, expect=expect, optional=optional)
    if value in GRAMMAR.root.children:
        if value not in _KEPT:
            return Drop(value, None, index)
        message = f"`{value}` cannot be left out of a model"
        faults.append(Fault("not-supported", message, at, help="name what in it is to be left out"))
        return None
    if paths_of(value):
        return Drop(None, Selector(value, EVERYTHING), index)
    help, fix = advised(value, known_tags())
    notes = (
        () if help else (Note("a section (`contact`), a tag (`light`) or a selector (`{geom: visual_*}`)"),)
    )
    faults.append(
        Fault(
            "unknown-element",
            f"MJCF has no section and no element `{value}`",
            at,
            notes=notes,
            help=help,
            fix=fix,
        )
    )
    return None

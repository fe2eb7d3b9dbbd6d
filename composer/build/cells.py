"""The cells of a recipe's matrix, built one after another: each source file is read once for all of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from composer import engine
from composer.build.samples import with_samples
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.document.node import Mapping, Node, Scalar, find
from composer.expand.matrix import Cell, cells
from composer.pipeline import Built, build
from composer.plan.read import read_recipe
from composer.steps.load import Library


def cells_of(recipe: Path, context: Context, given: dict[str, Node] | None = None) -> list[Cell]:
    """What `--all` builds, in order, all names and values checked; faults go to the context's sink and give none.

    These are the cells of the matrix, each with its samples where the recipe draws some.
    """
    path = context.folder / recipe
    node = read_recipe(path, context)
    if not isinstance(node, Mapping):
        return []
    named = find(node, ("name",))
    name = named.text if isinstance(named, Scalar) else path.stem
    return with_samples(node, cells(node, name, context.sink), name, given or {}, context.sink)


def picked(every: Sequence[Cell], names: Iterable[str], sink: Sink) -> list[Cell]:
    """The cells of these names."""
    by_name = {cell.name: cell for cell in every}
    found: list[Cell] = []
    for name in names:
        if name in by_name:
            found.append(by_name[name])
            continue
        sink.error(
            "unknown-name",
            f"the matrix has no cell `{name}`",
            notes=(exists_note("cell", by_name, name),),
            help=did_you_mean(name, by_name, "--pick {}"),
        )
    return found


def build_cells(
    recipe: Path,
    chosen: Iterable[Cell],
    context: Context,
    given: dict[str, Node],
    *,
    verified: bool,
    deduplicated: bool,
    session: engine.Session,
) -> Iterator[tuple[Cell, Context, Built | None]]:
    """Each cell with a context of its own, in which its faults are, and what came of it."""
    library: Library = {}
    for cell in chosen:
        own = replace(context, sink=Sink())
        values = {**given, **cell.given}
        built = build(
            recipe, own, given=values, name=cell.name, sample=cell.sample, verified=verified, deduplicated=deduplicated,
            session=session, library=library,
        )  # fmt: skip
        yield cell, own, built

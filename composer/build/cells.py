"""The cells of a recipe's matrix, built one after another: each source file is read once for all of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from composer import engine
from composer.build.made import Made
from composer.build.maker import Maker
from composer.build.samples import sample_name, with_samples
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.document.node import Node, Scalar, to_python
from composer.expand.matrix import Cell
from composer.plan.locked import use_lock
from composer.plan.matrix import read_matrix


def cells_of(recipe: Path, context: Context, given: dict[str, Node] | None = None) -> list[Cell]:
    """What `--all` builds, in order, all names and values checked; faults go to the context's sink and give none.

    These are the cells of the matrix, each with its samples where the recipe draws some.
    """
    if use_lock(recipe, context) is None:
        return []
    matrix = read_matrix(recipe, context, given)
    if matrix is None:
        return []
    return with_samples(matrix.document, matrix.cells, matrix.name, given or {}, context.sink)


def picked(every: Sequence[Cell], names: Iterable[str], sink: Sink) -> list[Cell]:
    """The cells of these names; that of a cell which is built as samples means all of them."""
    by_name = {cell.name: cell for cell in every}
    found: list[Cell] = []
    for name in names:
        if name in by_name:
            found.append(by_name[name])
            continue
        if samples := [each for each in every if each.name == sample_name(name, each.sample)]:
            found += samples
            continue
        sink.error(
            "unknown-name",
            f"the matrix has no cell `{name}`",
            notes=(exists_note("cell", by_name, name),),
            help=did_you_mean(name, by_name, "--pick {}"),
        )
    return found


def build_cells(
    maker: Maker, chosen: Iterable[Cell], context: Context, given: dict[str, Node], session: engine.Session
) -> Iterator[tuple[Cell, Context, Made | None]]:
    """Each cell with a context of its own, in which its faults are, and what came of it."""
    for cell in chosen:
        own = replace(context, sink=Sink())
        values = {f"`{name}`": _text(node) for name, node in cell.given.items()}
        question = maker.question(cell.name, {**values, "the sample": str(cell.sample)})
        made, why = maker.recall(question, own)
        if made is None:
            made = maker.make(own, session, {**given, **cell.given}, cell.name, cell.sample, question, why)
        yield cell, own, made


def _text(node: Node) -> str:
    return node.text if isinstance(node, Scalar) else json.dumps(to_python(node))

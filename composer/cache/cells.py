"""Select cells of a recipe's matrix, and samples of its draws."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from composer.cache.samples import with_samples
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.document.node import Node, Scalar, to_python
from composer.expand.matrix import Cell
from composer.plan.locked import use_lock
from composer.plan.matrix import read_matrix


def cells_of(recipe: Path, context: Context, given: dict[str, Node] | None = None) -> list[Cell]:
    """Return what `--all` builds, in order, with all names and values checked.

    These are the cells of the matrix, each with its samples if the recipe draws some. The result is empty after
    errors, which go to the sink.
    """
    if use_lock(recipe, context) is None:
        return []
    matrix = read_matrix(recipe, context, given)
    if matrix is None:
        return []
    return with_samples(context.folder / recipe, matrix, given or {}, context=context)


def picked(every: Sequence[Cell], picks: Iterable[str], sink: Sink, recipe: str) -> list[Cell]:
    """Return the picked cells, each once, in the order of the picks; a pick that matches nothing is an error.

    A pick is the name of a sample, of a cell (which selects all its samples), or `AXIS=VALUE[,AXIS=VALUE...]`: all
    cells with these values.
    """
    found: dict[str, Cell] = {}
    for pick in picks:
        chosen = [each for each in every if pick in (each.name, each.cell)] or _with_values(every, pick)
        found.update((each.name, each) for each in chosen)
        if not chosen:
            _report_none(every, pick, sink, recipe=recipe)
    return list(found.values())


def of_samples(cells: Iterable[Cell], samples: Iterable[int], sink: Sink) -> list[Cell]:
    """Return the cells that are one of these samples; a sample that does not exist is an error."""
    cells = list(cells)
    wanted = list(dict.fromkeys(samples))
    known = sorted({cell.sample for cell in cells if cell.is_sample})
    for sample in wanted:
        if cells and sample not in known:
            there = f"has the samples 0 to {known[-1]}" if known else "draws nothing"
            sink.error("unknown-name", f"sample {sample} does not exist: the recipe {there}")
    return [cell for cell in cells if cell.is_sample and cell.sample in wanted]


def picked_one(every: Sequence[Cell], pick: str, sample: int | None, sink: Sink, recipe: str) -> Cell | None:
    """Return the one picked cell; if it has samples, the nominal model or the given `sample`.

    Anything else is an error.
    """
    chosen = picked(every, [pick], sink, recipe=recipe)
    if sample is not None:
        chosen = of_samples(chosen, [sample], sink)
    if len({each.cell for each in chosen}) > 1:
        names = list(dict.fromkeys(each.cell or each.name for each in chosen))
        sink.error("selector", f"`--pick {pick}` chooses {len(names)} cells of `{recipe}`, and one is wanted",
                   notes=(exists_note("cell", names),), help="name one of them")  # fmt: skip
        return None
    return chosen[0] if chosen else None


def check_axes_are_free(chosen: Iterable[Cell], given: Iterable[str], sink: Sink, instead: str) -> None:
    """Report values that the user gives although a cell sets them; `instead` says what to do."""
    names = dict.fromkeys(name for cell in chosen for name in cell.given)
    for name in given:
        if name in names:
            sink.error("unknown-name", f"`{name}` is an axis of the matrix, whose cells set it",
                       help=f"do not set it, or {instead}")  # fmt: skip


def _with_values(every: Sequence[Cell], pick: str) -> list[Cell]:
    wanted = [item.partition("=") for item in pick.split(",")]
    if not all(equals for _, equals, _ in wanted):
        return []
    return [
        cell
        for cell in every
        if all(axis in cell.given and text_of(cell.given[axis]) == value for axis, _, value in wanted)
    ]


def _report_none(every: Sequence[Cell], pick: str, sink: Sink, recipe: str) -> None:
    axis, equals, value = pick.partition("=")
    values = list(dict.fromkeys(text_of(cell.given[axis]) for cell in every if axis in cell.given))
    if equals and values and "," not in value:
        sink.error("unknown-name", f"no cell of `{recipe}` has `{axis}` = `{value}`",
                   notes=(exists_note("value", values, value),),
                   help=did_you_mean(value, values, f"--pick {axis}={{}}"))  # fmt: skip
        return
    names = {each.name: each for each in every}
    sink.error("unknown-name", f"the matrix of `{recipe}` has no cell `{pick}`",
               notes=(exists_note("cell", names, pick),), help=did_you_mean(pick, names, "--pick {}"))  # fmt: skip


def text_of(node: Node) -> str:
    """Return a value in the syntax of a pick."""
    return node.text if isinstance(node, Scalar) else json.dumps(to_python(node))

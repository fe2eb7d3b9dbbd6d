"""`mjcompose plan`: the steps of a build, in words or as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.cells import ModelOptions
from mjcompose.cli.options import RECIPE_OR_STDIN
from mjcompose.cli.run import Answer, Run, command, flag

if TYPE_CHECKING:
    from mjcompose.build.plan.matrix import FilledValues
    from mjcompose.build.plan.plan import Plan, PlanPreview
    from mjcompose.language.expand import Cell


@dataclass(frozen=True, slots=True)
class Options(ModelOptions):
    recipe: Path = RECIPE_OR_STDIN
    expanded: bool = flag("--expanded", help="Print the concrete recipe, with the file and line of every value.")
    licenses: bool = flag("--licenses", help="Print only the license of every part.")


@command(Options)
def plan(options: Options, run: Run) -> Answer:
    """Print the steps of a build of RECIPE, and the cells of its matrix."""
    from mjcompose.build.cache.cells import cells_of
    from mjcompose.build.plan.describe import describe
    from mjcompose.build.plan.matrix import FilledValues, check_sample, filled_from_first_cell
    from mjcompose.build.plan.planner import make_plan
    from mjcompose.build.plan.read import expanded_text

    recipe, context = options.recipe, run.context
    given = options.choices.given(run)
    cell = options.cell.chosen(recipe, given, run=run, verb="plan")
    filled, cells = FilledValues(given), []
    if cell is not None:
        plan = make_plan(recipe, context, {**given, **cell.given}, name=cell.name, sample=cell.sample)
    else:
        sample = options.cell.sample or 0
        filled = filled_from_first_cell(recipe, context, given)
        plan = make_plan(recipe, context, filled.given, sample=sample)
        if plan is not None:
            check_sample(plan, sample, context.sink)
            cells = cells_of(recipe, context, given)
    planned = run.need(plan, recipe)
    if options.licenses:
        from mjcompose.build.bundle.licenses import license_rows, license_table

        rows = license_rows(planned, context)
        return Answer(lambda: license_table(rows), [asdict(row) for row in rows])
    if options.expanded:
        return Answer(lambda: expanded_text(planned))
    from mjcompose.build.compose.preview import preview_plan

    foreseen = preview_plan(planned, context)
    return Answer(
        lambda: "\n".join([describe(planned, foreseen), *_cell_lines(planned, filled, cells)]),
        lambda: _data(planned, foreseen, filled, cells=cells),
    )


def _data(plan: Plan, preview: PlanPreview | None, filled: FilledValues, cells: Sequence[Cell]) -> dict[str, Any]:
    from mjcompose.build.plan.describe import as_data

    data = as_data(plan, preview)
    if filled.cell is not None:
        data["as_cell"] = filled.cell
    if cells:
        data["cells"] = [{"name": cell.name, "set": cell.values(), "sample": cell.sample} for cell in cells]
    return data


def _cell_lines(plan: Plan, filled: FilledValues, cells: Sequence[Cell]) -> Iterator[str]:
    """Yield lines about the cells; those that differ only in draws share a line."""
    from mjcompose.text.expression_values import shown

    if filled.cell is not None:
        values = ", ".join(f"`{name}`" for name in filled.taken)
        yield f"  {values} as in the cell {filled.cell}: without a default, only the cells have a value"
    if cells:
        what = "models" if plan.randomize is not None else "cells of the matrix"
        yield f"{len(cells)} {what}, built by --all or --pick:"
    for _, same in groupby(cells, key=lambda cell: id(cell.given)):
        first, *others = same
        names = first.name
        if others:
            names += f" … {others[-1].name}, {first.name} without a draw"
        values = ", ".join(f"{name} = {shown(value)}" for name, value in first.values().items() if value is not None)
        yield f"  {names}  {values}".rstrip()

"""`mjcompose plan`: what a build will do, in words or as JSON."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base.report import printable
from mjcompose.cli.options import (
    Choices,
    cell_options,
    choice_options,
    chosen_cell,
    fetching,
    fetching_options,
    limit_option,
)
from mjcompose.cli.reporting import FINDINGS, USAGE, exit_code, report, reporting_options

if TYPE_CHECKING:
    from mjcompose.build.plan.matrix import FilledValues
    from mjcompose.build.plan.plan import Foreseen, Plan
    from mjcompose.language.expand import Cell
    from mjcompose.sources.context import Context


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@choice_options
@cell_options
@click.option(
    "--expanded", is_flag=True, help="Print the concrete recipe, with the file and line of every value."
)
@click.option("--licenses", is_flag=True, help="Print only the licence of every part.")
@fetching_options
@limit_option
@reporting_options
def command(
    recipe: Path,
    choices: Choices,
    pick: str | None,
    sample: int | None,
    expanded: bool,
    licenses: bool,
    form: str,
) -> None:
    """Print the steps of a build of RECIPE, and the cells of its matrix."""
    from mjcompose.build.cache.cells import cells_of
    from mjcompose.build.plan.describe import describe
    from mjcompose.build.plan.matrix import FilledValues, check_sample, filled_from_first_cell
    from mjcompose.build.plan.planner import make_plan
    from mjcompose.build.plan.read import expanded_text
    from mjcompose.sources.context import Context

    context = Context(fetching=fetching())
    given = choices.values(context)
    if context.sink.has_errors:
        report(context, form)
        sys.exit(USAGE)
    cell, code = (
        (None, 0)
        if pick is None
        else chosen_cell(recipe, pick, sample, given=given, context=context, verb="plan")
    )
    if code:
        report(context, form)
        sys.exit(code)
    filled, cells = FilledValues(given), []
    if cell is not None:
        plan = make_plan(recipe, context, {**given, **cell.given}, name=cell.name, sample=cell.sample)
    else:
        filled = filled_from_first_cell(recipe, context, given)
        plan = make_plan(recipe, context, filled.given, sample=sample or 0)
        if plan is not None:
            check_sample(plan, sample or 0, context.sink)
            cells = cells_of(recipe, context, given)
    foreseen = None
    if plan is not None and not (expanded or licenses):
        from mjcompose.build.compose.preview import foresee

        foreseen = foresee(plan, context)
    report(context, form)
    if plan is None:
        sys.exit(exit_code(context.folder, [recipe]))
    if licenses:
        _say_licences(plan, context, form)
    elif expanded:
        click.echo(expanded_text(plan))
    elif form == "json":
        click.echo(json.dumps(_data(plan, foreseen, filled, cells=cells), indent=2))
    else:
        click.echo(printable(describe(plan, foreseen), colors=True))
        _say_cells(plan, filled, cells)
    if context.sink.has_errors:
        sys.exit(FINDINGS)


def _data(
    plan: Plan, foreseen: Foreseen | None, filled: FilledValues, cells: Sequence[Cell]
) -> dict[str, Any]:
    """Return the plan as data, with the cells that are built separately."""
    from mjcompose.build.plan.describe import as_data

    data = as_data(plan, foreseen)
    if filled.cell is not None:
        data["as_cell"] = filled.cell
    if cells:
        data["cells"] = [{"name": cell.name, "set": cell.values(), "sample": cell.sample} for cell in cells]
    return data


def _say_cells(plan: Plan, filled: FilledValues, cells: Sequence[Cell]) -> None:
    """Print the cells; those that differ only in draws share a line."""
    from mjcompose.text.expression_values import shown

    if filled.cell is not None:
        values = ", ".join(f"`{name}`" for name in filled.taken)
        click.echo(f"  {values} as in the cell {filled.cell}: without a default, only the cells have a value")
    if cells:
        what = "models" if plan.randomize is not None else "cells of the matrix"
        click.echo(f"{len(cells)} {what}, built by --all or --pick:")
    for _, group in groupby(cells, key=lambda cell: id(cell.given)):
        first, *others = group
        names = first.name
        if others:
            names += f" … {others[-1].name}, {first.name} without a draw"
        values = ", ".join(
            f"{name} = {shown(value)}" for name, value in first.values().items() if value is not None
        )
        click.echo(f"  {names}  {values}".rstrip())


def _say_licences(plan: Plan, context: Context, form: str) -> None:
    from mjcompose.build.bundle.licences import licence_rows, licence_table

    rows = licence_rows(plan, context)
    click.echo(json.dumps([asdict(row) for row in rows], indent=2) if form == "json" else licence_table(rows))

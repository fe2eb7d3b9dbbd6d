"""`mjcompose tree`: the parts, bodies and joints of a model, and the places for attaching parts."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from mjcompose.base.report import printable
from mjcompose.cli import completing
from mjcompose.cli.options import (
    Choices,
    cell_options,
    choice_options,
    chosen_cell,
    fetching,
    fetching_options,
    limit_option,
)
from mjcompose.cli.reporting import USAGE, clear_progress, exit_code, report, reporting_options, use_color


@click.command()
@click.argument("model", shell_complete=completing.files)
@click.option(
    "--places", is_flag=True, help="List the places where a part can be attached, as written in a recipe."
)
@click.option("--depth", type=click.IntRange(min=1), metavar="N", help="Show only N levels of bodies.")
@choice_options
@cell_options
@fetching_options
@limit_option
@reporting_options
def command(
    model: str,
    places: bool,
    depth: int | None,
    choices: Choices,
    pick: str | None,
    sample: int | None,
    form: str,
) -> None:
    """Show the parts, bodies and joints of MODEL: a recipe, a bundle, a model file, or a reference to one.

    Poses are in the reference configuration. Joint ranges are in degrees and metres, in JSON in radians and metres.
    """
    from mjcompose.sources.context import Context
    from mjcompose.tools.outline import as_data, outline, render, render_places

    context = Context(fetching=fetching())
    given = choices.values(context)
    if context.sink.has_errors:
        report(context, form)
        sys.exit(USAGE)
    is_recipe = Path(model).suffix.lower() in (".yaml", ".yml")
    if pick is not None:
        if not is_recipe:
            raise click.UsageError(f"{model} is not a recipe and has no cells: leave --pick out")
        cell, code = chosen_cell(Path(model), pick, sample, given=given, context=context, verb="show")
        if cell is None:
            report(context, form)
            sys.exit(code)
        given, sample = {**given, **cell.given}, cell.sample
    found = outline(model, context, given, sample=sample or 0)
    if found is None or not is_recipe:  # `check` and `build` report warnings of a recipe
        report(context, form)
    if found is None:
        sys.exit(exit_code(context.folder, [Path(model)]))
    clear_progress()
    color = use_color(out=True)
    if form == "json":
        click.echo(json.dumps(as_data(found, depth), indent=2))
    else:
        words = (render_places if places else render)(found, depth, color)
        click.echo(printable(words, colors=True), color=color)

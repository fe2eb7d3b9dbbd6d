"""`mjcompose explain`: where an element or an attribute of a model came from, and what changed it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from composer.cli import completing
from composer.cli.choices import Choices, choice_options
from composer.cli.explain_code import check_model, say_codes, say_page
from composer.cli.fetching import fetching, fetching_options
from composer.cli.limits import limit_option
from composer.cli.matrix import cell_options, chosen_cell
from composer.cli.reporting import (
    FINDINGS,
    USAGE,
    clear_progress,
    exit_code,
    report,
    reporting_options,
    source_reader,
    use_color,
)
from composer.diagnostics.text import printable


@click.command()
@click.argument(
    "model",
    metavar="MODEL|CODE",
    type=click.Path(path_type=Path),
    required=False,
    shell_complete=completing.models_and_codes,
)
@click.argument("query", required=False, shell_complete=completing.elements)
@click.argument("attribute", required=False, shell_complete=completing.attributes)
@click.option("--codes", is_flag=True, help="List all error codes.")
@choice_options
@cell_options
@fetching_options
@limit_option
@reporting_options
def command(
    model: Path | None,
    query: str | None,
    attribute: str | None,
    codes: bool,
    choices: Choices,
    pick: str | None,
    sample: int | None,
    form: str,
) -> None:
    """Show where an element or attribute of MODEL, a recipe or an MJCF file, came from and what changed it.

    With only an error CODE such as `bare-angle`, print what the error means and how to fix it.

    \b
    QUERY selects the element or attribute:
      'geom gripper/pad'            a kind and a name; the name alone if it is unique
      'geom gripper/pad friction'   one attribute: its value and every default class that may set it
      'geom gripper/**'             all elements that match the glob; a kind alone selects all of that kind
      'geom#3'                      an element without a name, by its index in MuJoCo
      'option timestep'             a setting
      'gripper.xml:12'              the element on that line
    """  # noqa: D301  (a backspace, by which click keeps the lines)
    if codes or model is None or query is None:
        _explain_code(model, codes, form)
        return
    check_model(model)
    from composer.context import Context
    from composer.explain.explain import explain
    from composer.explain.explanation import as_data
    from composer.explain.query import read
    from composer.explain.text import render

    context = Context(fetching=fetching())
    asked = read(query, attribute, context.sink)
    if asked is None:
        report(context, form)
        sys.exit(USAGE)
    given = choices.values(context)
    if context.sink.has_errors:
        report(context, form)
        sys.exit(USAGE)
    if pick is not None:
        if model.suffix.lower() == ".xml":
            raise click.UsageError(f"{model} is not a recipe and has no cells: leave --pick out")
        cell, code = chosen_cell(model, pick, sample, given=given, context=context, verb="explain")
        if cell is None:
            report(context, form)
            sys.exit(code)
        given, sample = {**given, **cell.given}, cell.sample
    explained = explain(model, asked, context, sample=sample or 0, given=given)
    if explained is None or context.sink.has_errors:  # `check` and `build` report warnings
        report(context, form)
    if explained is None:
        sys.exit(exit_code(context.folder, [model]))
    clear_progress()
    if form == "json":
        click.echo(json.dumps(as_data(explained), indent=2))
    else:
        color = use_color(out=True)
        words = render(explained, source_reader(context.folder), color)
        click.echo(printable(words, colors=True), color=color)
    sys.exit(FINDINGS if context.sink.has_errors else 0)


def _explain_code(asked: Path | None, codes: bool, form: str) -> None:
    if codes:
        say_codes(form)
    elif asked is None:
        raise click.UsageError("Missing argument 'MODEL|CODE'.")
    else:
        say_page(asked, form)

"""`mjcompose explain`: an element, an attribute or a code."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

import click

from mjcompose.base.codes import CODES, address, code_of, in_terminal, page
from mjcompose.base.report import printable
from mjcompose.base.suggest import closest
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
from mjcompose.cli.reporting import (
    FINDINGS,
    USAGE,
    clear_progress,
    exit_code,
    report,
    reporting_options,
    source_reader,
    use_color,
)


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
    from mjcompose.sources.context import Context
    from mjcompose.tools.explain.explain import explain
    from mjcompose.tools.explain.explanation import as_data, render
    from mjcompose.tools.explain.query import read

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


_WIDEST = 100


def say_page(asked: Path, form: str) -> None:
    """Print the page of a code. Raises UsageError if it is not a code."""
    code = code_of(str(asked))
    if code is None:
        raise click.UsageError(_no_code(asked))
    text, url = page(code), address(code)
    if form == "json":
        data = {"explains": "code", "code": code, "summary": CODES[code], "page": text, "url": url}
        click.echo(json.dumps(data, indent=2, ensure_ascii=False))
        return
    color = use_color(out=True)
    width = min(shutil.get_terminal_size((_WIDEST, 24)).columns, _WIDEST)
    click.echo(in_terminal(text, width, color), color=color)
    if url is not None:
        click.echo(f"\n{url}")


def say_codes(form: str) -> None:
    """Print every code with its summary."""
    if form == "json":
        click.echo(json.dumps(CODES, indent=2))
        return
    width = max(map(len, CODES))
    for code, summary in CODES.items():
        click.echo(f"{code:{width}}  {summary}")


def check_model(model: Path) -> None:
    """Raise UsageError for a code in place of a model: no other arguments apply to a code."""
    if code_of(str(model)) is not None and not os.path.exists(model):
        raise click.UsageError(
            f"`{model}` is a code, not a model. Write `mjcompose explain {code_of(str(model))}` alone."
        )


def _no_code(asked: Path) -> str:
    if os.path.exists(asked) or asked.suffix or len(asked.parts) > 1:
        return (
            "Missing argument 'QUERY'. Say which element:"
            f" `mjcompose explain {asked} 'joint NAME'`. `mjcompose tree {asked}` lists them."
        )
    near = closest(str(asked), CODES)
    help = f"Did you mean `{near[0]}`?" if near else "`mjcompose explain --codes` lists them."
    return f"`{asked}` is neither a code nor a file that exists. {help}"

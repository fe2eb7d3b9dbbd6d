"""`mjcompose ls`: list the models that `build --all` wrote to a folder, with their values."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path

import click

from mjcompose.build.bundle.bundle import is_address
from mjcompose.build.bundle.listing import COLUMNS
from mjcompose.cli.reporting import FINDINGS, USAGE, format_options, quiet_option, report, say
from mjcompose.text.expression_values import Value, shown


@click.command()
@click.argument("folder", type=click.Path())
@click.option("--where", metavar="EXPRESSION", help="List only the models for which this is true: an expression of the"
              " columns of models.csv, such as `payload > 2 and nv == 15`.")  # fmt: skip
@quiet_option
@format_options(("text", "json"))
def command(folder: str, where: str | None, form: str) -> None:
    """List the models that `build --all` wrote to FOLDER.

    FOLDER is a folder with the index of the models, or the file of an index; either may be a URL. Each line has the
    path of a model, and its values from the matrix and from draws. JSON has all columns of the index.
    """
    from mjcompose.build.bundle.listing import Condition, ListingError, rows
    from mjcompose.sources.context import Context

    context = Context()
    condition = None
    try:
        condition = Condition(where or "true")
        for row in rows(folder if is_address(folder) else Path(folder), folder):
            if condition.holds(row):
                path = row.file if isinstance(row.file, str) else context.shown(row.file)
                click.echo(_json(path, row.values) if form == "json" else _line(path, row.values))
        condition.check()
    except ListingError as error:
        context.sink.add(error.diagnostic)
    report(context, form)
    for name, count in (
        condition.lacking.items() if condition is not None and not context.sink.has_errors else ()
    ):
        say(f"{count} models have no `{name}`, and are not listed", err=True)
    sys.exit(_code(folder, condition is None) if context.sink.has_errors else 0)


def _code(folder: str, no_condition: bool) -> int:
    """Return the exit code of a run with errors."""
    is_there = is_address(folder) or os.path.exists(folder)
    return USAGE if no_condition or not is_there else FINDINGS


def _line(path: str, values: Mapping[str, Value]) -> str:
    own = (f"{name}={shown(value)}" for name, value in values.items() if name not in COLUMNS)
    return " ".join((path, *own))


def _json(path: str, values: Mapping[str, Value]) -> str:
    return json.dumps({**values, "path": path}, ensure_ascii=False)

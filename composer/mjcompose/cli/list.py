"""`mjcompose list`: list the models that `build --all` wrote to a folder, with their values."""

from __future__ import annotations

import json
import os
from pathlib import Path

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.build.bundle.bundle import is_address
from mjcompose.build.bundle.listing import COLUMNS
from mjcompose.cli.options import ReportOptions
from mjcompose.cli.reporting import FINDINGS, USAGE, say
from mjcompose.cli.run import Run, argument, command, group, option
from mjcompose.text.expression_values import shown


@dataclass(frozen=True, slots=True)
class Options:
    folder: str = argument(type=click.Path())
    where: str | None = option(
        "--where", metavar="EXPRESSION",
        help="List only the models for which this is true: an expression of the columns of models.csv, such as"
        " `payload > 2 and nv == 15`.",
    )  # fmt: skip
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def list(options: Options, run: Run) -> int:
    """List the models that `build --all` wrote to FOLDER.

    FOLDER is a folder with the index of the models, or the file of an index; either may be a URL. Each line has the
    path of a model, and its values from the matrix and from draws. JSON has all columns of the index.
    """
    from mjcompose.build.bundle.listing import Condition, ListingError, rows

    context, folder, condition = run.context, options.folder, None
    try:
        condition = Condition(options.where or "true")
        for row in rows(folder if is_address(folder) else Path(folder), folder):
            if condition.holds(row):
                path = row.file if isinstance(row.file, str) else context.shown(row.file)
                own = (f"{name}={shown(value)}" for name, value in row.values.items() if name not in COLUMNS)
                data = {**row.values, "path": path}
                click.echo(json.dumps(data, ensure_ascii=False) if run.form == "json" else " ".join((path, *own)))
        condition.check()
    except ListingError as error:
        context.sink.add(error.diagnostic)
        is_there = is_address(folder) or os.path.exists(folder)
        return USAGE if condition is None or not is_there else FINDINGS
    run.report()
    for name, count in condition.lacking.items():
        say(f"{count} models have no `{name}`, and are not listed", err=True)
    return 0

"""`mjcompose update`: lock the current state of sources."""

from __future__ import annotations

from pathlib import Path

import click

from mjcompose.cli.locking import write_lock
from mjcompose.cli.options import Choices, choice_options, limit_option
from mjcompose.cli.reporting import reporting_options


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@click.argument("names", metavar="[NAME]...", nargs=-1)
@choice_options
@limit_option
@reporting_options
def command(
    recipe: Path,
    names: tuple[str, ...],
    choices: Choices,
    form: str,
) -> None:
    """Lock the current state of the sources of RECIPE: the newest commits of branches, and archives as served now.

    NAME is the prefix of a part, `base`, or a source as named in the lock. Without NAME, all sources are updated.
    """
    write_lock(recipe, names, form, choices=choices)

"""`mjcompose update`: lock the current state of sources."""

from __future__ import annotations

from pathlib import Path

import click

from composer.cli.choices import Choices, choice_options
from composer.cli.limits import limit_option
from composer.cli.locking import write_lock
from composer.cli.reporting import reporting_options


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
    """Lock the sources of RECIPE as they are now: branches where they have moved to, archives as they are served.

    NAME is a part's prefix, `base`, or a source as the lock names it; without one all sources are updated.
    """
    write_lock(recipe, names, form, choices)

"""`mjcompose lock`: record the sources of a recipe in a file next to it."""

from __future__ import annotations

from pathlib import Path

import click

from composer.cli.choices import Choices, choice_options
from composer.cli.fetching import fetching_options
from composer.cli.limits import limit_option
from composer.cli.locking import write_lock
from composer.cli.reporting import reporting_options


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@choice_options
@fetching_options
@limit_option
@reporting_options
def command(
    recipe: Path,
    choices: Choices,
    form: str,
) -> None:
    """Lock the sources of RECIPE: commits, hashes and licences go to a file beside it, ARM.lock for ARM.yaml.

    What is locked already stays as it is; new sources are added, files of your own are hashed again, and what is
    no longer used is taken out.
    """
    write_lock(recipe, None, form, choices)

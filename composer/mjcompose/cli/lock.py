"""`mjcompose lock`: record the sources of a recipe in a file next to it."""

from __future__ import annotations

from pathlib import Path

import click

from mjcompose.cli.locking import write_lock
from mjcompose.cli.options import Choices, choice_options, fetching_options, limit_option
from mjcompose.cli.reporting import reporting_options


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
    """Lock the sources of RECIPE: write their commits, hashes and licences to a file next to it.

    The lock of ARM.yaml is ARM.lock. Sources that are already locked keep their entries. New sources are added, your
    own files are hashed again, and sources that are no longer used are removed.
    """
    write_lock(recipe, None, form, choices=choices)

"""`mjcompose version`: the same as `--version`."""

from __future__ import annotations

import click

from composer.version import __version__


@click.command()
def command() -> None:
    """Print the version; `mjcompose doctor` prints those of all that it needs."""
    click.echo(f"mjcompose, version {__version__}")

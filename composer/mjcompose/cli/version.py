"""`mjcompose version`: the same as `--version`."""

from __future__ import annotations

import click

from mjcompose.base.version import __version__


@click.command()
def command() -> None:
    """Print the version. `mjcompose doctor` prints the versions of all dependencies."""
    click.echo(f"mjcompose, version {__version__}")

"""`mjcompose completion SHELL`: print the line that enables completion."""

from __future__ import annotations

import click

_LINES = {
    "bash": 'eval "$(_MJCOMPOSE_COMPLETE=bash_source mjcompose)"',
    "zsh": 'eval "$(_MJCOMPOSE_COMPLETE=zsh_source mjcompose)"',
    "fish": "_MJCOMPOSE_COMPLETE=fish_source mjcompose | source",
}


@click.command()
@click.argument("shell", type=click.Choice(tuple(_LINES)))
def command(shell: str) -> None:
    """Print the line that enables completion of commands, options, cells and names; put it in SHELL's start file."""
    click.echo(_LINES[shell])

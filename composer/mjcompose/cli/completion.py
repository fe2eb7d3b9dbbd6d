"""`mjcompose completion SHELL`: print the line that enables completion."""

from __future__ import annotations

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.run import Answer, Run, argument, command

_LINES = {
    "bash": 'eval "$(_MJCOMPOSE_COMPLETE=bash_source mjcompose)"',
    "zsh": 'eval "$(_MJCOMPOSE_COMPLETE=zsh_source mjcompose)"',
    "fish": "_MJCOMPOSE_COMPLETE=fish_source mjcompose | source",
}


@dataclass(frozen=True, slots=True)
class Options:
    """The options of `completion`."""

    shell: str = argument(type=click.Choice(tuple(_LINES)))


@command(Options)
def completion(options: Options, run: Run) -> Answer:
    """Print the line that enables completion of commands, options, cells and names; put it in SHELL's start file."""
    return Answer(_LINES[options.shell])

"""`mjcompose help [COMMAND]`: the same as `mjcompose COMMAND --help`."""

from __future__ import annotations

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli import completion
from mjcompose.cli.run import Answer, Run, argument, command


@dataclass(frozen=True, slots=True)
class Options:
    names: tuple[str, ...] = argument(metavar="[COMMAND]...", nargs=-1, shell_complete=completion.commands)


@command(Options)
def help(options: Options, run: Run) -> Answer:
    """Print the help of COMMAND, or the list of commands."""
    context = click.get_current_context()
    about = context.find_root()
    for name in options.names:
        group = about.command
        if not isinstance(group, click.Group):
            raise click.UsageError(f"`{group.name}` has no commands of its own", context)
        found, command, _ = group.resolve_command(about, [name])
        assert command is not None
        about = click.Context(command, info_name=found, parent=about)
    return Answer(about.get_help())

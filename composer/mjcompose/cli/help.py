"""`mjcompose help [COMMAND]`: the same as `mjcompose COMMAND --help`."""

from __future__ import annotations

import click

from mjcompose.cli import completing


@click.command()
@click.argument("names", metavar="[COMMAND]...", nargs=-1, shell_complete=completing.commands)
@click.pass_context
def command(ctx: click.Context, names: tuple[str, ...]) -> None:
    """Print the help of COMMAND, or the list of commands."""
    about = ctx.find_root()
    for name in names:
        group = about.command
        if not isinstance(group, click.Group):
            raise click.UsageError(f"`{group.name}` has no commands of its own", ctx)
        found, command, _ = group.resolve_command(about, [name])
        assert command is not None
        about = click.Context(command, info_name=found, parent=about)
    click.echo(about.get_help())

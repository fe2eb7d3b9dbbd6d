"""The command: verbs are imported when they are called, so that `--help` costs nothing."""

from __future__ import annotations

import importlib

import click

from composer.version import __version__

_VERBS = {
    "build": "Build the model of a recipe: one MJCF file and its assets.",
    "check": "Say whether a recipe is right, without writing anything.",
    "plan": "Print in words what a build will do.",
    "new": "Write a commented starter recipe that builds.",
    "schema": "Print the JSON Schema of recipes, for editors.",
}


class _Verbs(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _VERBS:
            return None
        module = importlib.import_module(f"composer.cli.{cmd_name}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(_VERBS.items()))


@click.command(cls=_Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="mjcompose")
def main() -> None:
    """Compose MuJoCo models from recipes."""

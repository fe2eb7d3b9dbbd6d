"""The command: verbs are imported when they are called, so that `--help` costs nothing."""

from __future__ import annotations

import importlib
import io
import keyword
import os
import sys
from typing import Any

import click

from composer.version import __version__

_VERBS = {
    "build": "Build the model of a recipe: one MJCF file and its assets.",
    "check": "Say whether a recipe is right, without writing anything.",
    "verify": "Hold a bundle against its manifest, MuJoCo and the sources of its parts.",
    "plan": "Print in words what a build will do.",
    "explain": "Say where an element or attribute came from, and what changed it.",
    "lock": "Write down what every source of a recipe is.",
    "update": "Lock sources as they are now.",
    "cache": "Look after the store of what was fetched and built.",
    "diff": "Say what differs between two models, in physics terms.",
    "new": "Write a commented starter recipe that builds.",
    "fmt": "Put recipes into their canonical layout, comments kept.",
    "import": "Propose the recipe that makes a merged model of its parts.",
    "doctor": "Say what this installation is and can do.",
    "schema": "Print the JSON Schema of recipes, for editors.",
}


# Pydantic would look for plugins in every package that is installed, which takes longer than a small build.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")

_FAILED, _INTERRUPTED, _BUG = 1, 130, 70


class _Verbs(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(_VERBS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _VERBS:
            return None
        room = f"{cmd_name}_" if keyword.iskeyword(cmd_name) else cmd_name
        module = importlib.import_module(f"composer.cli.{room}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.meta["composer.arguments"] = list(args)  # to be said again where a run is interrupted
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        verb = args[0]
        if verb not in _VERBS and not verb.startswith("-"):
            from composer.diagnostics.suggest import closest

            near = closest(verb, _VERBS)
            if verb.endswith((".yaml", ".yml")):
                help = f" Write `mjcompose build {verb}`."
            else:
                help = f" Did you mean `{near[0]}`?" if near else ""
            raise click.UsageError(f"There is no command `{verb}`.{help}", ctx)
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the verb. An interruption ends it in order: what was begun is taken away again, and no trace is shown."""
        _print_any_name()
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            click.echo("interrupted: nothing was written", err=True)
            ctx.exit(_INTERRUPTED)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except BrokenPipeError:
            raise  # the reader of the output has gone, which click takes care of
        except OSError as error:
            what = f"`{error.filename}`: " if error.filename else ""
            click.echo(f"cannot go on: {what}{(error.strerror or str(error)).lower()}", err=True)
            ctx.exit(_FAILED)
        except UnicodeEncodeError as error:
            if error.encoding.startswith("utf"):
                self._bug(ctx, error)
            what = error.object[error.start : error.end].encode("ascii", "backslashreplace").decode()
            click.echo(
                f"cannot go on: {what} cannot be part of a file's name here; set PYTHONUTF8=1", err=True
            )
            ctx.exit(_FAILED)
        except Exception as error:
            self._bug(ctx, error)

    def _bug(self, ctx: click.Context, error: Exception) -> None:
        if os.environ.get("MJCOMPOSE_TRACEBACK"):
            raise error
        click.echo(_bug(error), err=True)
        ctx.exit(_BUG)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(_VERBS.items()))


def _print_any_name() -> None:
    """Standard output takes what standard error takes: names of files that are no text in this locale."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        utf8 = sys.stdout.encoding.lower().replace("-", "") == "utf8"
        sys.stdout.reconfigure(errors="surrogateescape" if utf8 else "backslashreplace")


def _bug(error: Exception) -> str:
    """The last resort: what to tell of an exception that nobody foresaw."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    where = "" if trace is None else f" in {trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}"
    said = " ".join(str(error).split())
    return (
        f"this is a bug in mjcompose: {type(error).__name__}{where}: {said}\n"
        "please report it; with MJCOMPOSE_TRACEBACK=1 the whole trace is shown"
    )


@click.command(cls=_Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="mjcompose")
def main() -> None:
    """Compose MuJoCo models from recipes."""

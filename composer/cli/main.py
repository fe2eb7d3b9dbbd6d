"""The command: verbs are imported when they are called, so that `--help` costs nothing."""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
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
    "diff": "Say what differs between two models, in physics terms.",
    "new": "Write a commented starter recipe that builds.",
    "schema": "Print the JSON Schema of recipes, for editors.",
}


_FAILED, _INTERRUPTED, _TERMINATED, _BUG = 1, 130, 143, 70


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
        with contextlib.suppress(ValueError):  # not in the main thread, where signals do not arrive
            signal.signal(signal.SIGTERM, _terminate)
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
        except Exception as error:
            if os.environ.get("MJCOMPOSE_TRACEBACK"):
                raise
            click.echo(_bug(error), err=True)
            ctx.exit(_BUG)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(_VERBS.items()))


def _terminate(signum: int, frame: object) -> None:
    sys.exit(_TERMINATED)


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

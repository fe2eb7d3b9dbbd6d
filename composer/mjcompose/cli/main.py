"""The command. It imports a verb only to run it, which keeps `--help` fast."""

from __future__ import annotations

import errno
import importlib
import io
import keyword
import os
import sys
from typing import Any, TypeVar

import click

from mjcompose.base import __version__, files
from mjcompose.cli.entry import ran_out, requested_exit_code

_GROUPS = {
    "Build": {
        "build": "Build the model of a recipe: one MJCF file and its assets.",
        "check": "Check recipes, their models and the checks in them. Write nothing.",
        "lint": "Find mistakes in models, recipes and bundles that MuJoCo accepts.",
        "plan": "Print the steps of a build.",
        "list": "List the models that `build --all` wrote, or those that match an expression.",
        "rebuild": "Build the model that a data set records again, to the byte.",
        "verify": "Compare a bundle with its manifest, and its parts with their sources.",
    },
    "Look": {
        "tree": "Show the parts, bodies and joints of a model, and where you can attach a part.",
        "explain": "Show where an element or attribute came from and what changed it, or explain an error code.",
        "diff": "Show the differences between two models, in physics terms.",
        "names": "Write names, addresses, units and ranges of a model as Python, C++ or JSON.",
        "view": "Show a model in the browser, or write it as a page.",
        "render": "Make a picture or a film of a model.",
    },
    "Change": {
        "new": "Write a commented starter recipe that builds.",
        "fix": "Apply the exact fixes that error messages suggest.",
        "fmt": "Format recipes in the canonical layout, and keep comments.",
        "import": "Propose a recipe that builds a merged model from its parts.",
        "identify": "Fit the numbers of a recipe to recordings of a robot.",
        "migrate": "Rewrite a model for another version of MuJoCo.",
        "upgrade": "Show how a model moves differently in another version of MuJoCo.",
    },
    "Sources": {
        "lock": "Pin every source of a recipe in a lock file, or upgrade the sources in it.",
        "cache": "Inspect, prune or verify the store of fetched sources and built models.",
    },
    "Set up": {
        "doctor": "Check this installation, and show its features.",
        "install": "Install another version of MuJoCo, for `upgrade` and the check `moves_alike`.",
        "uninstall": "Remove a version of MuJoCo that `install` has installed.",
        "plugin": "Let MuJoCo open recipes in C++ programs, Studio and ROS 2 control.",
        "lsp": "Run the language server for editors, with completion, errors and origins.",
        "mcp": "Serve tools to AI agents, over the Model Context Protocol.",
        "schema": "Print the JSON Schema of recipes, manifests or JSON messages.",
        "completion": "Print the line that enables completion in a shell.",
        "help": "Print the help of a command.",
        "version": "Print the version.",
    },
}
_VERBS = {name: words for group in _GROUPS.values() for name, words in group.items()}
# Modules with several commands; the module of any other command has its name.
_MODULES = {
    **dict.fromkeys(("doctor", "help", "schema", "version"), "about"),
    **dict.fromkeys(("list", "rebuild", "verify"), "bundles"),
    **dict.fromkeys(("install", "uninstall"), "programs"),
    **dict.fromkeys(("lsp", "mcp", "plugin"), "servers"),
    **dict.fromkeys(("cache", "lock"), "sources"),
    **dict.fromkeys(("fix", "lint"), "fmt"),
    **dict.fromkeys(("diff", "names", "tree"), "explain"),
    "import": "new",
    "plan": "check",
    "render": "view",
    "upgrade": "migrate",
}

# Names of verbs in other tools, and the corresponding command here.
_CALLED = {
    **dict.fromkeys(("init", "create", "start"), "mjcompose new"),
    **dict.fromkeys(("validate", "test"), "mjcompose check"),
    "format": "mjcompose fmt",
    **dict.fromkeys(("compile", "make", "compose", "generate"), "mjcompose build"),
    **dict.fromkeys(("merge", "attach", "combine"), "mjcompose build RECIPE"),
    "export": "mjcompose build --target NAME",
    **dict.fromkeys(("show", "describe", "bodies", "info"), "mjcompose tree"),
    "ls": "mjcompose list",
    **dict.fromkeys(("inspect", "where", "why"), "mjcompose explain RECIPE NAME"),
    **dict.fromkeys(("compare",), "mjcompose diff"),
    **dict.fromkeys(("picture", "image", "screenshot", "video"), "mjcompose render"),
    **dict.fromkeys(("language-server", "server"), "mjcompose lsp"),
    **dict.fromkeys(("open", "viewer", "preview", "serve", "run"), "mjcompose view"),
    "convert": "mjcompose import",
    "clean": "mjcompose cache prune",
    **dict.fromkeys(("update", "upgrade"), "mjcompose lock --upgrade"),
    "port": "mjcompose migrate",
}

# Options of other tools, and the corresponding option here.
_OPTIONS_CALLED = {
    **dict.fromkeys(("--json", "--markdown", "--github", "--format"), "--output-format"),
    "--no-verify": "--no-compile",
    "--samples": "--sample-table",
    "--variant": "--set",
    "--param": "--set",
}


# Pydantic would look for plugins in every installed package, which takes longer than a small build.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
# No matrix here is large enough for threads of linear algebra, whose buffers alone are 30 MiB for each core.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

_FAILED = 1
_INTERRUPTED = 130
_BUG = 70

if "_MJCOMPOSE_COMPLETE" in os.environ:
    from mjcompose.cli import completion

    completion.install()


_E = TypeVar("_E", bound=click.ClickException)


class _Verbs(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        from mjcompose.base.extensions import names

        return [*_VERBS, *(name for name in names("commands") if name not in _VERBS)]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in _VERBS:
            return _extension(ctx, cmd_name)
        room = f"{cmd_name}_" if keyword.iskeyword(cmd_name) else cmd_name
        command = getattr(importlib.import_module(f"mjcompose.cli.{_MODULES.get(cmd_name, room)}"), room)
        assert isinstance(command, click.Command)
        return command

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.meta["mjcompose.arguments"] = list(args)  # to be repeated if a run is interrupted
        return super().parse_args(ctx, args)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        verb = args[0]
        if verb not in _VERBS and not verb.startswith("-") and not _is_extension(verb):
            from mjcompose.cli.options import did_you_mean

            if verb in _CALLED:
                help = f" Write `{_CALLED[verb]}`."
            elif verb.endswith(files.RECIPES):
                help = f" Write `mjcompose build {verb}`."
            else:
                help = did_you_mean(verb, _VERBS)
            raise click.UsageError(f"The command `{verb}` does not exist.{help}", ctx)
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the verb. After an interruption it removes unfinished output, and shows no traceback."""
        _print_any_name()
        try:
            with files.run():
                return super().invoke(ctx)
        except KeyboardInterrupt:
            _say_aside("interrupted: nothing was written")
            ctx.exit(_INTERRUPTED)
        except click.NoSuchOption as error:
            raise _on_one_line(_with_hint(error)) from None
        except click.ClickException as error:
            raise _on_one_line(error) from None
        except (click.exceptions.Exit, click.Abort, BrokenPipeError, MemoryError):
            raise  # Click handles most; memory is released before the entry point reports its lack
        except SystemError as error:
            if ran_out():
                raise MemoryError from error
            raise
        except OSError as error:
            if error.errno == errno.ENOMEM:
                raise MemoryError from error
            what = f"`{error.filename}`: " if error.filename else ""
            _say_aside(f"cannot continue: {what}{(error.strerror or str(error)).lower()}")
            ctx.exit(_FAILED)
        except UnicodeEncodeError as error:
            if error.encoding.startswith("utf"):
                self._bug(ctx, error)
            what = error.object[error.start : error.end].encode("ascii", "backslashreplace").decode()
            _say_aside(f"cannot continue: {what} cannot be part of a file's name here; set PYTHONUTF8=1")
            ctx.exit(_FAILED)
        except Exception as error:
            # Pydantic 2.14 replaces any exception that ends it by its own.
            code = requested_exit_code()
            if code is not None:
                ctx.exit(code)
            if _is_reported(error):
                ctx.exit(_FAILED)
            self._bug(ctx, error)

    def _bug(self, ctx: click.Context, error: Exception) -> None:
        if os.environ.get("MJCOMPOSE_TRACEBACK"):
            raise error
        _say_aside(_bug(error))
        ctx.exit(_BUG)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, _VERBS))
        for heading, verbs in _GROUPS.items():
            with formatter.section(heading):
                formatter.write_dl([(f"{name:{width}}", words) for name, words in verbs.items()])
        from mjcompose.base.extensions import names

        more = [(name, f"A command of {owner}.") for name, owner in names("commands").items() if name not in _VERBS]
        if more:
            with formatter.section("Commands of other packages"):
                formatter.write_dl(more)


def _is_extension(verb: str) -> bool:
    from mjcompose.base.extensions import is_registered

    return is_registered("commands", verb)


def _extension(ctx: click.Context, name: str) -> click.Command | None:
    if not _is_extension(name):
        return None
    from mjcompose.base.diagnostic import DiagnosticError
    from mjcompose.base.extensions import ExtensionTable
    from mjcompose.cli.reporting import report_as_chosen
    from mjcompose.sources.context import Context

    try:
        return ExtensionTable[click.Command]("commands", {}, "", kind=click.Command)[name]
    except DiagnosticError as error:
        context = Context()
        context.sink.add(error.diagnostic)
        report_as_chosen(context)
        ctx.exit(_FAILED)


def _is_reported(error: Exception) -> bool:
    """Report the errors found so far if the exception says that there are too many; return whether it does."""
    from mjcompose.base.sink import TooManyFaults
    from mjcompose.cli.reporting import report_as_chosen
    from mjcompose.sources.context import Context

    if not isinstance(error, TooManyFaults):
        return False
    report_as_chosen(Context(sink=error.sink))
    return True


def _say_aside(words: str) -> None:
    """Print to standard error, instead of a progress line."""
    from mjcompose.base.report import printable
    from mjcompose.cli.reporting import clear_progress

    clear_progress()
    click.echo(printable(words), err=True)


def _on_one_line(error: _E) -> _E:
    """Return the error with a message that fits on one line, whatever the name in it; Click prints it."""
    from mjcompose.base.report import one_line, printable

    error.message = printable(one_line(error.message))  # type: ignore[misc]  # Click only says that it is final
    return error


def _with_hint(error: click.NoSuchOption) -> click.NoSuchOption:
    """Return the error with the probable options. Click itself only suggests similar spellings."""
    from mjcompose.base.suggest import closest

    if error.ctx is None:
        return error
    name = error.option_name
    known = {each for option in error.ctx.command.get_params(error.ctx) for each in option.opts}
    called = _OPTIONS_CALLED.get(name)
    if called in known:
        return click.NoSuchOption(name, f"No such option '{name}'. Did you mean '{called}'?", ctx=error.ctx)
    return click.NoSuchOption(name, possibilities=closest(name, known), ctx=error.ctx)


def _print_any_name() -> None:
    """Let standard output accept file names that are not valid text in this locale, as standard error does."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        utf8 = sys.stdout.encoding.lower().replace("-", "") == "utf8"
        sys.stdout.reconfigure(errors="surrogateescape" if utf8 else "backslashreplace")


def _bug(error: Exception) -> str:
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    where = "" if trace is None else f" in {trace.tb_frame.f_code.co_filename}:{trace.tb_lineno}"
    message = " ".join(str(error).split())
    return (
        f"this is a bug in mjcompose: {type(error).__name__}{where}: {message}\n"
        "please report it; with MJCOMPOSE_TRACEBACK=1 the whole trace is shown"
    )


@click.command(
    cls=_Verbs,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    help="""Compose MuJoCo models from recipes.

    Exit codes: 0 success, 1 there are errors in the files, 2 the command is wrong or names a file that does not
    exist.
    """,
)
@click.version_option(__version__, "-V", "--version", prog_name="mjcompose")
def main() -> None:
    pass

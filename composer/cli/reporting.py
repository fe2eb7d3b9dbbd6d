"""What a command says: diagnostics and results, to the terminal, a JSON reader or GitHub; and its exit codes."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any

import click

from composer.context import Context
from composer.diagnostics import github, json_format, text

FINDINGS, USAGE, INTERRUPTED = 1, 2, 130
ARGUMENTS = "composer.arguments"
_QUIET, _JSON, _STANDING = "composer.quiet", "composer.json", "composer.standing"
_FORMATS = ("text", "json", "github")


def reporting_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--format`, `--json` and `--quiet`; the command gets the first as `form`, for the last see `say`."""
    return format_options(_FORMATS)(quiet_option(command))


def format_options(formats: Iterable[str]) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """`--format` with these values, and `--json`, which is short for `--format json`; the command gets `form`."""

    def note(ctx: click.Context, parameter: click.Parameter, given: bool) -> None:
        ctx.meta[_JSON] = given

    def form(ctx: click.Context, parameter: click.Parameter, given: str) -> str:
        return "json" if ctx.meta.get(_JSON) else given

    def options(command: Callable[..., Any]) -> Callable[..., Any]:
        command = click.option("--json", is_flag=True, expose_value=False, is_eager=True, callback=note,
                               help="The same as --format json.")(command)  # fmt: skip
        return click.option("--format", "form", type=click.Choice(tuple(formats)), default="text",
                            show_default=True, callback=form, help="How the output is printed.")(command)  # fmt: skip

    return options


def quiet_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--quiet`, which is not an argument of the command: `say` and `progress` know."""

    def note(ctx: click.Context, parameter: click.Parameter, given: bool) -> None:
        ctx.meta[_QUIET] = given

    return click.option("-q", "--quiet", is_flag=True, expose_value=False, callback=note,
                        help="Print only what is wrong.")(command)  # fmt: skip


def exit_code(folder: Path, named: Iterable[Path]) -> int:
    """The code of a command that failed: of its usage where a file that it was given does not exist."""
    return FINDINGS if all((folder / each).exists() for each in named) else USAGE


def say(words: str, *, err: bool = False, form: str = "text") -> None:
    """Print a result. A quiet command says nothing to people of what went well; programs still get their JSON."""
    if form != "json" and is_quiet():
        return
    clear_progress()
    click.echo(words, err=err)


def is_quiet() -> bool:
    return bool(_meta().get(_QUIET))


def report(context: Context, form: str, *, err: bool = False) -> None:
    """Print all diagnostics: text to standard error, JSON and GitHub commands to standard output.

    With `err` these go to standard error too, for a command that has a model to print.
    """
    clear_progress()
    if told := _told(context, form):
        click.echo(told, nl=False, err=err or form == "text", color=use_color())


def _told(context: Context, form: str) -> str:
    found = context.sink.sorted()
    if not found:
        return ""
    if form == "json":
        return "".join(f"{json_format.render(each)}\n" for each in found)
    if form == "github":
        return "".join(f"{github.render(each)}\n" for each in found)
    color, read = use_color(), source_reader(context.folder)
    told = "".join(f"{text.render(each, read, color)}\n\n" for each in found)
    return f"{told}{text.summary(found)}\n"


def use_color(*, out: bool = False) -> bool:
    """Colours only on a terminal that has them, and never where NO_COLOR is set.

    `out` asks for standard output, where answers go; messages go to standard error.
    """
    terminal = sys.stdout is not None and sys.stdout.isatty() if out else on_terminal()
    return terminal and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def progress(message: str) -> None:
    """A line on standard error while something takes long; only on a terminal, where the next output replaces it."""
    if not on_terminal() or is_quiet():
        return
    if os.environ.get("TERM") == "dumb":
        click.echo(message, err=True)
        return
    clear_progress()
    width = shutil.get_terminal_size().columns - 1
    click.echo(message[:width], err=True, nl=False)
    _meta()[_STANDING] = True


def clear_progress() -> None:
    """Remove the line of `progress`, if one stands."""
    if _meta().pop(_STANDING, False):
        click.echo("\r\x1b[K", err=True, nl=False)


def _meta() -> dict[str, Any]:
    """What the command that runs remembers; nothing outside of one."""
    context = click.get_current_context(silent=True)
    return {} if context is None else context.meta


def arguments() -> list[str]:
    """What the command that runs was given, its verb first."""
    given = click.get_current_context().meta.get(ARGUMENTS, [])
    return [str(each) for each in given]


def on_terminal() -> bool:
    """Whether a person reads standard error; it may be closed altogether."""
    return sys.stderr is not None and sys.stderr.isatty()


def source_reader(folder: Path) -> text.ReadSource:
    """The text of a file that messages name, read once; None where it cannot be read."""

    @lru_cache(maxsize=32)
    def read(file: str) -> str | None:
        try:
            return (folder / file).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return None

    return read

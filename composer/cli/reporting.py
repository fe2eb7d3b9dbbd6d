"""Diagnostics to the terminal, a JSON reader or GitHub, and the exit code that says how it went."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import click

from composer.context import Context
from composer.diagnostics import github, json_format, text

FINDINGS, USAGE, INTERRUPTED = 1, 2, 130
ARGUMENTS = "composer.arguments"
_FORMATS = ("text", "json", "github")


def reporting_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """`--format` for diagnostics; `--json` is short for `--format json`."""
    command = click.option("--json", "as_json", is_flag=True, help="The same as --format json.")(command)
    return click.option(
        "--format", "form", type=click.Choice(_FORMATS), default="text", show_default=True,
        help="How diagnostics are printed.",
    )(command)  # fmt: skip


def report(context: Context, form: str, *, err: bool = False) -> None:
    """Print all diagnostics: text to standard error, JSON and GitHub commands to standard output.

    With `err` these go to standard error too, for a command that has a model to print.
    """
    if told := _told(context, form):
        click.echo(told, nl=False, err=err or form == "text", color=use_color())


def told_by_report(context: Context, form: str) -> list[tuple[bool, str]]:
    """What `report` prints, and whether to standard error."""
    told = _told(context, form)
    return [(form == "text", told)] if told else []


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
    """A line on standard error while something takes long; only on a terminal."""
    if on_terminal():
        click.echo(message, err=True)


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

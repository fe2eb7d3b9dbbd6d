"""`mjcompose fix`: apply the exact fixes of messages."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.base.report import counted
from mjcompose.cli.fmt import difference, rewrite, show_differences
from mjcompose.cli.options import RECIPE, RecipeOptions
from mjcompose.cli.reporting import FINDINGS, on_terminal, say
from mjcompose.cli.run import Run, command, flag, option

if TYPE_CHECKING:
    from mjcompose.sources.context import Context
    from mjcompose.tools.fix import Fixed


@dataclass(frozen=True, slots=True)
class Options(RecipeOptions):
    recipe: Path = RECIPE
    write: bool | None = option(
        "--write/--diff", default=None, help="Write the changes without asking, or only show them."
    )
    yes: bool = flag("-y", "--yes", help="The same as --write.")


@command(Options)
def fix(options: Options, run: Run) -> int:
    """Apply the exact fixes of error messages to RECIPE: misspelled names and keys, quotes, units, numbers.

    The changes are shown first. On a terminal, the command asks before it writes; elsewhere it writes only with
    --write. Comments and layout are kept. Errors that need a decision are reported as by `check`.

    Exit codes: 0 no errors are left, 1 fixes are not written or errors need a decision, 2 wrong usage.
    """
    from mjcompose.tools.fix import fix

    context = run.context
    found = fix(options.recipe, context, options.choices.given(run))
    for diagnostic in found.left:
        context.sink.add(diagnostic)
    writes = True if options.yes else options.write
    if run.form != "json":
        show_differences(found.files, context, done="fixed")
        if writes is None and found.files and is_asked():
            writes = click.confirm(f"write {_amount(found)}?", err=True)
    done = [rewrite(path, after, context) for path, (_, after) in found.files.items()] if writes else [False]
    written = all(done)
    if run.form == "json":
        _say_data(found, context, written=written)
    elif found.files:
        say(f"{'fixed' if written else 'can fix'} {_amount(found)}{'' if written else '; --write does it'}")
    elif not context.sink.has_errors:
        say("nothing to fix")
    if not written:
        run.texts = {context.shown(path): text for path, (_, text) in found.files.items()}
    if context.sink.has_errors:
        return run.code_of_failure(options.recipe)
    return FINDINGS if found.files and not written else 0


def is_asked() -> bool:
    """Return whether there is a person who can answer."""
    return sys.stdin is not None and sys.stdin.isatty() and on_terminal()


def _say_data(found: Fixed, context: Context, *, written: bool) -> None:
    for path, (before, after) in found.files.items():
        shown = context.shown(path)
        answer = {"file": shown, "written": written, "diff": difference(before, after, shown, done="fixed")}
        click.echo(json.dumps(answer))
    fixed = [{"code": each.code, "message": each.message} for each in found.fixed]
    click.echo(json.dumps({"fixed": fixed, "left": len(found.left)}))


def _amount(found: Fixed) -> str:
    return f"{counted(len(found.fixed), 'fault')} in {counted(len(found.files), 'file')}"

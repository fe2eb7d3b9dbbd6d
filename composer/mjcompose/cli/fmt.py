"""`fmt` and `fix`: format recipes and MJCF files, and apply the exact fixes of messages."""

from __future__ import annotations

import difflib
import json
import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base import report as github
from mjcompose.base.access import door_of_user
from mjcompose.base.files import MJCF_FILES, RECIPES, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.report import Paint, counted, printable
from mjcompose.cli.options import RECIPE, RecipeOptions, ReportOptions
from mjcompose.cli.reporting import FINDINGS, on_terminal, say, use_color
from mjcompose.cli.run import Group, Run, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.sources.context import Context
    from mjcompose.tools.fix import Fixed


STDIN = "-"


class FmtOptions(Group):
    files: tuple[str, ...] = argument(nargs=-1, required=True)
    reporting: ReportOptions = group(ReportOptions)
    check: bool = flag("--check", help="Write nothing. Print the changes, and exit with 1 if there are any.")


@command(FmtOptions)
def fmt(options: FmtOptions, run: Run) -> int:
    """Format each of FILES in the canonical layout: recipes, MJCF models, and both in folders.

    `-` formats standard input to standard output. Comments and blank lines are kept, and so is the text of values in
    models. Before a file is written, its values are read again and compared.
    """
    from mjcompose.text.layout import format_recipe
    from mjcompose.tree.xml_layout import format_mjcf

    context, check = run.context, options.check
    files = [file for given in options.files for file in _inside(given, context)]
    differing, unchanged = 0, 0
    for file in files:
        is_model = file.lower().endswith(MJCF_FILES)
        source = _read(file, context, in_force().xml_size if is_model or file == STDIN else in_force().recipe_size)
        shown = "<stdin>" if file == STDIN else context.shown(Path(file))
        if source is None:
            continue
        is_model = is_model or source.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<")
        result = (format_mjcf if is_model else format_recipe)(source, shown, context.sink)
        if result is None:
            continue
        differing += result != source
        unchanged += result == source
        if file == STDIN and not check:
            if sys.stdout is None:
                raise OSError("standard output is closed")
            sys.stdout.buffer.write(result)
        elif result != source and check:
            _report(shown, difference(source, result, shown, done="formatted"), run.form)
        elif result != source and rewrite(Path(file), result, context, before=source):
            _report(shown, None, run.form)
    if unchanged and run.form == "text" and STDIN not in files:
        say(f"{counted(unchanged, 'file')} left unchanged")
    run.report()
    if check and differing:
        click.echo(f"{differing} of {len(files)} would change", err=True)
    if context.sink.has_errors:
        return run.code_of_failure(*(Path(each) for each in files if each != STDIN))
    return FINDINGS if check and differing else 0


def _inside(given: str, context: Context) -> list[str]:
    """Return the recipes and MJCF files in a folder, in the order of their names; the file itself if it is a file."""
    from mjcompose.tree.xml_text import kind_of

    if given == STDIN or not os.path.isdir(given):
        return [given]
    found = []
    for folder, below, names in os.walk(given):
        below[:] = sorted(each for each in below if not each.startswith((".", "__")))
        for path in (Path(folder, name) for name in sorted(names) if name.lower().endswith((*RECIPES, *MJCF_FILES))):
            text = (_read(str(path), context, in_force().xml_size) or b"").decode("utf-8", "replace")
            found += [str(path)] if kind_of(path, text) else []
    if not found:
        context.sink.error("file-not-found", f"`{given}` has no recipe and no MJCF file")
    return found


def _report(file: str, difference: str | None, form: str) -> None:
    if form == "json":
        what = {"formatted": file} if difference is None else {"would_format": file, "diff": difference}
        click.echo(json.dumps(what))
    elif difference is None:
        say(f"formatted {file}")
    elif form == "github":
        click.echo(github.command("error", f"`mjcompose fmt` would change {file}", {"file": file}))
    else:
        click.echo(printable(difference, colors=True), nl=False)


def _read(file: str, context: Context, most: int) -> bytes | None:
    if file == STDIN and sys.stdin is None:
        context.sink.error("file-unreadable", "standard input is closed")
        return None
    if file == STDIN:
        return sys.stdin.buffer.read(most + 1)
    try:
        return read_regular(file, most)
    except OSError as error:
        code = "file-not-found" if isinstance(error, FileNotFoundError) else "file-unreadable"
        reason = (error.strerror or str(error)).lower()
        context.sink.error(code, f"`{file}` cannot be read: {reason}")
        return None


def rewrite(
    recipe: Path, result: bytes, context: Context, option: str | None = None, *, before: bytes | None = None
) -> bool:
    """Replace the file in one step and keep its permissions; return whether that succeeded.

    If the text of the file is no longer `before`, the file stays unchanged.
    """
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.build.bundle.staging import ChangedError, replace_text

    if not (door := door_of_user()).sees(context.folder / recipe):
        door.outside(str(recipe)).report(context.sink, None, shown=context.shown)
        return False
    try:
        replace_text(recipe, result, option, before=before)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return False
    except ChangedError:
        message = f"`{context.shown(recipe)}` has changed since it was read, so it is not written"
        context.sink.error("output-unwritable", message, help="run the command again")
        return False
    return True


def show_differences(files: Mapping[Path, tuple[bytes, bytes]], context: Context, done: str) -> None:
    """Print the difference of each file, in color on a terminal."""
    color = use_color(out=True)
    paint = Paint(color)
    for path, (before, after) in files.items():
        for line in difference(before, after, context.shown(path), done=done).splitlines():
            style = {"+": "added", "-": "removed", "@": "gutter"}.get(line[:1])
            click.echo(printable(paint(style, line) if style else line, colors=True), color=color)


def difference(source: bytes, result: bytes, shown: str, done: str) -> str:
    """Return a unified diff of two texts of a file; `done` describes the second one."""
    before, after = (each.decode("utf-8").splitlines(keepends=True) for each in (source, result))
    lines = difflib.unified_diff(before, after, shown, f"{shown} ({done})")
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)


class FixOptions(RecipeOptions):
    recipe: Path = RECIPE
    write: bool | None = option(
        "--write/--diff", default=None, help="Write the changes without asking, or only show them."
    )
    yes: bool = flag("-y", "--yes", help="The same as --write.")


@command(FixOptions)
def fix(options: FixOptions, run: Run) -> int:
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
    done = (
        [rewrite(path, after, context, before=before) for path, (before, after) in found.files.items()]
        if writes
        else [False]
    )
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

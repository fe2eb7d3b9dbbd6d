"""The output of a command, its progress, and its exit codes."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import click

from mjcompose.base import report as text
from mjcompose.base.diagnostic import Diagnostic, Severity
from mjcompose.base.files import MESH_FILES, STDIN, read_regular
from mjcompose.base.report import Case, Suite, one_line, printable, report as junit_text
from mjcompose.bundle.staging import staged_file
from mjcompose.sources.context import Context

_READ = "mjcompose.read"
_WRITTEN = "mjcompose.written"


def note_files(files: Iterable[str | Path]) -> None:
    context = click.get_current_context(silent=True)
    if context is not None:
        context.meta.setdefault(_READ, set()).update(map(Path, files))


def noted_files() -> set[Path]:
    return set(click.get_current_context().meta.get(_READ, ()))


def note_output(target: str) -> None:
    context = click.get_current_context(silent=True)
    if context is not None:
        context.meta.setdefault(_WRITTEN, {})[target] = None


def noted_outputs() -> tuple[str, ...]:
    return tuple(click.get_current_context().meta.get(_WRITTEN, ()))


FINDINGS = 1
USAGE = 2
INTERRUPTED = 130
ARGUMENTS = "mjcompose.arguments"
FORM = "mjcompose.form"
_LINE = "mjcompose.progress_line"


def say_details(context: Context, files: Iterable[str] = ()) -> None:
    """With `--verbose`, print the duration of each stage and the files that were read to standard error."""
    if not _given("verbose"):
        return
    clear_progress()
    seconds: dict[str, float] = {}
    for stage, took in context.timings:
        seconds[stage] = seconds.get(stage, 0) + took
    if not seconds:
        click.echo("  nothing was built: the cache has it", err=True)
    for stage, took in seconds.items():
        click.echo(f"  {stage:8} {took:7.3f} s", err=True)
    for file in sorted(files):
        click.echo(f"  read {printable(one_line(file))}", err=True)


def exit_code(folder: Path, named: Iterable[Path]) -> int:
    """Return the exit code of a failed command: a usage error if one of its files does not exist."""
    return FINDINGS if all(str(each) == STDIN or os.path.exists(folder / each) for each in named) else USAGE


def say(words: str, *, err: bool = False, form: str = "text", is_escaped: bool = False) -> None:
    """Print a result. With `--quiet`, text about success is omitted, but not JSON for programs.

    Text is made printable, unless it `is_escaped` already, as a command for GitHub is.
    """
    if form != "json" and is_quiet():
        return
    clear_progress()
    click.echo(words if form == "json" or is_escaped else printable(words, colors=True), err=err)


def is_quiet() -> bool:
    return _given("quiet")


DOCUMENTS = ("junit", "sarif")
"""The formats that are one document, which is printed even without diagnostics."""


def report(context: Context, form: str, *, err: bool = False, texts: Mapping[str, bytes] | None = None) -> None:
    """Print all diagnostics: text to standard error, other formats to standard output.

    With `err`, all of them go to standard error, for a command that prints a model. `texts` are new contents of files,
    by their names in messages.
    """
    clear_progress()
    if _given("watch"):
        from mjcompose.tools.view.builder import hopes

        note_files(hopes(context))
    shown = rendered(context.sink.sorted(), form, source_reader(context.folder, texts))
    if shown:
        click.echo(shown, nl=False, err=err or form == "text", color=use_color())


def report_as_chosen(context: Context) -> None:
    """Print all diagnostics in the chosen format, for code that does not know the command."""
    report(context, str(_meta().get(FORM, "text")))


def words_of(context: Context) -> str:
    """Return all diagnostics as a terminal shows them, without colors."""
    found = context.sink.sorted()
    read = source_reader(context.folder)
    return "".join(f"{text.render(each, read, False)}\n\n" for each in found) + text.summary(found)


def rendered(found: Sequence[Diagnostic], form: str, read: text.ReadSource, suites: Sequence[Suite] = ()) -> str:
    """Return diagnostics in a format. JUnit has the `suites`, or one case for the whole command."""
    if form == "junit":
        verb = click.get_current_context().info_name or "mjcompose"
        errors = [each for each in found if each.severity is Severity.ERROR]
        return junit_text(suites or [Suite(verb, [Case(verb, "command", errors)])], read)
    if form == "sarif":
        from mjcompose.base.report_data import render_sarif

        return f"{render_sarif([_exact(each, read) for each in found])}\n"
    if not found:
        return ""
    if form == "json":
        return "".join(f"{text.render_json_format(_exact(each, read))}\n" for each in found)
    if form in ("github", "markdown"):
        render = text.render_github if form == "github" else text.render_markdown
        return "".join(f"{render(each)}\n" for each in found)
    color = use_color()
    shown = "".join(f"{text.render(each, read, color)}\n\n" for each in found)
    more = _more_about([_exact(each, read) for each in found]) if on_terminal() else ""
    return f"{shown}{text.summary(found)}\n{more}"


def _exact(diagnostic: Diagnostic, read: text.ReadSource) -> Diagnostic:
    if diagnostic.fix is None:
        return diagnostic
    from mjcompose.tools.fix import exact, place_of

    place = place_of(diagnostic)
    return exact(diagnostic, (read(place.file) if place is not None else None) or "")


def _more_about(found: Sequence[Diagnostic]) -> str:
    codes = list(dict.fromkeys(each.code for each in found))
    code = codes[0] if len(codes) == 1 else "CODE"
    fixable = sum(each.fix is not None for each in found)
    fixes = f"; `mjcompose fix` can fix {fixable} of them" if fixable else ""
    return f"more about {'it' if len(codes) == 1 else 'each'}: mjcompose explain {code}{fixes}\n"


def use_color(*, out: bool = False) -> bool:
    """Return whether standard error, or with `out` standard output, shows colors; it respects NO_COLOR and TERM."""
    terminal = sys.stdout is not None and sys.stdout.isatty() if out else on_terminal()
    return terminal and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def progress(message: str) -> None:
    """Show a line on standard error during long work; only on a terminal, where the next output replaces it."""
    if not on_terminal() or is_quiet():
        return
    message = printable(one_line(message))
    if os.environ.get("TERM") == "dumb":
        click.echo(message, err=True)
        return
    clear_progress()
    click.echo(message[: shutil.get_terminal_size().columns - 1], err=True, nl=False)
    _meta()[_LINE] = True


def clear_progress() -> None:
    """Remove the line of `progress`, if there is one."""
    if _meta().pop(_LINE, False):
        click.echo("\r\x1b[K", err=True, nl=False)


def _meta() -> dict[str, Any]:
    context = click.get_current_context(silent=True)
    return {} if context is None else context.meta


def _given(name: str) -> bool:
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.params.get(name))


def progress_of_command() -> Callable[[str], None]:
    """Return `progress` for other threads, which lack Click's context."""
    context = click.get_current_context()

    def show(message: str) -> None:
        with context.scope(cleanup=False):
            progress(message)

    return show


def arguments() -> list[str]:
    """Return the arguments of the current command, its verb first."""
    return [str(each) for each in click.get_current_context().meta.get(ARGUMENTS, [])]


def on_terminal() -> bool:
    """Return whether standard error is a terminal; it may be closed."""
    return sys.stderr is not None and sys.stderr.isatty()


def _text_of(path: Path) -> str:
    return read_regular(path).decode("utf-8", "replace")


def source_reader(folder: Path, texts: Mapping[str, bytes] | None = None) -> text.ReadSource:
    """Return a function for the text of a file that messages name, read once; None if it is unreadable.

    No line of a mesh is worth showing: a place in it is the whole mesh.
    """

    @lru_cache(maxsize=32)
    def read(file: str) -> str | None:
        if texts and file in texts:
            return texts[file].decode("utf-8", errors="replace")
        if file.lower().endswith(MESH_FILES):
            return None
        try:
            return _text_of(folder / file)
        except OSError:
            return None

    return read


def write_junit(suites: Sequence[Suite], out: str, context: Context) -> None:
    """Write the file completely. Report an error to the context."""
    text = junit_text(suites, source_reader(context.folder))
    if out == "-":
        click.echo(text, nl=False)
        return

    with context.sink, staged_file(context.folder / out, "--junit") as stage:
        stage.write_text(text, encoding="utf-8")

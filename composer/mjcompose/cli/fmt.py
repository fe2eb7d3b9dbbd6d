"""`fmt`, `fix` and `lint`: the layout of recipes and models, the exact fixes of messages, and mistakes in models."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base import report as github
from mjcompose.base.access import ALL, Door, door_of_user, door_of_walk
from mjcompose.base.alignment import unified_diff
from mjcompose.base.diagnostic import Diagnostic, Severity
from mjcompose.base.files import CODE, MJCF_FILES, RECIPES, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.report import Paint, as_lines, json_text, printable
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import ChangedError, replace_text
from mjcompose.cli.options import RECIPE, FetchOptions, RecipeOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import FINDINGS, on_terminal, progress, say, use_color
from mjcompose.cli.run import PATH, Answer, Group, Run, argument, command, flag, group, option
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.lint.rule import Rule
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.fix import Fixed
    from mjcompose.tools.lint import Linted, LintFile


STDIN = "-"


class FmtOptions(Group):
    files: tuple[str, ...] = argument(nargs=-1, required=True)
    reporting: ReportOptions = group(ReportOptions)
    check: bool = flag("--check", help="Write nothing. Print the changes, and exit with 1 if there are any.")


@command(
    FmtOptions,
    help="""Format each of FILES in the canonical layout: recipes, MJCF models, and both in folders.

    `-` formats standard input to standard output. Comments and blank lines are kept, and so is the text of values in
    models. Before a file is written, its values are read again and compared.
    """,
)
def fmt(options: FmtOptions, run: Run) -> int:
    context = run.context
    check = options.check
    files = {file: door for name in options.files for file, door in _inside(name, context)}
    differing = 0
    unchanged = 0
    for file, door in files.items():
        texts = _formatted(file, context)
        if texts is None:
            continue
        source, result = texts
        differing += result != source
        unchanged += result == source
        if file == STDIN and not check:
            _write_to_stdout(result)
        elif result != source:
            _write_or_show(file, source, result, door, run, check=check)
    if unchanged and run.form == "text" and STDIN not in files:
        say(f"{counted(unchanged, 'file')} left unchanged")
    run.report()
    if check and differing:
        click.echo(f"{differing} of {len(files)} would change", err=True)
    if context.sink.has_errors:
        return run.code_of_failure(*(Path(file) for file in files if file != STDIN))
    return FINDINGS if check and differing else 0


def _formatted(file: str, context: Context) -> tuple[bytes, bytes] | None:
    """Return the text of a file before and after formatting, or None after reported errors."""
    from mjcompose.text.layout import format_recipe
    from mjcompose.tree.xml_layout import format_mjcf

    is_model = file.lower().endswith(MJCF_FILES)
    source = _read(file, context, in_force().xml_size if is_model or file == STDIN else in_force().recipe_size)
    if source is None:
        return None
    is_model = is_model or source.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<")
    result = (format_mjcf if is_model else format_recipe)(source, _shown(file, context), context.sink)
    return None if result is None else (source, result)


def _write_or_show(file: str, source: bytes, result: bytes, door: Door, run: Run, *, check: bool) -> None:
    shown = _shown(file, run.context)
    if check:
        _report(shown, difference(source, result, shown, done="formatted"), run.form)
    elif rewrite(Path(file), result, run.context, before=source, within=door):
        _report(shown, None, run.form)


def _shown(file: str, context: Context) -> str:
    return "<stdin>" if file == STDIN else context.shown(Path(file))


def _write_to_stdout(text: bytes) -> None:
    if sys.stdout is None:
        raise OSError("standard output is closed")
    sys.stdout.buffer.write(text)


def _inside(given: str, context: Context) -> list[tuple[str, Door]]:
    """Return the recipes and MJCF files in a folder, in the order of their names; the file itself if it is a file.

    Each has the door through which it may be written. A link that leads out of the folder is skipped with a note, and a
    file with several names in the folder appears once.
    """
    from mjcompose.tree.xml_text import kind_of

    if given == STDIN or not os.path.isdir(given):
        return [(given, ALL)]
    door = door_of_walk(given)
    found: dict[str, str] = {}
    for folder, below, names in os.walk(given):
        below[:] = sorted(each for each in below if not each.startswith((".", "__")))
        for path in (Path(folder, name) for name in sorted(names) if name.lower().endswith((*RECIPES, *MJCF_FILES))):
            if not door.sees(path):
                note_outside(path, door, context)
                continue
            text = (_read(str(path), context, in_force().xml_size) or b"").decode("utf-8", "replace")
            if kind_of(path, text):
                found.setdefault(os.path.realpath(path), str(path))
    if not found:
        context.sink.error("file-not-found", f"`{given}` has no recipe and no MJCF file")
    return [(path, door) for path in found.values()]


def note_outside(path: Path, door: Door, context: Context) -> None:
    """Say that a file stays as it is, because only its own folder may be changed."""
    refused = door.outside(str(path))
    help = f"to change it, name it: `{context.shown(Path(refused.real or path))}`"
    message = f"{refused.message(context.shown)}: it is not changed"
    context.sink.add(Diagnostic(CODE, message, severity=Severity.NOTE, help=help))


def _report(file: str, difference: str | None, form: str) -> None:
    if form == "json":
        what = {"formatted": file} if difference is None else {"would_format": file, "diff": difference}
        click.echo(json_text(what))
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
    recipe: Path,
    result: bytes,
    context: Context,
    option: str | None = None,
    *,
    before: bytes | None = None,
    within: Door = ALL,
) -> bool:
    """Replace the file in one step and keep its permissions; return whether that succeeded.

    If the text of the file is no longer `before`, or if it is not `within` a door, the file stays unchanged.
    """
    door = door_of_user()
    if not door.sees(context.folder / recipe):
        door.outside(str(recipe)).report(context.sink, None, shown=context.shown)
        return False
    try:
        replace_text(recipe, result, option, before=before, within=within)
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
    lines = unified_diff(before, after, shown, f"{shown} ({done})")
    return "".join(line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines)


class FixOptions(RecipeOptions):
    recipe: Path = RECIPE
    write: bool | None = option(
        "--write/--diff", default=None, help="Write the changes without asking, or only show them."
    )
    yes: bool = flag("-y", "--yes", help="The same as --write.")


@command(
    FixOptions,
    help="""Apply the exact fixes of error messages to RECIPE: misspelled names and keys, quotes, units, numbers.

    Each fix is first tried in every cell of the matrix and every variant. A fix that does not remove its fault from
    all of them, or changes something else, is not made. No fix replaces a template `${…}`.

    The changes are shown first. On a terminal, the command asks before it writes; elsewhere it writes only with
    --write. Comments and layout are kept. Errors that need a decision are reported as by `check`.

    Exit codes: 0 no errors are left, 1 fixes are not written or errors need a decision, 2 wrong usage.
    """,
)
def fix(options: FixOptions, run: Run) -> int:
    from mjcompose.tools.fix import fix

    context = run.context
    found = fix(options.recipe, context, options.choices.given(run))
    context.sink.extend(found.left)
    for path in found.outside:
        note_outside(path, found.door, context)
    if run.form != "json":
        show_differences(found.files, context, done="fixed")
    written = _may_write(options, found, run.form) and _rewrite_all(found, found.door, context)
    if run.form == "json":
        _say_data(found, context, written=written)
    else:
        _say_fixed(found, context, written=written)
    if not written:
        run.texts = {context.shown(path): text for path, (_, text) in found.files.items()}
    if context.sink.has_errors:
        return run.code_of_failure(options.recipe)
    return FINDINGS if found.files and not written else 0


def _may_write(options: FixOptions, found: Fixed, form: str) -> bool:
    """Return whether the options allow to write the fixes, or the user does."""
    if options.yes:
        return True
    if options.write is not None:
        return options.write
    if form == "json" or not found.files or not is_asked():
        return False
    return click.confirm(f"write {_amount(found)}?", err=True)


def _rewrite_all(fixed: Fixed, door: Door, context: Context) -> bool:
    """Write all files that it can; return whether it wrote each of them."""
    texts = fixed.files.items()
    written = [rewrite(path, after, context, before=before, within=door) for path, (before, after) in texts]
    return all(written)


def _say_fixed(found: Fixed, context: Context, *, written: bool) -> None:
    if found.files:
        say(f"{'fixed' if written else 'can fix'} {_amount(found)}{'' if written else '; --write does it'}")
    elif not context.sink.has_errors:
        say("nothing to fix")


def is_asked() -> bool:
    return sys.stdin is not None and sys.stdin.isatty() and on_terminal()


def _say_data(found: Fixed, context: Context, *, written: bool) -> None:
    for path, (before, after) in found.files.items():
        shown = context.shown(path)
        answer = {"file": shown, "written": written, "diff": difference(before, after, shown, done="fixed")}
        click.echo(json_text(answer))
    fixed = [{"code": each.code, "message": each.message} for each in found.fixed]
    click.echo(json_text({"fixed": fixed, "left": len(found.left)}))


def _amount(found: Fixed) -> str:
    return f"{counted(len(found.fixed), 'fault')} in {counted(len(found.files), 'file')}"


_PROFILES = ("menagerie", "robot-asset")


class LintOptions(Group):
    files: tuple[Path, ...] = argument(metavar="FILES...", type=PATH, nargs=-1)
    select: tuple[str, ...] = option(
        "--select",
        multiple=True,
        metavar="RULE",
        help="Run only this rule or family of rules, or `all`. Separate several with commas, or repeat the option.",
    )
    ignore: tuple[str, ...] = option("--ignore", multiple=True, metavar="RULE", help="Do not run this rule or family.")
    profile: str | None = option(
        "--profile",
        type=click.Choice(_PROFILES),
        help="Run the rules of a standard for models, and print a table of them.",
    )
    fix: bool = flag("--fix", help="Change the files: apply the exact fixes of findings.")
    rules: bool = flag("--rules", help="List all rules, and stop.")
    statistics: bool = flag("--statistics", help="Print the number of findings of each rule instead of the findings.")
    jobs: int | None = option(
        "-j",
        "--jobs",
        metavar="NUMBER",
        type=click.IntRange(min=1),
        help="The number of processes. Default: one for each core.",
    )
    limits: TimeOptions = group(TimeOptions)
    fetching: FetchOptions = group(FetchOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    LintOptions,
    help="""Find mistakes in FILES that MuJoCo accepts: MJCF, URDF, recipes, bundles, and folders with them.

    Needs no configuration. A comment `mjcompose: ignore[RULE]` on the line of a finding, or above it, ignores it;
    `mjcompose: ignore-file[RULE]` ignores a rule in the whole file. `mjcompose explain RULE` prints the page of a rule.

    Exit codes: 0 no findings, 1 there are findings, 2 wrong usage.
    """,
)
def lint(options: LintOptions, run: Run) -> Answer | int:
    from mjcompose.base.processes import cores
    from mjcompose.tools.lint import lint_all

    if options.rules:
        return _list_of_rules()
    if not options.files:
        raise click.UsageError("Missing argument 'FILES...'. `mjcompose lint .` looks for models in this folder.")
    selected = _selected(options)
    targets = _targets(options.files, run.context)
    if options.fix:
        _fix_all(targets, selected, run.context)
    results = lint_all(
        targets, run.new_context, selected, jobs=options.jobs or cores(), done=lambda path: progress(f"linted {path}")
    )
    findings = list(dict.fromkeys(finding for result, _ in results for finding in result.found))
    if not options.statistics and options.profile is None:
        _report_findings(findings, run)
    _report_errors(results, run.context)
    code = _exit_code(results, run)
    if options.profile is not None:
        return _table([result for result, _ in results], selected, code)
    if options.statistics:
        return _statistics(findings, code)
    if run.form != "text":
        return code
    ignored = sum(result.ignored for result, _ in results)
    summary = _summary(findings, ignored, models=len(targets), offers_fixes=not options.fix)
    return Answer(summary, code=code, is_outcome=True)


def _list_of_rules() -> Answer:
    from mjcompose.lint.rule import rules

    every = rules().values()
    width = max(len(rule.code) for rule in every)
    lines = [f"{rule.code:{width}}  {rule.family:8}  {rule.summary}" for rule in every]
    names = ("code", "family", "summary", "usual")
    data = [{name: getattr(rule, name) for name in names} for rule in every]
    return Answer(as_lines(lines), data, code=0)


def _selected(options: LintOptions) -> Sequence[Rule]:
    """Return the rules that the options select."""
    from mjcompose.lint.rule import UnknownRuleError, chosen

    try:
        return chosen(_separated(options.select), _separated(options.ignore), options.profile)
    except UnknownRuleError as error:
        hint = f" {error.help}" if error.help else " `mjcompose lint --rules` lists them."
        raise click.UsageError(f"There is no rule or family `{error.name}`.{hint}") from error


def _targets(files: Sequence[Path], context: Context) -> list[LintFile]:
    """Return the models in files and folders."""
    from mjcompose.tools.lint import targets_of

    targets = targets_of(Path(context.shown(path)) for path in files)
    if not targets:
        raise click.UsageError("There is no model in these folders.")
    return targets


def _report_findings(findings: Sequence[Diagnostic], run: Run) -> None:
    """Report findings; in text, those with a common cause become one block."""
    from mjcompose.tools.lint import merged

    for finding, cause in merged(findings):
        run.context.sink.add(finding, cause if run.form == "text" else None)


def _report_errors(results: Sequence[tuple[Linted, Context]], context: Context) -> None:
    """Report the errors of models and recipes; `check` reports the warnings of a recipe."""
    for _, own in results:
        for error in own.sink.errors:
            context.sink.add(error)


def _exit_code(results: Sequence[tuple[Linted, Context]], run: Run) -> int:
    failed = [result.path for result, context in results if context.sink.has_errors]
    if failed:
        return run.code_of_failure(*failed)
    return FINDINGS if any(result.found for result, _ in results) else 0


def _statistics(findings: Sequence[Diagnostic], code: int) -> Answer:
    """Return the number of findings of each rule, the most frequent first."""
    counts = dict(Counter(finding.code for finding in findings).most_common())
    lines = [f"{count:6}  {name}" for name, count in counts.items()]
    return Answer(as_lines(lines) or "no findings", counts, code=code)


def _summary(findings: Sequence[Diagnostic], ignored: int, models: int, *, offers_fixes: bool) -> str:
    fixable = sum(finding.fix is not None for finding in findings)
    more = f", {ignored} ignored" if ignored else ""
    hint = f"; --fix fixes {fixable} of them" if fixable and offers_fixes else ""
    return f"{counted(len(findings), 'finding')}{more} in {counted(models, 'model')}{hint}"


def _separated(values: Sequence[str]) -> list[str]:
    return [name for value in values for name in value.replace(",", " ").split()]


def _fix_all(targets: Sequence[LintFile], selected: Sequence[Rule], context: Context) -> None:
    """Apply the exact fixes of findings in all files, and say how many were made."""
    from mjcompose.mujoco.engine import Session

    with Session() as session:
        fixed = sum(_fix(target, selected, context, session=session) for target in targets)
    if fixed:
        say(f"fixed {counted(fixed, 'finding')}")


def _fix(target: LintFile, selected: Sequence[Rule], context: Context, session: Session) -> int:
    from mjcompose.tools.fix import Fixing, Judged
    from mjcompose.tools.lint import lint

    def look(own: Context) -> list[Judged]:
        found = lint(target.path, own, session, selected=selected, may_be_part=target.may_be_part).found
        return [Judged(None, (*own.sink.sorted(), *found))]

    door = target.door
    done = Fixing(look, context, MJCF_FILES, door=door).fixed()
    for path in done.outside:
        note_outside(path, door, context)
    return len(done.fixed) if _rewrite_all(done, door, context) else 0


def _table(results: Sequence[Linted], selected: Sequence[Rule], code: int) -> Answer:
    """Return the report of a profile: a line for each model and rule that it does not meet."""
    lines = []
    data = []
    for result in results:
        counts = Counter(each.code for each in result.found)
        met = len(selected) - len(counts)
        lines.append(f"{result.path}: meets {met} of {len(selected)} rules")
        lines += [f"  {counts[rule.code]:4}  {rule.code}: {rule.summary}" for rule in selected if counts[rule.code]]
        data.append({"model": str(result.path), "met": met, "rules": len(selected), "findings": dict(counts)})
    return Answer(as_lines(lines), data, code=code)

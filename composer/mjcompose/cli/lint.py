"""`mjcompose lint`: find mistakes in models."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.files import MJCF_FILES
from mjcompose.base.report import counted
from mjcompose.cli.fmt import rewrite
from mjcompose.cli.options import FetchOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import FINDINGS, progress, say
from mjcompose.cli.run import PATH, Answer, Group, Run, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.base.diagnostic import Diagnostic
    from mjcompose.build.lint.rule import Rule
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.tools.lint import Linted, Target

_PROFILES = ("menagerie", "robot-asset")


class Options(Group):
    files: tuple[Path, ...] = argument(metavar="FILES...", type=PATH, nargs=-1)
    select: tuple[str, ...] = option(
        "--select", multiple=True, metavar="RULE", help="Run only this rule or family of rules, or `all`. Separate"
        " several with commas, or repeat the option.",
    )  # fmt: skip
    ignore: tuple[str, ...] = option("--ignore", multiple=True, metavar="RULE", help="Do not run this rule or family.")
    profile: str | None = option("--profile", type=click.Choice(_PROFILES), help="Run the rules of a standard for"
                                 " models, and print a table of them.")  # fmt: skip
    fix: bool = flag("--fix", help="Change the files: apply the exact fixes of findings.")
    rules: bool = flag("--rules", help="List all rules, and stop.")
    statistics: bool = flag("--statistics", help="Print the number of findings of each rule instead of the findings.")
    jobs: int | None = option("-j", "--jobs", metavar="NUMBER", type=click.IntRange(min=1), help="The number of"
                              " processes. Default: one for each core.")  # fmt: skip
    limits: TimeOptions = group(TimeOptions)
    fetching: FetchOptions = group(FetchOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def lint(options: Options, run: Run) -> Answer | int:
    """Find mistakes in FILES that MuJoCo accepts: MJCF, URDF, recipes, bundles, and folders with them.

    Needs no configuration. A comment `mjcompose: ignore[RULE]` on the line of a finding, or above it, ignores it;
    `mjcompose: ignore-file[RULE]` ignores a rule in the whole file. `mjcompose explain RULE` prints the page of a rule.

    Exit codes: 0 no findings, 1 there are findings, 2 wrong usage.
    """
    from mjcompose.base.processes import cores
    from mjcompose.build.lint.rule import UnknownRuleError, chosen, rules
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.lint import lint_all, merged, targets_of

    if options.rules:
        every = rules().values()
        width = max(len(each.code) for each in every)
        return Answer(
            "\n".join(f"{each.code:{width}}  {each.family:8}  {each.summary}" for each in every),
            [
                {"code": each.code, "family": each.family, "summary": each.summary, "usual": each.usual}
                for each in every
            ],
            code=0,
        )
    if not options.files:
        raise click.UsageError("Missing argument 'FILES...'. `mjcompose lint .` looks for models in this folder.")
    try:
        selected = chosen(_separated(options.select), _separated(options.ignore), options.profile)
    except UnknownRuleError as error:
        hint = f" {error.help}" if error.help else " `mjcompose lint --rules` lists them."
        raise click.UsageError(f"There is no rule or family `{error.name}`.{hint}") from error
    targets = targets_of(Path(run.context.shown(path)) for path in options.files)
    if not targets:
        raise click.UsageError("There is no model in these folders.")
    if options.fix:
        with Session() as session:
            fixed = sum(_fix(each, selected, run.context, session=session) for each in targets)
        if fixed:
            say(f"fixed {counted(fixed, 'finding')}")
    results = lint_all(
        targets, run.new_context, selected, jobs=options.jobs or cores(), done=lambda path: progress(f"linted {path}")
    )
    shows = not options.statistics and options.profile is None
    found = list(dict.fromkeys(each for result, _ in results for each in result.found))
    for each, cause in merged(found) if shows else ():
        run.context.sink.add(each, cause if run.form == "text" else None)
    for _, context in results:
        for each in context.sink.errors:  # `check` reports the warnings of a recipe
            run.context.sink.add(each)
    failed = [result.path for result, context in results if context.sink.has_errors]
    code = run.code_of_failure(*failed) if failed else FINDINGS if found else 0
    if options.profile is not None:
        return _table([result for result, _ in results], selected, code)
    if options.statistics:
        counts = Counter(each.code for each in found)
        lines = [f"{count:6}  {name}" for name, count in counts.most_common()]
        return Answer("\n".join(lines) or "no findings", dict(counts.most_common()), code=code)
    ignored = sum(result.ignored for result, _ in results)
    more = f", {ignored} ignored" if ignored else ""
    fixable = sum(each.fix is not None for each in found)
    hint = f"; --fix fixes {fixable} of them" if fixable and not options.fix else ""
    said = f"{counted(len(found), 'finding')}{more} in {counted(len(targets), 'model')}{hint}"
    return Answer(said, code=code, is_outcome=True) if run.form == "text" else code


def _separated(values: Sequence[str]) -> list[str]:
    return [name for value in values for name in value.replace(",", " ").split()]


def _fix(target: Target, selected: Sequence[Rule], context: Context, session: Session) -> int:
    """Apply the fixes of one model and return how many were applied."""
    from mjcompose.tools.fix import Fixing
    from mjcompose.tools.lint import lint

    def look(own: Context) -> list[Diagnostic]:
        found = lint(target.path, own, session, selected=selected, may_be_part=target.may_be_part).found
        return [*own.sink.sorted(), *found]

    done = Fixing(look, context, MJCF_FILES).fixed()
    written = [rewrite(file, after, context, before=before) for file, (before, after) in done.files.items()]
    return len(done.fixed) if all(written) else 0


def _table(results: Sequence[Linted], selected: Sequence[Rule], code: int) -> Answer:
    """Return the report of a profile: a line for each model and rule that it does not meet."""
    lines, data = [], []
    for result in results:
        counts = Counter(each.code for each in result.found)
        met = len(selected) - len(counts)
        lines.append(f"{result.path}: meets {met} of {len(selected)} rules")
        lines += [f"  {counts[rule.code]:4}  {rule.code}: {rule.summary}" for rule in selected if counts[rule.code]]
        data.append({"model": str(result.path), "met": met, "rules": len(selected), "findings": dict(counts)})
    return Answer("\n".join(lines), data, code=code)

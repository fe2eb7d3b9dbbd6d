"""`mjcompose check`: everything that a build would find, without writing anything."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.caching import caching, no_cache_option
from composer.cli.choices import Choices, choice_options
from composer.cli.clustering import crew_of, stopped
from composer.cli.counting import counting
from composer.cli.fetching import fetching, fetching_options
from composer.cli.junit import junit_option, suite_of, write_junit
from composer.cli.limits import timeout_option
from composer.cli.matrix import cells_options, check_several, chosen_cells, jobs_options
from composer.cli.noted import note_files
from composer.cli.reporting import (
    FINDINGS,
    USAGE,
    exit_code,
    is_strict,
    progress,
    report,
    reporting_options,
    say,
    say_details,
    strict_option,
    verbose_option,
)
from composer.cli.shard import Shard
from composer.cli.tally import Tally
from composer.cli.watching import session_of_run, watch_option

if TYPE_CHECKING:
    from composer.cache.builder import Maker
    from composer.cache.result import Made
    from composer.context import Context
    from composer.diagnostics.junit import Suite
    from composer.document import Node
    from composer.verify.outcome import Outcome


@click.command()
@click.argument("recipes", type=click.Path(path_type=Path), nargs=-1, required=True)
@choice_options
@cells_options
@jobs_options
@click.option(
    "--no-verify", is_flag=True, help="Do not compile the models in MuJoCo, and do not run their checks."
)
@timeout_option
@junit_option
@no_cache_option
@fetching_options
@strict_option
@verbose_option
@reporting_options
@watch_option
def command(
    recipes: tuple[Path, ...],
    choices: Choices,
    every: bool,
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    jobs: int | None,
    cluster: str | None,
    shard: Shard | None,
    no_verify: bool,
    junit: str | None,
    no_cache: bool,
    form: str,
) -> None:
    """Check each of RECIPES: read, plan and compose it, compile it in MuJoCo, and run its checks.

    Without --all, --pick or --sample, the model with the default values is checked. Nothing is written except the
    file of --junit.
    """
    from composer.cache.builder import Maker
    from composer.cache.cache_key import BuildOptions
    from composer.context import Context

    one = not every and not picks and not only_samples
    check_several(one, jobs=jobs, shard=shard, cluster=cluster)
    code = 0
    suites: list[Suite] = []
    for recipe in recipes:
        how = fetching()
        context = Context(fetching=how, strict=is_strict())
        given = choices.values(context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        order = BuildOptions(
            not no_verify, choices=choices.named(context), locked=how.locked, offline=how.offline
        )
        with caching(context, no_cache) as cache:
            look = _Check(
                Maker(recipe, order, cache, context), context, form, jobs, shard, cluster, junit is not None
            )
            if one:
                look.one(given, alone=True)
            elif not look.cells(picks, only_samples, given):
                look.one(given)
        report(context, form, err=junit == "-")
        say_details(context, look.files)
        suites += look.suites
        if look.tally is not None:
            look.tally.say(form, err=junit == "-")
        code = max(code, look.code)
        if not look.code and form == "text" and junit != "-":
            say(f"{recipe}: ok{look.counted}")
    if junit is not None:
        context = Context()
        write_junit(suites, junit, context)
        report(context, form)
        code = max(code, FINDINGS if context.sink.has_errors else 0)
    sys.exit(code)


class _Check:
    """Checks one recipe, as one model or several."""

    def __init__(
        self,
        maker: Maker,
        context: Context,
        form: str,
        jobs: int | None = None,
        shard: Shard | None = None,
        cluster: str | None = None,
        wants_suites: bool = False,
    ) -> None:
        self.maker, self.context, self.form, self.jobs, self.shard = maker, context, form, jobs, shard
        self.cluster, self.wants_suites = cluster, wants_suites
        self.suites: list[Suite] = []
        self.tally: Tally | None = None
        self.counted = ""
        self.files: set[str] = set()
        self.code = 0

    def one(self, given: dict[str, Node], *, alone: bool = False) -> None:
        """Check the recipe's model without a cell; `alone` says that the user did not ask for cells."""
        from composer.cache.result import files_of

        maker, context = self.maker, self.context
        outcomes: list[Outcome] = []
        key = maker.key()
        made, why = maker.recall(key, context, outcomes)
        if made is None:
            progress(f"checking {maker.recipe}")
            with session_of_run(remembers=False) as session:
                made = maker.make(context, session, given, key=key, why=why, outcomes=outcomes)
        self.suites.append(suite_of(maker.recipe, outcomes, context.sink.errors, context))
        self.counted = _counted(len(outcomes))
        self.files |= files_of(made, context)
        note_files(self.files)
        self.code = exit_code(context.folder, [maker.recipe]) if made is None else 0
        if made is not None and alone:
            self._report_cells(made)

    def cells(self, picks: tuple[str, ...], samples: tuple[int, ...], given: dict[str, Node]) -> bool:
        """Check cells; return False if there are none, because the recipe is one model."""
        from composer.cache.cell_run import CellRun
        from composer.cache.making import CellMaker

        maker, context = self.maker, self.context
        chosen, self.code = chosen_cells(maker.recipe, picks, samples, given, context, "check")
        if self.code:
            self.suites.append(suite_of(maker.recipe, (), context.sink.errors, context))
            return True
        if not chosen:
            return False
        if self.shard is not None:
            chosen = self.shard.of(chosen)
        self.tally = Tally(maker.recipe, len(chosen))
        checks = 0
        with (
            session_of_run(remembers=True) as session,
            crew_of(self.cluster, self.jobs) as crew,
            CellRun(CellMaker(maker, given, session), self.jobs, crew) as running,
            stopped(context) as ended,
        ):
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                self.files |= each.files
                note_files(each.files)
                self.tally.take(each.cell.label, each.found, context.sink, failed=each.failed)
                if self.wants_suites:  # suites grow with the cells
                    self.suites.append(
                        suite_of(maker.recipe, each.outcomes, each.found, context, each.cell.label)
                    )
                checks += len(each.outcomes)
        self.counted = f", {len(chosen)} model{'s' * (len(chosen) != 1)}{_counted(checks)}"
        self.code = FINDINGS if self.tally.failed or ended else 0
        return True

    def _report_cells(self, made: Made) -> None:
        """Report that the cells of the matrix were not checked."""
        if made.cells:
            count = f"{made.cells} cell{'s' * (made.cells > 1)}"
            self.context.sink.note("cells-not-checked", f"one model was checked, and the matrix has {count}",
                                   made.cells_at, help="`--all` checks all of them, `--pick CELL` one")  # fmt: skip


def _counted(checks: int) -> str:
    if not checks:
        return ""
    return f", {checks} check{'s hold' if checks > 1 else ' holds'}"

"""`mjcompose check`: everything that a build would find, without writing anything."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base import report as github
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.cli.clustering import crew_of, stopped
from mjcompose.cli.options import (
    Choices,
    Shard,
    caching,
    cells_options,
    check_several,
    choice_options,
    chosen_cells,
    fetching,
    fetching_options,
    jobs_options,
    no_cache_option,
    timeout_option,
)
from mjcompose.cli.reporting import (
    FINDINGS,
    USAGE,
    Tally,
    counting,
    exit_code,
    is_strict,
    junit_option,
    note_files,
    progress,
    report,
    reporting_options,
    say,
    say_details,
    strict_option,
    suite_of,
    verbose_option,
    write_junit,
)
from mjcompose.cli.watching import session_of_run, watch_option

if TYPE_CHECKING:
    from mjcompose.base.report import Suite
    from mjcompose.build.cache.builder import Maker
    from mjcompose.build.cache.cache_key import BuildOptions
    from mjcompose.build.cache.cell_run import RecipeResult
    from mjcompose.sources.context import Context
    from mjcompose.text.node import Node


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
    from mjcompose.sources.context import Context

    one = not every and not picks and not only_samples
    check_several(one and len(recipes) == 1, jobs=jobs, shard=shard, cluster=cluster)
    if one and (shard is not None or cluster is not None):
        check_several(one, jobs=None, shard=shard, cluster=cluster)
    run = _Run(
        choices, form, jobs, shard=shard, cluster=cluster, no_verify=no_verify, no_cache=no_cache, junit=junit
    )
    several = len(dict.fromkeys(recipes)) > 1
    if one and several:
        run.at_once([*dict.fromkeys(recipes)])
    else:
        for recipe in recipes:
            run.one_after_another(recipe, picks, only_samples, one=one, several=several)
    if several:
        run.sum_up()
    code = run.code
    if junit is not None:
        context = Context()
        write_junit(run.suites, junit, context)
        report(context, form)
        code = max(code, FINDINGS if context.sink.has_errors else 0)
    sys.exit(code)


class _Run:
    """Checks one recipe after another, or several at once. What several have in common is reported once."""

    def __init__(
        self,
        choices: Choices,
        form: str,
        jobs: int | None,
        shard: Shard | None,
        cluster: str | None,
        no_verify: bool,
        no_cache: bool,
        junit: str | None,
    ) -> None:
        self.choices, self.form, self.jobs, self.shard, self.cluster = choices, form, jobs, shard, cluster
        self.no_verify, self.no_cache, self.junit = no_verify, no_cache, junit
        self.suites: list[Suite] = []
        self.code = 0
        self.common: Context | None = None
        self.tallies: list[Tally] = []
        self.verdicts: list[tuple[Path, bool, str]] = []
        """Each recipe, whether it holds, and what was counted."""

    def _context(self) -> Context:
        from mjcompose.sources.context import Context

        return Context(fetching=fetching(), strict=is_strict())

    def _given(self, context: Context) -> tuple[dict[str, Node], BuildOptions]:
        from mjcompose.build.cache.cache_key import BuildOptions

        given = self.choices.values(context)
        if context.sink.has_errors:
            report(context, self.form)
            sys.exit(USAGE)
        how = context.fetching
        assert how is not None
        named = self.choices.named(context)
        return given, BuildOptions(not self.no_verify, choices=named, locked=how.locked, offline=how.offline)

    def at_once(self, recipes: list[Path]) -> None:
        """Check one model of each recipe, in as many processes as there are cores."""
        from mjcompose.base import files as sources
        from mjcompose.base.limits import in_force
        from mjcompose.base.processes import Died, Pool, cores
        from mjcompose.build.cache.builder import Maker
        from mjcompose.build.cache.cell_run import RecipeJob, RecipeResult, context_for_worker, make_recipe

        context = self._context()
        given, order = self._given(context)
        count = min(self.jobs or cores(), len(recipes))
        with caching(context, self.no_cache) as cache, session_of_run(remembers=True) as session:

            def make(recipe: Path) -> RecipeResult:
                own = replace(context, sink=Sink(), timings=[], concrete={})
                return make_recipe(Maker(recipe, order, cache, context=own), session, given)

            store = None if cache is None else cache.store
            job = RecipeJob(
                order,
                store,
                given,
                context=context_for_worker(context),
                limits=in_force(),
                noted=sources.current().noted(),
            )
            with Pool[Path, RecipeResult](
                count - 1, ("mjcompose.build.cache.cell_run", "mjcompose.build.stages")
            ) as pool:
                results = counting(pool.results(job.opened, recipes, make), len(recipes), lambda _: "")
                for recipe, result in zip(recipes, results, strict=True):
                    own = replace(context, sink=Sink(), timings=[])
                    if isinstance(result, Died):
                        message = f"the process that checked this recipe {result.how}, twice"
                        own.sink.error(
                            "worker-died", message, Span(str(recipe), 1, 1), help="give `--jobs 1`"
                        )
                        result = RecipeResult(
                            tuple(own.sink.diagnostics), (), frozenset(), timings=(), failed=True
                        )
                    for each in result.diagnostics:
                        own.sink.add(each)
                    own.timings.extend(result.timings)
                    if not result.failed:
                        note_cells(own, result.cells, result.cells_at)
                    note_files(result.files)
                    self.suites.append(suite_of(recipe, result.outcomes, own.sink.errors, context=own))
                    code = exit_code(context.folder, [recipe]) if result.failed else 0
                    self._take(recipe, own, code, counted=_counted(len(result.outcomes)))
                    say_details(own, result.files)
        for each in context.sink.diagnostics:
            self._common().sink.add(each)

    def one_after_another(
        self, recipe: Path, picks: tuple[str, ...], samples: tuple[int, ...], *, one: bool, several: bool
    ) -> None:
        from mjcompose.build.cache.builder import Maker

        context = self._context()
        given, order = self._given(context)
        err = self.junit == "-"
        with caching(context, self.no_cache) as cache:
            look = _Check(
                Maker(recipe, order, cache, context=context),
                context,
                self.form,
                jobs=self.jobs,
                shard=self.shard,
                cluster=self.cluster,
                wants_suites=self.junit is not None,
            )
            if one:
                look.one(given, alone=True)
            elif not look.cells(picks, samples, given):
                look.one(given)
        self.suites += look.suites
        if several:
            self._take(recipe, context, look.code, counted=look.counted)
            say_details(context, look.files)
        else:
            report(context, self.form, err=err)
            say_details(context, look.files)
            self.code = look.code
        if look.tally is not None:
            self.tallies.append(look.tally)
            if not several:
                look.tally.say(self.form, err=err)
        if not several and not look.code and self.form == "text" and not err:
            say(f"{recipe}: ok{look.counted}")

    def _common(self) -> Context:
        if self.common is None:
            self.common = self._context()
        return self.common

    def _take(self, recipe: Path, context: Context, code: int, counted: str) -> None:
        """Keep what was found of one of several recipes."""
        for each in context.sink.diagnostics:
            self._common().sink.add_of_recipe(str(recipe), each)
        self.verdicts.append((recipe, not code, counted))
        self.code = max(self.code, code)

    def sum_up(self) -> None:
        """Report what was found of all recipes, and which of them hold."""
        err = self.junit == "-"
        report(self._common(), self.form, err=err)
        for tally in self.tallies:
            tally.say(self.form, err=err)
        failed = [str(recipe) for recipe, holds, _ in self.verdicts if not holds]
        for recipe, holds, counted in self.verdicts:
            if self.form == "json":
                click.echo(json.dumps({"recipe": str(recipe), "ok": holds}), err=err)
            elif holds and not err:
                words = f"{recipe}: ok{counted}"
                say(words if self.form == "text" else github.command("notice", words, {"title": str(recipe)}))
        if failed and self.form == "text":
            click.echo(f"{len(failed)} of {len(self.verdicts)} recipes failed: {', '.join(failed)}", err=True)


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
        from mjcompose.build.cache.cell_run import make_recipe

        maker, context = self.maker, self.context
        progress(f"checking {maker.recipe}")
        with session_of_run(remembers=False) as session:
            made = make_recipe(maker, session, given)
        self.suites.append(suite_of(maker.recipe, made.outcomes, context.sink.errors, context=context))
        self.counted = _counted(len(made.outcomes))
        self.files |= made.files
        note_files(self.files)
        self.code = exit_code(context.folder, [maker.recipe]) if made.failed else 0
        if not made.failed and alone:
            note_cells(context, made.cells, made.cells_at)

    def cells(self, picks: tuple[str, ...], samples: tuple[int, ...], given: dict[str, Node]) -> bool:
        """Check cells; return False if there are none, because the recipe is one model."""
        from mjcompose.build.cache.cell_run import CellMaker, CellRun

        maker, context = self.maker, self.context
        chosen, self.code = chosen_cells(
            maker.recipe, picks, samples, given=given, context=context, verb="check"
        )
        if self.code:
            self.suites.append(suite_of(maker.recipe, (), context.sink.errors, context=context))
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
                self.tally.take(each.cell.label, each.diagnostics, context.sink, failed=each.failed)
                if self.wants_suites:  # suites grow with the cells
                    self.suites.append(
                        suite_of(
                            maker.recipe,
                            each.outcomes,
                            each.diagnostics,
                            context=context,
                            cell=each.cell.label,
                        )
                    )
                checks += len(each.outcomes)
        self.counted = f", {len(chosen)} model{'s' * (len(chosen) != 1)}{_counted(checks)}"
        self.code = FINDINGS if self.tally.failed or ended else 0
        return True


def note_cells(context: Context, cells: int, at: Span | None) -> None:
    """Report that the cells of a recipe's matrix were not checked."""
    if cells:
        count = f"{cells} cell{'s' * (cells > 1)}"
        context.sink.note("cells-not-checked", f"one model was checked, and the matrix has {count}",
                          at, help="`--all` checks all of them, `--pick CELL` one")  # fmt: skip


def _counted(checks: int) -> str:
    if not checks:
        return ""
    return f", {checks} check{'s hold' if checks > 1 else ' holds'}"

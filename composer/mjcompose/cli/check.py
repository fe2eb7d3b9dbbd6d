"""`check` and `plan`: report the errors and the steps of a build without writing anything."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base import files as sources, report as github
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import CellName, Diagnostic, Severity, Span
from mjcompose.base.files import STDIN
from mjcompose.base.limits import in_force
from mjcompose.base.report import Case, Suite, as_lines, json_text, one_line, printable
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import CheckOutcome, license_rows, license_table
from mjcompose.cli.cells import BuildingOptions, ModelOptions, Tally, check_readers, check_several, counting, stopped
from mjcompose.cli.options import RECIPE_OR_STDIN, caching
from mjcompose.cli.reporting import FINDINGS, exit_code, note_files, progress, say, say_details
from mjcompose.cli.run import RECIPE_PATH, Answer, Run, argument, command, flag, option
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.language.expand import Cell
    from mjcompose.pipeline.cache.builder import Maker
    from mjcompose.pipeline.cache.cell_run import RecipeResult
    from mjcompose.plan.matrix import FilledValues
    from mjcompose.plan.plan import Plan, PlanPreview


class CheckOptions(BuildingOptions):
    recipes: tuple[Path, ...] = argument(type=RECIPE_PATH, nargs=-1, required=True)
    no_compile: bool = flag("--no-compile", help="Do not compile the models in MuJoCo, and do not run their checks.")
    junit: str | None = option(
        "--junit", metavar="FILE", help="Write the result of each check as JUnit XML ('-' is standard output)."
    )


@command(
    CheckOptions,
    help="""Check each of RECIPES: read, plan and compose it, compile it in MuJoCo, and run its checks.

    Without --all, --pick or --sample, the model with the default values is checked. Nothing is written except the
    file of --junit.
    """,
)
def check(options: CheckOptions, run: Run) -> int:
    recipes = list(dict.fromkeys(options.recipes))
    one = options.cells.one
    workers = options.workers
    jobs = workers.jobs if len(options.recipes) == 1 else None
    check_several(one, jobs=jobs, shard=workers.shard, cluster=workers.cluster)
    if len(recipes) > 1 and Path(STDIN) in recipes:
        raise click.UsageError("Standard input, `-`, is checked alone.")
    check_readers(recipes[0], workers.cluster)
    checking = _Checking(options, run)
    run.to_stderr = options.junit == "-"
    if len(recipes) == 1:
        return checking.alone(recipes[0])
    if one:
        checking.at_once(recipes)
    else:
        for recipe in recipes:
            checking.check(recipe)
    return checking.sum_up()


class _Result(Struct):
    """The result of one recipe, with the numbers of models and checks in words."""

    recipe: Path
    code: int
    counted: str = ""
    tally: Tally | None = None
    files: frozenset[str] = frozenset()


class _Checking:
    """Checks one or several recipes, and reports their common diagnostics once."""

    def __init__(self, options: CheckOptions, run: Run) -> None:
        from mjcompose.pipeline.cache.cache_key import BuildOptions

        self.options = options
        self.run = run
        self.given = options.choices.given(run)
        how = run.context.fetching
        assert how is not None
        named = options.choices.named(run.context)
        self.order = BuildOptions(not options.no_compile, choices=named, locked=how.locked, offline=how.offline)
        self.results: list[_Result] = []

    def alone(self, recipe: Path) -> int:
        run = self.run
        result = self._checked(recipe, run.context)
        run.report()
        say_details(run.context, result.files)
        if result.tally is not None:
            result.tally.say(run.form, err=run.to_stderr)
        if not result.code and run.form == "text" and not run.to_stderr:
            say(f"{recipe}: ok{result.counted}")
        return result.code

    def check(self, recipe: Path) -> None:
        context = self.run.new_context()
        self._take(self._checked(recipe, context), context)

    def at_once(self, recipes: list[Path]) -> None:
        """Check one model of each recipe, in as many processes as there are cores."""
        from mjcompose.base.processes import Died, Pool, cores
        from mjcompose.pipeline.cache.builder import Maker
        from mjcompose.pipeline.cache.cell_run import RecipeJob, RecipeResult, context_for_worker, make_recipe

        context = self.run.context
        given = self.given
        order = self.order
        count = min(self.options.workers.jobs or cores(), len(recipes))
        with caching(context, self.options.no_cache) as cache, self.run.session(remembers=True) as session:

            def make(recipe: Path) -> RecipeResult:
                own = replace(context, sink=Sink(), timings=[], concrete={})
                return make_recipe(Maker(recipe, order, cache, context=own), session, given)

            job = RecipeJob(
                order,
                None if cache is None else cache.store,
                given,
                context=context_for_worker(context),
                limits=in_force(),
                noted=sources.current().noted(),
            )
            modules = ("mjcompose.pipeline.cache.cell_run", "mjcompose.pipeline.stages")
            with Pool[Path, RecipeResult](count - 1, modules) as pool:
                results = counting(pool.results(job.opened, recipes, make), len(recipes), lambda _: "")
                for recipe, result in zip(recipes, results, strict=True):
                    own = replace(context, sink=Sink(), timings=[])
                    if isinstance(result, Died):
                        message = f"the process that checked this recipe {result.how}, twice"
                        own.sink.error("worker-died", message, Span(str(recipe), 1, 1), help="give `--jobs 1`")
                        result = RecipeResult((), (), frozenset(), timings=(), failed=True)
                    own.sink.extend(result.diagnostics)
                    own.timings.extend(result.timings)
                    self._take(self._of_model(recipe, result, own, notes_cells=True), own)

    def _take(self, result: _Result, context: Context) -> None:
        for each in context.sink.diagnostics:
            self.run.context.sink.add_of_recipe(str(result.recipe), each)
        self.results.append(result)
        say_details(context, result.files)

    def sum_up(self) -> int:
        """Report all diagnostics, and the recipes without errors. Return the exit code."""
        run = self.run
        err = self.run.to_stderr
        run.report()
        for result in self.results:
            if result.tally is not None:
                result.tally.say(run.form, err=err)
        failed = [str(result.recipe) for result in self.results if result.code]
        for result in self.results:
            if run.form == "json":
                click.echo(json_text({"recipe": str(result.recipe), "ok": not result.code}), err=err)
            elif not result.code and not err:
                words = f"{result.recipe}: ok{result.counted}"
                title = {"title": str(result.recipe)}
                if run.form == "github":
                    say(github.command("notice", words, title), is_escaped=True)
                else:
                    say(words)
        if failed and run.form == "text":
            words = f"{len(failed)} of {len(self.results)} recipes failed: {', '.join(failed)}"
            click.echo(printable(one_line(words)), err=True)
        return max(result.code for result in self.results)

    def _checked(self, recipe: Path, context: Context) -> _Result:
        from mjcompose.pipeline.cache.builder import Maker

        with caching(context, self.options.no_cache) as cache:
            maker = Maker(recipe, self.order, cache, context=context)
            if self.options.cells.one:
                return self._model(maker, notes_cells=True)
            return self._cells(maker) or self._model(maker, notes_cells=False)

    def _model(self, maker: Maker, *, notes_cells: bool) -> _Result:
        from mjcompose.pipeline.cache.cell_run import make_recipe

        progress(f"checking {maker.recipe}")
        with self.run.session(remembers=False) as session:
            result = make_recipe(maker, session, self.given)
        return self._of_model(maker.recipe, result, maker.context, notes_cells=notes_cells)

    def _of_model(self, recipe: Path, result: RecipeResult, context: Context, *, notes_cells: bool) -> _Result:
        """Return the result of a model; `notes_cells` is set if the user did not select cells."""
        outcomes = result.outcomes
        self.run.suites.append(_suite(recipe, outcomes, context.sink.errors, context=context))
        note_files(result.files)
        if notes_cells and not result.failed and result.cells:
            message = f"one model was checked, and the matrix has {counted(result.cells, 'cell')}"
            help = "`--all` checks all of them, `--pick CELL` one"
            context.sink.note("cells-not-checked", message, result.cells_at, help=help)
        code = exit_code(context.folder, [recipe]) if result.failed else 0
        return _Result(recipe, code, counted=_counted(len(outcomes)), files=frozenset(result.files))

    def _cells(self, maker: Maker) -> _Result | None:
        """Check cells, or return None if there are none, because the recipe is one model."""
        from mjcompose.pipeline.cache.cell_run import CellMaker, CellRun

        options = self.options
        run = self.run
        recipe = maker.recipe
        context = maker.context
        chosen, code = options.cells.chosen(recipe, self.given, context=context, verb="check")
        if code:
            run.suites.append(_suite(recipe, (), context.sink.errors, context=context))
            return _Result(recipe, code)
        if not chosen:
            return None
        if options.workers.shard is not None:
            chosen = options.workers.shard.of(chosen)
        tally = Tally(recipe, len(chosen))
        checks = 0
        files: set[str] = set()
        with (
            run.session(remembers=True) as session,
            options.workers.started() as crew,
            CellRun(CellMaker(maker, self.given, session), options.workers.jobs, crew) as running,
            stopped(context) as ended,
        ):
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                files |= each.files
                note_files(each.files)
                label = each.cell.label
                tally.take(label, each.diagnostics, context.sink, failed=each.failed)
                if run.junit is not None or run.form == "junit":  # suites grow with the cells
                    run.suites.append(_suite(recipe, each.outcomes, each.diagnostics, context=context, cell=label))
                checks += len(each.outcomes)
        code = FINDINGS if tally.failed or ended else 0
        words = f", {counted(len(chosen), 'model')}{_counted(checks)}"
        return _Result(recipe, code, words, tally=tally, files=frozenset(files))


def _suite(
    recipe: Path,
    outcomes: Sequence[CheckOutcome],
    found: Iterable[Diagnostic],
    context: Context,
    cell: CellName | None = None,
) -> Suite:
    """Return the results of a recipe, or of one cell: the first case is the model itself, followed by its checks."""
    of_checks = {each for outcome in outcomes for each in outcome.diagnostics}
    others = [each for each in found if each.severity is Severity.ERROR and each not in of_checks]
    shown = context.shown(recipe)
    cases = [Case("model", "model", others, file=shown)]
    for each in outcomes:
        cases.append(Case(each.name, each.kind, each.diagnostics, file=each.span.file, line=each.span.line))
    return Suite(shown if cell is None else f"{shown}: {cell.name}", cases, cell)


def _counted(checks: int) -> str:
    return f", {checks} check{'s hold' if checks > 1 else ' holds'}" if checks else ""


class PlanOptions(ModelOptions):
    recipe: Path = RECIPE_OR_STDIN
    expanded: bool = flag("--expanded", help="Print the concrete recipe, with the file and line of every value.")
    licenses: bool = flag("--licenses", help="Print only the license of every part.")


@command(PlanOptions, help="Print the steps of a build of RECIPE, and the cells of its matrix.")
def plan(options: PlanOptions, run: Run) -> Answer:
    from mjcompose.pipeline.cache.cells import cells_of
    from mjcompose.plan.describe import describe
    from mjcompose.plan.matrix import FilledValues, check_sample, filled_from_first_cell
    from mjcompose.plan.planner import make_plan
    from mjcompose.plan.read import expanded_text

    recipe = options.recipe
    context = run.context
    given = options.choices.given(run)
    cell = options.cell.chosen(recipe, given, run=run, verb="plan")
    filled = FilledValues(given)
    cells = []
    if cell is not None:
        plan = make_plan(recipe, context, {**given, **cell.given}, name=cell.name, sample=cell.sample)
    else:
        sample = options.cell.sample or 0
        filled = filled_from_first_cell(recipe, context, given)
        plan = make_plan(recipe, context, filled.given, sample=sample)
        if plan is not None:
            check_sample(plan, sample, context.sink)
            cells = cells_of(recipe, context, given)
    planned = run.need(plan, recipe)
    if options.licenses:
        rows = license_rows(planned, context)
        return Answer(lambda: as_lines(license_table(rows)), [asdict(row) for row in rows])
    if options.expanded:
        return Answer(lambda: expanded_text(planned))
    from mjcompose.compose.preview import preview_plan

    foreseen = preview_plan(planned, context)
    return Answer(
        lambda: "\n".join([describe(planned, foreseen), *map(one_line, _cell_lines(planned, filled, cells))]),
        lambda: _data(planned, foreseen, filled, cells=cells),
    )


def _data(plan: Plan, preview: PlanPreview | None, filled: FilledValues, cells: Sequence[Cell]) -> dict[str, Any]:
    from mjcompose.plan.describe import as_data

    data = as_data(plan, preview)
    if filled.cell is not None:
        data["as_cell"] = filled.cell
    if cells:
        data["cells"] = [{"name": cell.name, "set": cell.values(), "sample": cell.sample} for cell in cells]
    return data


def _cell_lines(plan: Plan, filled: FilledValues, cells: Sequence[Cell]) -> Iterator[str]:
    """Yield lines about the cells; cells that differ only in draws share a line."""
    from mjcompose.text.expression import shown

    if filled.cell is not None:
        values = ", ".join(f"`{name}`" for name in filled.taken)
        yield f"  {values} as in the cell {filled.cell}: without a default, only the cells have a value"
    if cells:
        what = "models" if plan.randomize is not None else "cells of the matrix"
        yield f"{len(cells)} {what}, built by --all or --pick:"
    for _, same in groupby(cells, key=lambda cell: id(cell.given)):
        first, *others = same
        names = first.name
        if others:
            names += f" … {others[-1].name}, {first.name} without a draw"
        values = ", ".join(f"{name} = {shown(value)}" for name, value in first.values().items() if value is not None)
        yield f"  {names}  {values}".rstrip()

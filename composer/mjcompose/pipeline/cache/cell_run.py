"""Make cells in this process and in workers, with the same results in the same order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Protocol

from mjcompose.base import files
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.limits import Limits, allow, in_force
from mjcompose.base.processes import Died, Pool, cores
from mjcompose.base.runtime import interruptible
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.language.expand import Cell
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.builder import (
    BuildResult,
    Maker,
    ModelChoice,
    OutputLocator,
    result_from_cache,
    shown_input_files,
)
from mjcompose.pipeline.cache.cache import Cache, Package, Record, open_cache
from mjcompose.pipeline.cache.cache_key import BuildOptions, CacheKey, FileState
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import quiet
from mjcompose.sources.store import Store
from mjcompose.text.node import Node

Finish = Callable[[BuildResult, Maker, Context, Session], "BuildResult | None"]
"""Processes each model that is made, for example by writing it; returns None after a failure, which it reports."""


class CellResult(Struct):
    """The result of a cell, None if it failed, with its diagnostics and those `of_run`. Can be pickled."""

    cell: Cell
    result: BuildResult | None
    failed: bool
    diagnostics: tuple[Diagnostic, ...]
    outcomes: tuple[CheckOutcome, ...] = ()
    files: frozenset[str] = frozenset()
    timings: tuple[tuple[str, float], ...] = ()
    of_run: tuple[Diagnostic, ...] = ()


class CellMaker(Struct, frozen=False):
    """Makes cells with one session, which reads each source file once."""

    maker: Maker
    given: dict[str, Node]
    session: Session
    finish: Finish | None = None

    def begin(self) -> None:
        """Let MuJoCo's process start while the first cell is planned and composed."""
        if self.maker.options.verified:
            self.session.begin()

    def make(self, cell: Cell) -> CellResult:
        made = self.known(cell, builds=True)
        assert made is not None
        return made

    def known(self, cell: Cell, *, builds: bool = False) -> CellResult | None:
        """Return the cell if the cache has it, or `builds` it."""
        own = replace(self.maker.context, sink=Sink(), timings=[])
        key = self._key(cell)
        outcomes: list[CheckOutcome] = []
        result, why = self.maker.recall(key, own, outcomes)
        if result is None:
            if not builds:
                return None
            choice = ModelChoice({**self.given, **cell.given}, cell.name, cell.sample)
            with interruptible():
                result = self.maker.make(own, self.session, choice, key=key, why=why, outcomes=outcomes)
        files = shown_input_files(result, own)
        if result is not None and self.finish is not None:
            result = self.finish(result, self.maker, own, self.session)
        return CellResult(
            cell,
            None if result is None else result.summary(),
            result is None or own.sink.has_errors,
            diagnostics=tuple(own.sink.diagnostics),
            outcomes=tuple(outcomes),
            files=frozenset(files),
            timings=tuple(own.timings),
        )

    def keep(
        self,
        cell: Cell,
        record: Record,
        inputs: Sequence[FileState],
        packages: Iterable[Package],
        result: BuildResult | None = None,
    ) -> None:
        """Store the record of a cell that was written elsewhere, and its result, if its inputs are the same here."""
        cache = self.maker.cache
        key = self._key(cell)
        if cache is None or key is None:
            return
        here = [cache.files.look(each.path) for each in inputs]
        if all(mine.state == each.state for mine, each in zip(here, inputs, strict=True)):
            cache.keep(key, record, here, packages=packages)
            self.maker.note_written(result_from_cache(record, ()) if result is None else result)

    def _key(self, cell: Cell) -> CacheKey | None:
        from mjcompose.pipeline.cache.cells import pick_text  # a known recipe without cells needs no reader

        values = {f"`{name}`": pick_text(node) for name, node in cell.given.items()}
        return self.maker.key(cell.name, {**values, "the sample": str(cell.sample)})


class RecipeResult(Struct):
    """The result of a recipe from which one model is made, with the number of `checks` and of `cells`."""

    diagnostics: tuple[Diagnostic, ...]
    outcomes: tuple[CheckOutcome, ...]
    files: frozenset[str]
    timings: tuple[tuple[str, float], ...]
    failed: bool
    cells: int = 0
    cells_at: Span | None = None


def make_recipe(maker: Maker, session: Session, given: dict[str, Node]) -> RecipeResult:
    """Make the model of a recipe with its default values and these, unless the cache has it."""
    context = maker.context
    outcomes: list[CheckOutcome] = []
    key = maker.key()
    made, why = maker.recall(key, context, outcomes)
    if made is None:
        with interruptible():
            made = maker.make(context, session, ModelChoice(given), key=key, why=why, outcomes=outcomes)
    return RecipeResult(
        tuple(context.sink.diagnostics),
        tuple(outcomes),
        frozenset(shown_input_files(made, context)),
        timings=tuple(context.timings),
        failed=made is None,
        cells=made.cells if made else 0,
        cells_at=made.cells_at if made else None,
    )


def context_for_worker(context: Context) -> Context:
    """Return a context for a process: it knows the files read and fetched here, and has its own diagnostics."""
    how = context.fetching
    return replace(
        context,
        sink=Sink(),
        timings=[],
        concrete={},
        fetching=None if how is None else replace(how, progress=quiet),
    )


OnKeep = Callable[[Record, Sequence[FileState]], None]
"""Gets everything that the cache stores."""


@contextmanager
def _working(job: Job | RecipeJob, on_keep: OnKeep | None) -> Iterator[tuple[Cache | None, Session]]:
    """Yield the cache and the session of a worker, with the limits and the sources of this run."""
    cache = None if job.store is None else open_cache(job.store, job.context.sink)
    if cache is not None:
        cache.on_keep = on_keep
    with files.run(), allow(**asdict(job.limits)), Session(remembers=True) as session:
        files.current().note(job.noted)
        yield cache, session


class Job(Struct):
    """The data of a `CellMaker`, so a worker makes cells as this process would. Can be pickled."""

    recipe: Path
    options: BuildOptions
    store: Store | None
    form: str | None
    place: OutputLocator
    given: dict[str, Node]
    finish: Finish | None
    context: Context
    limits: Limits
    noted: tuple[str, ...] = ()

    @classmethod
    def of(cls, making: CellMaker) -> Job:
        maker = making.maker
        context = context_for_worker(making.maker.context)
        return cls(
            maker.recipe,
            maker.options,
            None if maker.cache is None else maker.cache.store,
            form=maker.form,
            place=maker.place,
            given=making.given,
            finish=making.finish,
            context=context,
            limits=in_force(),
            noted=files.current().noted(),
        )

    @contextmanager
    def opened(self, on_keep: OnKeep | None = None) -> Iterator[Callable[[Cell], CellResult]]:
        """Yield, in a worker, the function that makes a cell."""
        with _working(self, on_keep) as (cache, session):
            maker = Maker(self.recipe, self.options, cache, context=self.context, form=self.form, place=self.place)
            making = CellMaker(maker, self.given, session, finish=self.finish)
            making.begin()
            yield lambda cell: replace(making.make(cell), of_run=tuple(self.context.sink.diagnostics))


class RecipeJob(Struct):
    """The data for a worker that makes one model of each of several recipes. Can be pickled."""

    options: BuildOptions
    store: Store | None
    given: dict[str, Node]
    context: Context
    limits: Limits
    noted: tuple[str, ...] = ()

    @contextmanager
    def opened(self, on_keep: OnKeep | None = None) -> Iterator[Callable[[Path], RecipeResult]]:
        """Yield, in a worker, the function that makes a recipe."""
        with _working(self, on_keep) as (cache, session):

            def make(recipe: Path) -> RecipeResult:
                own = replace(self.context, sink=Sink(), timings=[], concrete={})
                return make_recipe(Maker(recipe, self.options, cache, context=own), session, self.given)

            yield make


_CELLS_A_PROCESS = 2
"""Starting a process pays off for this many cells, if the user gives no number of processes."""
_MODULES = (
    "mjcompose.pipeline.cache.cell_run",
    "mjcompose.pipeline.stages",
    "mjcompose.verify.run_checks",
    "mjcompose.verify.compile",
)


class RemoteWorkers(Protocol):
    """Makes cells elsewhere than in processes of this machine: `cluster/crew.py`."""

    def results(self, making: CellMaker, cells: Sequence[Cell]) -> Iterator[CellResult | Died]: ...

    def finished(self) -> Iterator[CellResult]: ...


class CellRun:
    """Makes cells with `jobs` processes; by default with one process for each core, if that pays off.

    If signals are deferred around it, no cell is lost between writing and yielding it. A `crew` does all the work
    instead. Diagnostics of the run as a whole go to the maker's context. Use it as a context manager.
    """

    def __init__(self, making: CellMaker, jobs: int | None = None, crew: RemoteWorkers | None = None) -> None:
        self.making = making
        self.crew = crew
        self.jobs = 1 if making.maker.recipe.name == files.STDIN else jobs  # only this process has read it
        self._pool: Pool[Cell, CellResult] | None = None
        self._held = ExitStack()

    def __enter__(self) -> CellRun:
        return self

    def __exit__(self, *_: object) -> None:
        self._held.close()

    def made(self, cells: Sequence[Cell]) -> Iterator[CellResult]:
        for place, cell in enumerate(cells):
            known = self.making.known(cell)
            if known is None:
                yield from self._made(cells[place:])
                return
            yield self._taken(known)

    def finished(self) -> Iterator[CellResult]:
        """Yield the results that exist but were not yielded, after an interruption. Makes no more cells."""
        ended = self.crew or self._pool
        yield from map(self._taken, ended.finished() if ended is not None else ())

    def _made(self, cells: Sequence[Cell]) -> Iterator[CellResult]:
        if self.crew is not None:
            self._fetch(cells[0])
            results = self.crew.results(self.making, cells)
        else:
            self.making.begin()
            count = min(len(cells), self.jobs or min(cores(), max(1, len(cells) // _CELLS_A_PROCESS)))
            self._pool = self._held.enter_context(Pool[Cell, CellResult](count - 1, _MODULES))
            if count > 1:
                self._fetch(cells[0])
            results = self._pool.results(Job.of(self.making).opened, cells, self.making.make)
        for cell, result in zip(cells, results, strict=True):
            if isinstance(result, Died):
                message = f"the process that made this model {result.how}, twice"
                help = "if memory ran out, use a smaller number with `--jobs`; `--jobs 1` uses no other process"
                fault = Diagnostic("worker-died", message, cell.span, help=help)
                result = CellResult(cell, None, True, diagnostics=(fault,))
            yield self._taken(result)

    def _fetch(self, cell: Cell) -> None:
        """Read and fetch the sources of a cell. Most cells need the same sources, and workers take them from here."""
        from mjcompose.pipeline import stages  # a run whose cells are all known does not need it

        making = self.making
        maker = self.making.maker
        request = stages.ModelRequest(maker.recipe, {**making.given, **cell.given}, cell.name, sample=cell.sample)
        with interruptible():
            stages.planned(request, replace(maker.context, sink=Sink()))

    def _taken(self, result: CellResult) -> CellResult:
        """Add the times of a cell, one for each stage, and its reports about the run to the maker's context."""
        maker = self.making.maker
        seconds: dict[str, float] = {}
        for stage, took in (*maker.context.timings, *result.timings):
            seconds[stage] = seconds.get(stage, 0.0) + took
        maker.context.timings[:] = seconds.items()
        maker.context.sink.extend(result.of_run)
        if maker.cache is not None and result.result is not None and result.result.is_new:
            maker.cache.grown = True
        return result

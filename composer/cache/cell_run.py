"""Make many cells in this process and in warm worker processes, with the same results in the same order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from types import TracebackType
from typing import Protocol

from composer.cache.making import CellMaker, Job, MadeCell
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.expand.matrix import Cell
from composer.processes.deferring import interruptible
from composer.processes.helper import Died
from composer.processes.pool import Pool, cores

_CELLS_A_PROCESS = 2
"""Starting a process pays off for this many cells, if the user gives no number of processes."""
_MODULES = (
    "composer.cache.making",
    "composer.stages",
    "composer.verify.checks",
    "composer.verify.compile_report",
)


class Crew(Protocol):
    """Makes cells elsewhere than in processes of this machine: `cluster/crew.py`."""

    def results(self, making: CellMaker, cells: Sequence[Cell]) -> Iterator[MadeCell | Died]: ...

    def finished(self) -> Iterator[MadeCell]: ...


class CellRun:
    """Makes cells with `jobs` processes; by default with one for each core, if that pays off.

    If signals are deferred around it, no cell is lost between writing and yielding it. A `crew` does all the work
    instead. Diagnostics of the run as a whole go to the maker's context. Use it as a context manager.
    """

    def __init__(self, making: CellMaker, jobs: int | None = None, crew: Crew | None = None) -> None:
        self.making, self.jobs, self.crew = making, jobs, crew
        self._pool: Pool[Cell, MadeCell] | None = None
        self._held = ExitStack()

    def __enter__(self) -> CellRun:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._held.close()

    def made(self, cells: Sequence[Cell]) -> Iterator[MadeCell]:
        """Yield the result of each cell, in order."""
        for place, cell in enumerate(cells):
            known = self.making.known(cell)
            if known is None:
                yield from self._made(cells[place:])
                return
            yield self._taken(known)

    def finished(self) -> Iterator[MadeCell]:
        """Yield the results that exist but were not yielded, after an interruption. Makes no more cells."""
        ended = self.crew or self._pool
        for each in ended.finished() if ended is not None else ():
            yield self._taken(each)

    def _made(self, cells: Sequence[Cell]) -> Iterator[MadeCell]:
        if self.crew is not None:
            self._fetch(cells[0])
            yield from self._all_taken(cells, self.crew.results(self.making, cells))
            return
        self.making.begin()
        count = min(len(cells), self.jobs or min(cores(), max(1, len(cells) // _CELLS_A_PROCESS)))
        self._pool = self._held.enter_context(Pool[Cell, MadeCell](count - 1, _MODULES))
        if count > 1:
            self._fetch(cells[0])
        results = self._pool.results(Job.of(self.making).opened, cells, self.making.make)
        yield from self._all_taken(cells, results)

    def _all_taken(self, cells: Sequence[Cell], results: Iterator[MadeCell | Died]) -> Iterator[MadeCell]:
        for cell, result in zip(cells, results, strict=True):
            yield self._taken(_lost(cell, result) if isinstance(result, Died) else result)

    def _fetch(self, cell: Cell) -> None:
        """Read and fetch what a cell needs. Most cells need the same sources, and workers take them from here."""
        from composer import stages  # which a run whose cells are all known does not need

        making, maker = self.making, self.making.maker
        request = stages.Request(maker.recipe, {**making.given, **cell.given}, cell.name, sample=cell.sample)
        with interruptible():
            stages.planned(request, replace(maker.context, sink=Sink()))

    def _taken(self, made: MadeCell) -> MadeCell:
        maker = self.making.maker
        _add_up(maker.context.timings, made.timings)
        for each in made.of_run:
            maker.context.sink.add(each)
        if maker.cache is not None and made.made is not None and made.made.is_new:
            maker.cache.grown = True
        return made


def _add_up(whole: list[tuple[str, float]], more: Iterable[tuple[str, float]]) -> None:
    """Add the times of one cell to those of the run, with one entry for each stage."""
    seconds: dict[str, float] = {}
    for stage, took in (*whole, *more):
        seconds[stage] = seconds.get(stage, 0.0) + took
    whole[:] = seconds.items()


def _lost(cell: Cell, died: Died) -> MadeCell:
    message = f"the process that made this model {died.how}, twice"
    help = "if memory ran out, give `--jobs` a smaller number; with `--jobs 1` no other process is used"
    return MadeCell(cell, None, True, found=(Diagnostic("worker-died", message, cell.span, help=help),))

"""Draw a contact sheet: a picture of each of many cells, with several processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

from composer import engine
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.cache.making import handed_over
from composer.compose.load import Library
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.diff.operand import Operand
from composer.diff.side import load_cell
from composer.expand.matrix import Cell
from composer.limits import Limits, allow, in_force
from composer.pictures.sheet import sheet
from composer.plan.concrete import Given
from composer.processes.deferring import interruptible
from composer.processes.helper import Died
from composer.processes.pool import Pool, cores
from composer.render.render import drawn
from composer.render.wish import Wish
from composer.scratch import scratch

TILE = (320, 240)
_KEPT = "tile"
_CELLS_A_PROCESS = 2
_ENDS = ("no-rendering", "mujoco-missing")
"""Errors that apply to all cells if they apply to one."""
_MODULES = ("composer.render.contact_sheet",)
Drawn = tuple[bool, tuple[Diagnostic, ...], tuple[Path, ...]]
"""Whether a cell was drawn, its diagnostics, and the files that were read for it."""


@dataclass(frozen=True, slots=True)
class _Job:
    """What a process needs to draw cells into a folder. Can be pickled."""

    operand: Operand
    wish: Wish
    given: Given
    folder: Path
    limits: Limits

    @contextmanager
    def opened(self) -> Iterator[Callable[[tuple[int, Cell]], Drawn]]:
        """Yield, in a worker process, the function that draws a cell, by its number."""
        with allow(**asdict(self.limits)), engine.Session(rendering=True) as session:
            yield partial(self.draw, session, {})

    def draw(self, session: engine.Session, library: Library, task: tuple[int, Cell]) -> Drawn:
        number, cell = task
        own = replace(self.operand, context=replace(self.operand.context, sink=Sink()))
        with interruptible():
            side = load_cell(own, _KEPT, session, given=self.given, cell=cell, library=library)
            asked = {**self.wish.as_data(), "out": str(self.tile(number)), "tile": str(cell.name)}
            is_drawn = side is not None and drawn(_KEPT, asked, own.context, session=session)
        return is_drawn, tuple(own.context.sink.sorted()), () if side is None else side.inputs

    def tile(self, number: int) -> Path:
        return self.folder / f"{number}.npy"


def render_sheet(
    operand: Operand,
    cells: Sequence[Cell],
    out: Path,
    wish: Wish,
    session: engine.Session,
    given: Given,
    tell: Callable[[str], None],
    jobs: int | None = None,
) -> int:
    """Write one picture of all `cells`, each with its name below it; return how many are in it.

    Cells that cannot be built are left out, and their errors reported; if none is left, nothing is written. `tell`
    is called with the name of each finished cell. `jobs` is the number of processes; the default is as many as pay
    off.
    """
    context = operand.context
    tiles: list[str] = []
    read: set[Path] = set()
    workers = min(len(cells), jobs or min(cores(), max(1, len(cells) // _CELLS_A_PROCESS))) - 1
    with ExitStack() as held:
        folder = held.enter_context(scratch("pictures"))
        job = _Job(
            replace(operand, context=handed_over(context)), wish, given, folder=folder, limits=in_force()
        )
        pool = held.enter_context(Pool[tuple[int, Cell], Drawn](workers, _MODULES))
        results = pool.results(job.opened, enumerate(cells), partial(job.draw, session, {}))
        for number, (cell, result) in enumerate(zip(cells, results, strict=True)):
            tell(cell.name)
            is_drawn, found, inputs = _lost(cell, result) if isinstance(result, Died) else result
            read.update(inputs)
            if is_drawn:
                tiles.append(str(job.tile(number)))
            for each in found:
                context.sink.add_of_cell(cell.label, each)
            if any(each.code in _ENDS for each in found):
                break
        pool.end()
        return len(tiles) if tiles and _put(tiles, out, operand, session=session, read=read) else 0


def _put(tiles: list[str], out: Path, operand: Operand, session: engine.Session, read: set[Path]) -> bool:
    try:
        with staged_file(operand.context.folder / out, "-o", inputs=read) as stage:
            engine.call(session, sheet, (), argument={"tiles": tiles, "out": str(stage)})
    except OutputError as error:
        operand.context.sink.add(error.diagnostic)
        return False
    return True


def _lost(cell: Cell, died: Died) -> Drawn:
    help = "if memory ran out, give `--jobs` a smaller number; with `--jobs 1` no other process is used"
    message = f"the process that drew this model {died.how}, twice"
    return False, (Diagnostic("worker-died", message, cell.span, help=help),), ()

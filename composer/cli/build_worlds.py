"""`mjcompose build --worlds`: all models of a recipe as one bundle and a table of the numbers that differ."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.form import Form
from composer.bundle.output_error import OutputError
from composer.bundle.write import write as write_bundle
from composer.cache.builder import Maker
from composer.cache.cell_run import CellRun
from composer.cache.making import CellMaker, MadeCell
from composer.cli.built_words import said as words
from composer.cli.counting import counting
from composer.cli.matrix import chosen_cells
from composer.cli.noted import note_files
from composer.cli.reporting import FINDINGS, USAGE, report, say, say_details
from composer.cli.tally import Tally
from composer.cli.wanted import Wanted
from composer.cli.writing import put
from composer.loading.errors import LoadError
from composer.scratch import scratch
from composer.worlds import table_file
from composer.worlds.building import Shelf, is_united
from composer.worlds.joining import Joined, Joining
from composer.worlds.worlds import Worlds

if TYPE_CHECKING:
    from composer.bundle.bundle import Bundle
    from composer.context import Context
    from composer.diagnostics.span import Span
    from composer.document import Node
    from composer.engine import Session
    from composer.expand.matrix import Cell


class _Failed(Exception):
    """A cell failed, which was reported."""


def build_worlds(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    table: Path,
    context: Context,
    session: Session,
    jobs: int | None,
) -> int:
    """Build all models into `table`, and their common model if it is wanted. Return the exit code."""
    chosen, code = chosen_cells(maker.recipe, picks, only_samples, given=given, context=context, verb="build")
    if not code and wanted.kind not in (Form.FOLDER, Form.ARCHIVE):
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        context.sink.error("output-kind", f"worlds are of a bundle, and `{wanted.out}` is none", help=help)
    if not code and not chosen and not context.sink.has_errors:
        help = "write `matrix` or `randomize` into it, or build it without `--worlds`"
        context.sink.error("missing-key", f"`{maker.recipe}` is one model, which has no worlds", help=help)
    try:
        table_file.check_name(table)
    except OutputError as error:
        context.sink.add(error.diagnostic)
    if context.sink.has_errors:
        report(context, wanted.form)
        return code or USAGE
    run = _Run(maker, wanted, given, table=table, context=context, session=session)
    with scratch("worlds") as folder:
        try:
            study, bundle = run.worlds(chosen, Shelf(folder), jobs)
        except LoadError as error:
            for each in error.diagnostics:
                context.sink.add(replace(each, span=each.span or run.last))
        except _Failed:
            pass
        else:
            run.write(chosen[0], study, bundle)
    report(context, wanted.form)
    say_details(context)
    run.tally.say(wanted.form)
    return FINDINGS if context.sink.has_errors else 0


class _Run:
    """One run; `last` is where the recipe defines the last model."""

    def __init__(
        self,
        maker: Maker,
        wanted: Wanted,
        given: dict[str, Node],
        table: Path,
        context: Context,
        session: Session,
    ) -> None:
        self.maker, self.wanted, self.given = maker, wanted, given
        self.table, self.context, self.session = table, context, session
        self.tally = Tally(maker.recipe, 0)
        self.last: Span | None = None

    def worlds(self, chosen: list[Cell], shelf: Shelf, jobs: int | None) -> tuple[Worlds, Bundle | None]:
        """Return all models as worlds, and the bundle of their union if they form one. Raises LoadError."""
        self.tally.total = len(chosen)
        joining = Joining(len(chosen), is_united(self.maker.recipe, self.context))
        unwritten = Maker(
            self.maker.recipe,
            self.maker.options,
            self.maker.cache,
            context=self.context,
            form=Form.FOLDER,
            place=shelf.place,
        )
        with CellRun(CellMaker(unwritten, self.given, self.session, finish=shelf.put), jobs) as running:
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                joined = self._taken(each, shelf)
                if not joining.add(joined):
                    shelf.clear(joined)
        if len(joining.groups) == 1:
            return joining.worlds(), None
        from composer.worlds.union import unite

        self.last = None
        return unite(joining, f"{self.maker.recipe.stem}-union", self.context, session=self.session)

    def _taken(self, each: MadeCell, shelf: Shelf) -> Joined:
        note_files(each.files)
        self.last = each.cell.span
        self.tally.take(each.cell.label, each.found, self.context.sink, failed=each.failed)
        if each.made is None or each.failed:
            raise _Failed
        return shelf.take(each.made, each.cell)

    def write(self, first: Cell, study: Worlds, bundle: Bundle | None) -> None:
        """Write the bundle, and then the table; report what cannot be written."""
        try:
            said = self._put_first(first) if bundle is None else self._put(bundle, study)
            table_file.write(self.context.folder / self.table, study.nominal, study.table, option="--worlds")
        except OutputError as error:
            self.context.sink.add(error.diagnostic)
            return
        except _Failed:
            return
        say(said, form=self.wanted.form)
        numbers = sum(varying.index.size for varying in study.arrays.values())
        if self.wanted.form == "text":
            say(f"wrote {self.table}: {study.count} worlds, {numbers} numbers of {len(study.arrays)} arrays")

    def _put_first(self, first: Cell) -> str:
        """Write the model of the first cell as any build does; return the report."""
        again = CellMaker(self.maker, self.given, self.session, finish=partial(put, wanted=self.wanted)).make(
            first
        )
        if again.made is None or again.failed:
            for each in again.found:
                self.context.sink.add(each)
            raise _Failed
        return words(again.made, self.wanted)

    def _put(self, bundle: Bundle, study: Worlds) -> str:
        """Write the union of all models; return the report."""
        target = self.wanted.target(study.manifest.name, study.manifest.mujoco)
        write_bundle(bundle, self.context.folder / target, environment=self.context.environment)
        parts = ", ".join(study.table.parts)
        return f"wrote {target}\n  {study.manifest.name}: one model with the parts {parts}"

"""`mjcompose build --all`, `--pick` and `--worlds`."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import hide
from mjcompose.base.runtime import deferring
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.bundle import OutputError, OutputForm, is_address, location
from mjcompose.build.bundle.listing import COLUMNS
from mjcompose.build.bundle.write import write as write_bundle
from mjcompose.build.cache.builder import Maker
from mjcompose.build.cache.cell_run import CellMaker, CellResult, CellRun
from mjcompose.build.cache.run_table import RunTable, index_row
from mjcompose.cli.clustering import check_room, crew_of, found_no_room, stopped
from mjcompose.cli.options import Shard, chosen_cells
from mjcompose.cli.output import Wanted, add_picture, build_one, finish, kind_of_output, put, said
from mjcompose.cli.reporting import (
    FINDINGS,
    INTERRUPTED,
    USAGE,
    Tally,
    arguments,
    counting,
    note_files,
    report,
    say,
    say_details,
)
from mjcompose.tools.worlds import worlds
from mjcompose.tools.worlds.join import Joined, Joining, Shelf
from mjcompose.tools.worlds.names import LoadError
from mjcompose.tools.worlds.worlds import Worlds

if TYPE_CHECKING:
    from mjcompose.base.diagnostic import Span
    from mjcompose.build.bundle.bundle import Bundle
    from mjcompose.language.expand import Cell
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.text.node import Node

SAMPLES, MODELS = "samples", "models"

if TYPE_CHECKING:
    from mjcompose.build.cache.builder import Maker
    from mjcompose.language.expand import Cell
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.text.node import Node


def build_cells(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    context: Context,
    session: Session,
    table: str | None = None,
    jobs: int | None = None,
    shard: Shard | None = None,
    cluster: str | None = None,
    parquet: bool = False,
) -> int:
    """Build the cells, and report a fault in several cells once. Return the exit code.

    Draws are written to `table`, or by default next to the models if all are built.
    """
    recipe = maker.recipe
    chosen, code = chosen_cells(
        recipe, picks, only_samples, given=given, context=context, verb="build", worlds=maker.options.worlds
    )
    if code:
        report(context, wanted.form)
        return code
    if not chosen:
        made, why = maker.recall(maker.key(), context)
        if made is not None:
            return finish(made, maker, wanted, context=context, session=session)
        return build_one(maker, wanted, given, context=context, session=session, why=why)
    folder, code = _checked_folder(wanted, len(chosen), context)
    if code or _share_a_place(chosen, wanted, context):
        return code or FINDINGS
    if shard is not None:
        chosen = shard.of(chosen)
    beside = None if picks or only_samples else _folder(wanted.out)
    results = _Results(wanted, context, Tally(recipe, len(chosen)), beside=beside)
    putting = partial(put, wanted=replace(wanted, picturing=None))  # pictures are drawn by this process
    away = None
    if wanted.kind != "text":  # text alone refers to this machine's files
        away = partial(put, wanted=wanted.elsewhere(context.folder))
    with (
        crew_of(cluster, jobs, folder, away=away) as crew,
        CellRun(CellMaker(maker, given, session, finish=putting), jobs, crew) as running,
    ):
        try:
            # A crew records what it has done, and may wait long for it.
            patience = deferring() if crew is None else nullcontext()
            ended = _take_all(running, chosen, results, patience=patience, maker=maker)
        finally:  # also after an interruption
            results.write_tables(table, parquet, shard)
    if ended is not None:
        return ended
    report(context, wanted.form)
    say_details(context)
    results.tally.say(wanted.form)
    if wanted.form == "text" and results.tally.whole == len(chosen) and not context.sink.has_errors:
        count, known = results.tally.whole, results.tally.whole - results.new
        from_cache = f", {known} from the cache" if known else ""
        say(f"{maker.recipe}: {count} model{'s' * (count != 1)} built{from_cache}")
    return FINDINGS if context.sink.has_errors else 0


def _share_a_place(chosen: Sequence[Cell], wanted: Wanted, context: Context) -> bool:
    """Report two models that some file systems would write to one place, such as `A.zip` and `a.zip`."""
    from unicodedata import normalize

    taken: dict[str, Cell] = {}
    for cell in chosen:
        target = wanted.target(cell.name, "")
        other = taken.setdefault(normalize("NFC", target).casefold(), cell)
        if other is not cell:
            places = dict.fromkeys((wanted.target(other.name, ""), target))
            where = " and ".join(f"`{each}`" for each in places)
            if len(places) > 1:
                where += ", which are one place where the case of letters does not count"
            context.sink.error(
                "name-clash",
                f"the models `{other.name}` and `{cell.name}` would be written to {where}",
                cell.span,
                help="write another `name` into `matrix`, or build them with `--pick` into two folders",
            )
            report(context, wanted.form)
            return True
    return False


def _checked_folder(wanted: Wanted, count: int, context: Context) -> tuple[Path | str, int]:
    """Return the folder of the models, and the exit code if they cannot be written there, which is reported."""
    code, folder = USAGE, _folder(wanted.out)
    try:
        kind_of_output(wanted.out, count)  # of all shards, which write to one place
        code, place_of_models = FINDINGS, location(context.folder, folder)
        if isinstance(place_of_models, str):
            from mjcompose.build.bundle.remote import check_writable

            check_writable(place_of_models)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        report(context, wanted.form)
        return folder, code
    return place_of_models, 0


@dataclass(slots=True)
class _Results:
    """What the cells of a run gave: counts for the summary, and rows for the tables.

    The index lists paths relative to the folder `beside`. Without one, no index is written.
    """

    wanted: Wanted
    context: Context
    tally: Tally
    beside: str | None
    new: int = 0
    samples: RunTable = field(default_factory=lambda: RunTable({"model": str, "sample": int}))
    index: RunTable = field(default_factory=lambda: RunTable(COLUMNS))

    def take(self, each: CellResult) -> None:
        """Report a cell that is done, and add its rows."""
        wanted, sink = self.wanted, self.context.sink
        note_files(each.files)
        pictured = replace(self.context, sink=Sink())
        if each.result is not None and not each.failed:
            add_picture(each.result, wanted, pictured)
        failed = each.failed or pictured.sink.has_errors
        self.tally.take(each.cell.label, (*each.diagnostics, *pictured.sink.diagnostics), sink, failed=failed)
        if each.result is not None and not failed:
            say(said(each.result, wanted), form=wanted.form)
            self.new += each.result.is_new
            if each.result.draws is not None:
                self.samples.add((each.cell.name, each.cell.sample), each.result.draws)
            if self.beside is not None:
                path = os.path.relpath(wanted.target(each.result.name, each.result.mujoco), self.beside)
                self.index.add(*index_row(each.cell, each.result, path, checks=len(each.outcomes)))

    def write_tables(self, table: str | None, parquet: bool, shard: Shard | None) -> None:
        """Write the draws, to `table` if it is given, and the index."""
        forms = (".csv", ".parquet") if parquet else (".csv",)
        drawn, all_of_them = (
            [_in(self.beside, f"{name}{form}", shard) for form in forms] for name in (SAMPLES, MODELS)
        )
        form, context = self.wanted.form, self.context
        option = "--samples" if table else None
        _put_table(
            self.samples,
            [table] if table else drawn,
            "what was drawn for",
            form=form,
            context=context,
            option=option,
        )
        _put_table(self.index, all_of_them, "the index of", form=form, context=context)


def _take_all(
    running: CellRun,
    chosen: Sequence[Cell],
    results: _Results,
    patience: AbstractContextManager[None],
    maker: Maker,
) -> int | None:
    """Take the cells as they are done. Return the exit code after an interruption by the user."""
    try:
        with patience, stopped(results.context) as ended:
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                results.take(each)
                check_room(each)
        if ended:
            for each in running.finished():
                if not found_no_room(each):
                    results.take(each)
            if results.tally.whole:  # else the error alone says what to do
                click.echo(_how_to_go_on(results.tally.whole, len(chosen), maker), err=True)
    except (KeyboardInterrupt, SystemExit) as ended:
        for each in running.finished():
            results.take(each)
        click.echo(_how_to_go_on(results.tally.whole, len(chosen), maker), err=True)
        return ended.code if isinstance(ended, SystemExit) and isinstance(ended.code, int) else INTERRUPTED
    return None


def _folder(out: str) -> str:
    """Return the folder in which every model has its own name, or a folder by its hash."""
    folder = out.partition("{")[0].rpartition("/")[0]
    return folder or ("/" if out.startswith("/") else ".")


def _in(folder: str | None, name: str, shard: Shard | None) -> str | None:
    """Return the path of a table of all models in that folder, or of one shard."""
    if folder is None:
        return None
    path = f"{folder}/{name if shard is None else shard.file(name)}"
    return path if is_address(path) else os.path.normpath(path)


def _put_table(
    table: RunTable,
    paths: Iterable[str | None],
    what: str,
    form: str,
    context: Context,
    option: str | None = None,
) -> None:
    for path in paths:
        if path is None or not table.count:
            continue
        try:
            table.write(location(context.folder, path), option)
        except OutputError as error:
            known = {each.code for each in context.sink.errors}
            if error.code != "output-full" or error.code not in known:  # that error ended the run
                context.sink.add(error.diagnostic)
        else:
            if form == "text":
                say(f"wrote {hide(path)}: {what} {table.count} models")
    table.close()


def _how_to_go_on(whole: int, total: int, maker: Maker) -> str:
    command = hide(shlex.join(["mjcompose", *arguments()]))
    rest = "builds the rest" if maker.cache is not None else "builds them all"
    return f"interrupted: {whole} of {total} are written and whole; `{command}` {rest}"


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
    unites: bool,
) -> int:
    """Build all models into `table`, and their common model if it is wanted. Return the exit code.

    If it `unites` them, this is one model with the parts of all.
    """
    chosen, code = chosen_cells(
        maker.recipe,
        picks,
        only_samples,
        given=given,
        context=context,
        verb="build",
        worlds=maker.options.worlds,
    )
    if not code and wanted.kind not in (OutputForm.FOLDER, OutputForm.ARCHIVE):
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        context.sink.error("output-kind", f"worlds are of a bundle, and `{wanted.out}` is none", help=help)
    if not code and not chosen and not context.sink.has_errors:
        help = "write `matrix` or `randomize` into it, or build it without `--worlds`"
        context.sink.error("missing-key", f"`{maker.recipe}` is one model, which has no worlds", help=help)
    try:
        worlds.check_name(table)
    except OutputError as error:
        context.sink.add(error.diagnostic)
    if context.sink.has_errors:
        report(context, wanted.form)
        return code or USAGE
    run = _Run(maker, wanted, given, table=table, context=context, session=session)
    with scratch("worlds") as folder:
        try:
            study, bundle = run.worlds(chosen, Shelf(folder), jobs, unites=unites)
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

    def worlds(
        self, chosen: list[Cell], shelf: Shelf, jobs: int | None, *, unites: bool
    ) -> tuple[Worlds, Bundle | None]:
        """Return all models as worlds, and the bundle of their union if they form one. Raises LoadError."""
        self.tally.total = len(chosen)
        joining = Joining(len(chosen), unites)
        unwritten = Maker(
            self.maker.recipe,
            self.maker.options,
            self.maker.cache,
            context=self.context,
            form=OutputForm.FOLDER,
            place=shelf.place,
        )
        with CellRun(CellMaker(unwritten, self.given, self.session, finish=shelf.put), jobs) as running:
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                joined = self._taken(each, shelf)
                if not joining.add(joined):
                    shelf.clear(joined)
        if len(joining.groups) == 1:
            return joining.worlds(), None
        from mjcompose.tools.worlds.union import unite

        self.last = None
        return unite(joining, f"{self.maker.recipe.stem}-union", self.context, session=self.session)

    def _taken(self, each: CellResult, shelf: Shelf) -> Joined:
        note_files(each.files)
        self.last = each.cell.span
        self.tally.take(each.cell.label, each.diagnostics, self.context.sink, failed=each.failed)
        if each.result is None or each.failed:
            raise _Failed
        return shelf.take(each.result, each.cell)

    def write(self, first: Cell, study: Worlds, bundle: Bundle | None) -> None:
        """Write the bundle, and then the table; report what cannot be written."""
        try:
            said = self._put_first(first) if bundle is None else self._put(bundle, study)
            worlds.write(self.context.folder / self.table, study.nominal, study.table, option="--worlds")
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
        if again.result is None or again.failed:
            for each in again.diagnostics:
                self.context.sink.add(each)
            raise _Failed
        return said(again.result, self.wanted)

    def _put(self, bundle: Bundle, study: Worlds) -> str:
        """Write the union of all models; return the report."""
        target = self.wanted.target(study.manifest.name, study.manifest.mujoco)
        write_bundle(bundle, self.context.folder / target, environment=self.context.environment)
        parts = ", ".join(study.table.parts)
        return f"wrote {target}\n  {study.manifest.name}: one model with the parts {parts}"

"""`mjcompose build --all` and `--pick`: the cells of a recipe's matrix, and its samples."""

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

from composer.bundle.listing import COLUMNS
from composer.bundle.output_error import OutputError
from composer.bundle.place import is_address, place
from composer.cache.cell_run import CellRun
from composer.cache.index_row import index_row
from composer.cache.making import CellMaker, MadeCell
from composer.cache.run_table import RunTable
from composer.cli.built_words import said
from composer.cli.clustering import check_room, crew_of, found_no_room, stopped
from composer.cli.counting import counting
from composer.cli.matrix import chosen_cells
from composer.cli.noted import note_files
from composer.cli.reporting import FINDINGS, INTERRUPTED, USAGE, arguments, report, say, say_details
from composer.cli.shard import Shard
from composer.cli.tally import Tally
from composer.cli.wanted import Wanted, kind_of_output
from composer.cli.writing import add_picture, build_one, finish, put
from composer.dataclass import dataclass
from composer.diagnostics.secret import hide
from composer.diagnostics.sink import Sink
from composer.processes.deferring import deferring

SAMPLES, MODELS = "samples", "models"

if TYPE_CHECKING:
    from composer.cache.builder import Maker
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session
    from composer.expand.matrix import Cell


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
    chosen, code = chosen_cells(recipe, picks, only_samples, given=given, context=context, verb="build")
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
        code, place_of_models = FINDINGS, place(context.folder, folder)
        if isinstance(place_of_models, str):
            from composer.bundle.remote import check_writable

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

    def take(self, each: MadeCell) -> None:
        """Report a cell that is done, and add its rows."""
        wanted, sink = self.wanted, self.context.sink
        note_files(each.files)
        pictured = replace(self.context, sink=Sink())
        if each.made is not None and not each.failed:
            add_picture(each.made, wanted, pictured)
        failed = each.failed or pictured.sink.has_errors
        self.tally.take(each.cell.label, (*each.found, *pictured.sink.diagnostics), sink, failed=failed)
        if each.made is not None and not failed:
            say(said(each.made, wanted), form=wanted.form)
            self.new += each.made.is_new
            if each.made.draws is not None:
                self.samples.add((each.cell.name, each.cell.sample), each.made.draws)
            if self.beside is not None:
                path = os.path.relpath(wanted.target(each.made.name, each.made.mujoco), self.beside)
                self.index.add(*index_row(each.cell, each.made, path, checks=len(each.outcomes)))

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
            table.write(place(context.folder, path), option)
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

"""`mjcompose build --all`, `--pick` and `--worlds`, with the table of all models."""

from __future__ import annotations

import itertools
import json
import os
import shlex
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import field, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from typing import IO, TYPE_CHECKING, Any

import click

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span, hide
from mjcompose.base.files import own_name
from mjcompose.base.runtime import deferring
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import Bundle, Location, OutputError, OutputForm, is_address, location
from mjcompose.bundle.listing import COLUMNS, SIZES, column, write_rows
from mjcompose.bundle.staging import check_own_place, staged_file
from mjcompose.bundle.write import write as write_bundle
from mjcompose.cli.cells import FullError, Shard, Tally, counting, found_no_room, stopped
from mjcompose.cli.output import OutputSpec, Task, add_picture, kind_of_output, put, report_of
from mjcompose.cli.reporting import FINDINGS, INTERRUPTED, USAGE, arguments, note_files, note_output, say, say_details
from mjcompose.cli.run import Stop
from mjcompose.language.expand import Cell
from mjcompose.pipeline.cache.builder import BuildResult, Maker
from mjcompose.pipeline.cache.cell_run import CellMaker, CellResult, CellRun
from mjcompose.sources.context import Context
from mjcompose.text.expression import Value
from mjcompose.tools.worlds import worlds
from mjcompose.tools.worlds.join import Joined, Joining, Shelf
from mjcompose.tools.worlds.names import LoadError
from mjcompose.tools.worlds.worlds import Worlds

if TYPE_CHECKING:
    from mjcompose.cli.build import BuildCommandOptions
    from mjcompose.language.expand import Cell


SAMPLES = "samples"
MODELS = "models"


def build_cells(task: Task, options: BuildCommandOptions) -> int:
    """Build the cells, and report a fault in several cells once. Return the exit code."""
    maker = task.maker
    spec = task.spec
    run = task.run
    context = task.run.context
    chosen, code = _chosen(task, options)
    if code:
        return code
    if not chosen:
        result, why = maker.recall(maker.key(), context)
        return task.build_one(why) if result is None else task.finish(result)
    folder = _checked_folder(task, len(chosen))
    _check_names(chosen, task)
    workers = options.workers
    if workers.shard is not None:
        chosen = workers.shard.of(chosen)
    beside = None if options.cells.picks or options.cells.only_samples else _folder(spec.out)
    results = _Results(spec, context, Tally(maker.recipe, len(chosen)), beside=beside)
    putting = partial(put, spec=replace(spec, picturing=None))  # pictures are drawn by this process
    away = None
    if spec.kind != "text":  # text alone refers to this machine's files
        away = partial(put, spec=spec.elsewhere(context.folder))
    assert task.session is not None
    with (
        workers.started(folder, away=away) as crew,
        CellRun(CellMaker(maker, task.given, task.session, finish=putting), workers.jobs, crew) as running,
    ):
        try:
            # Workers record their results, and may wait long for that.
            patience = deferring() if crew is None else nullcontext()
            ended = _take_all(running, chosen, results, patience=patience, maker=maker)
        finally:  # also after an interruption
            results.write_tables(options.samples, options.parquet, workers.shard)
    if ended is not None:
        run.is_reported = True  # after an interruption by the user
        return ended
    run.report()
    say_details(context)
    results.tally.say(run.form)
    if run.form == "text" and results.tally.whole == len(chosen) and not context.sink.has_errors:
        known = results.tally.whole - results.new
        from_cache = f", {known} from the cache" if known else ""
        say(f"{maker.recipe}: {counted(results.tally.whole, 'model')} built{from_cache}")
    return FINDINGS if context.sink.has_errors else 0


def _chosen(task: Task, options: BuildCommandOptions) -> tuple[list[Cell], int]:
    recipe = task.maker.recipe
    worlds = task.maker.options.worlds
    return options.cells.chosen(recipe, task.given, context=task.run.context, verb="build", worlds=worlds)


def _check_names(chosen: Sequence[Cell], task: Task) -> None:
    """End the command if some file systems would write two models to one place, such as `A.zip` and `a.zip`."""
    from unicodedata import normalize

    taken: dict[str, Cell] = {}
    for cell in chosen:
        target = task.spec.target(cell.name, "")
        other = taken.setdefault(normalize("NFC", target).casefold(), cell)
        if other is not cell:
            places = dict.fromkeys((task.spec.target(other.name, ""), target))
            where = " and ".join(f"`{each}`" for each in places)
            where += ", which many file systems treat as one" if len(places) > 1 else ""
            message = f"the models `{other.name}` and `{cell.name}` would be written to {where}"
            help = "write another `name` into `matrix`, or build them with `--pick` into two folders"
            task.run.context.sink.error("name-clash", message, cell.span, help=help)
            raise Stop(FINDINGS)


def _checked_folder(task: Task, count: int) -> Path | str:
    spec = task.spec
    run = task.run
    with run.stopping(USAGE):
        kind_of_output(spec.out, count)  # of all shards, which write to one place
    with run.stopping(FINDINGS):
        folder = location(run.context.folder, _folder(spec.out))
        if isinstance(folder, str):
            from mjcompose.bundle.remote import check_writable

            check_writable(folder)
    return folder


class _Results(Struct, frozen=False):
    """Counts for the summary of a run, and rows for its tables. Paths in the index are relative to `beside`, if set."""

    spec: OutputSpec
    context: Context
    tally: Tally
    beside: str | None
    new: int = 0
    samples: RunTable = field(default_factory=lambda: RunTable({"model": str, "sample": int}))
    index: RunTable = field(default_factory=lambda: RunTable(COLUMNS))

    def take(self, each: CellResult) -> None:
        spec = self.spec
        sink = self.context.sink
        note_files(each.files)
        pictured = replace(self.context, sink=Sink())
        if each.result is not None and not each.failed:
            add_picture(each.result, spec, pictured)
        failed = each.failed or pictured.sink.has_errors
        self.tally.take(each.cell.label, (*each.diagnostics, *pictured.sink.diagnostics), sink, failed=failed)
        if each.result is not None and not failed:
            note_output(spec.target(each.result.name, each.result.mujoco))
            say(report_of(each.result, spec), form=spec.form)
            self.new += each.result.is_new
            if each.result.draws is not None:
                self.samples.add((each.cell.name, each.cell.sample), each.result.draws)
            if self.beside is not None:
                path = os.path.relpath(spec.target(each.result.name, each.result.mujoco), self.beside)
                self.index.add(*index_row(each.cell, each.result, path, checks=len(each.outcomes)))

    def write_tables(self, table: str | None, parquet: bool, shard: Shard | None) -> None:
        forms = (".csv", ".parquet") if parquet else (".csv",)
        drawn, index = ([_in(self.beside, f"{name}{form}", shard) for form in forms] for name in (SAMPLES, MODELS))
        option = "--sample-table" if table else None
        self._put_table(self.samples, [table] if table else drawn, "the draws of", option=option)
        self._put_table(self.index, index, "the index of")

    def _put_table(self, table: RunTable, paths: Iterable[str | None], what: str, *, option: str | None = None) -> None:
        for path in paths:
            if path is None or not table.count:
                continue
            try:
                if option is None and not is_address(path):
                    check_own_place(self.context.folder / path)
                table.write(location(self.context.folder, path), option)
            except OutputError as error:
                known = {each.code for each in self.context.sink.errors}
                if error.code != "output-full" or error.code not in known:  # that error ended the run
                    self.context.sink.add(error.diagnostic)
            else:
                if self.spec.form == "text":
                    say(f"wrote {hide(path)}: {what} {table.count} models")
        table.rows.close()


def _take_all(
    running: CellRun, chosen: Sequence[Cell], results: _Results, patience: AbstractContextManager[None], maker: Maker
) -> int | None:
    """Take the cells as they finish. Return the exit code after an interruption by the user."""
    try:
        with patience, stopped(results.context) as ended:
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                results.take(each)
                if found_no_room(each):  # which has been reported
                    raise FullError("output-full", "there is no room for more models")
        if ended:
            for each in running.finished():
                if not found_no_room(each):
                    results.take(each)
            if results.tally.whole:  # else the error alone says what to do
                _say_how_to_go_on(results.tally.whole, len(chosen), maker)
    except (KeyboardInterrupt, SystemExit) as ended:
        for each in running.finished():
            results.take(each)
        _say_how_to_go_on(results.tally.whole, len(chosen), maker)
        return ended.code if isinstance(ended, SystemExit) and isinstance(ended.code, int) else INTERRUPTED
    return None


def _folder(out: str) -> str:
    """Return the folder in which every model has its own name, or a folder by its hash."""
    return out.partition("{")[0].rpartition("/")[0] or ("/" if out.startswith("/") else ".")


def _in(folder: str | None, name: str, shard: Shard | None) -> str | None:
    if folder is None:
        return None
    path = f"{folder}/{name if shard is None else shard.file(name)}"
    return path if is_address(path) else os.path.normpath(path)


def _say_how_to_go_on(whole: int, total: int, maker: Maker) -> None:
    command = hide(shlex.join(["mjcompose", *arguments()]))
    rest = "builds the rest" if maker.cache is not None else "builds them all"
    click.echo(f"interrupted: {whole} of {total} are written and whole; `{command}` {rest}", err=True)


class _Failed(Exception):
    pass


def build_worlds(task: Task, options: BuildCommandOptions, table: Path | None) -> int:
    """Build all models as worlds of one model, with their table in `table` or in its bundle. Return the exit code."""
    spec = task.spec
    context = task.run.context
    chosen, code = _chosen(task, options)
    if not code and spec.kind not in (OutputForm.FOLDER, OutputForm.ARCHIVE):
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        context.sink.error("output-kind", f"worlds need a bundle, and `{spec.out}` is not a bundle", help=help)
    if not code and not chosen and not context.sink.has_errors:
        help = "write `matrix` or `randomize` into it, or build it without `--worlds`"
        context.sink.error("missing-key", f"`{task.maker.recipe}` is one model and has no worlds", help=help)
    with context.sink:
        if table is not None:
            worlds.check_name(table)
    task.run.check(code or USAGE)
    joint = _Worlds(task, table)
    with scratch("worlds") as folder, suppress(_Failed), context.sink:
        try:
            study, bundle = joint.worlds(chosen, Shelf(folder), options)
        except LoadError as error:
            for each in error.diagnostics:
                context.sink.add(replace(each, span=each.span or joint.last))
        else:
            joint.write(chosen[0], study, bundle)
    task.run.report()
    say_details(context)
    joint.tally.say(spec.form)
    return FINDINGS if context.sink.has_errors else 0


class _Worlds:
    def __init__(self, task: Task, table: Path | None) -> None:
        self.task = task
        self.table = table
        self.context = task.run.context
        self.tally = Tally(task.maker.recipe, 0)
        self.last: Span | None = None

    def worlds(self, chosen: list[Cell], shelf: Shelf, options: BuildCommandOptions) -> tuple[Worlds, Bundle | None]:
        """Return all models as worlds, and the bundle of their common model if it is new. Raises LoadError."""
        self.tally.total = len(chosen)
        joining = Joining(len(chosen), groups_cells=True, unites=options.gives == "union")
        maker = self.task.maker
        session = self.task.session
        assert session is not None
        context = self.context
        form = OutputForm.FOLDER
        unwritten = Maker(maker.recipe, maker.options, maker.cache, context=context, form=form, place=shelf.place)
        making = CellMaker(unwritten, self.task.given, session, finish=shelf.put)
        with CellRun(making, options.workers.jobs) as running:
            for each in counting(running.made(chosen), len(chosen), lambda each: each.cell.name):
                joined = self._taken(each, shelf)
                if not joining.add(joined):
                    shelf.clear(joined)
        self.last = None
        from mjcompose.tools.worlds.combine import combine
        from mjcompose.tools.worlds.one_tree import JointPlace

        study, bundle = combine(joining, JointPlace(shelf.folder, own_name(maker.recipe), self.context, session))
        if bundle is None and self.table is None:
            bundle = shelf.read(joining.groups[0].first)
        return study, bundle

    def _taken(self, each: CellResult, shelf: Shelf) -> Joined:
        note_files(each.files)
        self.last = each.cell.span
        self.tally.take(each.cell.label, each.diagnostics, self.context.sink, failed=each.failed)
        if each.result is None or each.failed:
            raise _Failed
        return shelf.take(each.result, each.cell)

    def write(self, first: Cell, study: Worlds, bundle: Bundle | None) -> None:
        """Write the bundle, and then the table. Raises OutputError and _Failed."""
        if self.table is None:
            assert bundle is not None
            say(self._put(worlds.with_table(bundle, study.nominal, study.table), study), form=self.task.spec.form)
            return
        words = self._put_first(first) if bundle is None else self._put(bundle, study)
        worlds.write(self.context.folder / self.table, study.nominal, study.table, option="--worlds")
        note_output(str(self.table))
        say(words, form=self.task.spec.form)
        numbers = sum(varying.index.size for varying in study.arrays.values())
        if self.task.spec.form == "text":
            say(f"wrote {self.table}: {study.count} worlds, {numbers} numbers of {len(study.arrays)} arrays")

    def _put_first(self, first: Cell) -> str:
        task = self.task
        assert task.session is not None
        again = CellMaker(task.maker, task.given, task.session, finish=partial(put, spec=task.spec)).make(first)
        if again.result is None or again.failed:
            self.context.sink.extend(again.diagnostics)
            raise _Failed
        note_output(self.task.spec.target(again.result.name, again.result.mujoco))
        return report_of(again.result, self.task.spec)

    def _put(self, bundle: Bundle, study: Worlds) -> str:
        target = self.task.spec.target(study.manifest.name, study.manifest.mujoco)
        write_bundle(bundle, self.context.folder / target, environment=self.context.environment)
        note_output(target)
        if study.table.parts:
            return f"wrote {target}\n  {study.manifest.name}: one model with the parts {', '.join(study.table.parts)}"
        return f"wrote {target}\n  {study.manifest.name}: {study.summary()}"


Row = tuple[list[Value | None], dict[str, Value]]


def index_row(cell: Cell, result: BuildResult, path: str, checks: int) -> Row:
    """Return the values of the columns that every model has (`bundle/listing.py`), and the other columns by name.

    The latter are the values of the matrix and of draws, with one column for each number of a vector.
    """
    sizes = result.sizes or {}
    sample = cell.sample if cell.is_sample else None
    about = [cell.name, cell.cell, sample, path.replace(os.sep, "/"), result.sha256, result.mujoco, checks]
    given = {name: value for name, value in cell.values().items() if value is not None}
    found: dict[str, Value] = {}
    for name, value in {**given, **(result.draws or {})}.items():
        if isinstance(value, tuple):
            found |= {f"{column(name)}[{number}]": each for number, each in enumerate(value)}
        else:
            found[column(name)] = value
    return [*about, *(sizes.get(name) for name in SIZES)], found


_BATCH = 1000


class RunTable:
    """Keeps rows in a temporary file until all columns are known, so memory use stays constant.

    `first` are the columns that every row has, with their types. Missing values are empty.
    """

    def __init__(self, first: Mapping[str, type]) -> None:
        self._first = dict(first)
        self.rows: IO[str] = tempfile.TemporaryFile("w+", encoding="utf-8")  # noqa: SIM115  (`_put_table` closes it)
        self._columns: dict[str, type] = {}
        self.count = 0

    def add(self, first: Sequence[Value | None], row: Mapping[str, Value]) -> None:
        for name, value in row.items():
            if self._columns.setdefault(name, _kind(value)) is not _kind(value):
                self._columns[name] = str
        self.rows.write(json.dumps([*first, dict(row)]) + "\n")
        self.count += 1

    def write(self, path: Location, option: str | None = None) -> None:
        """Write all rows, as Parquet if the name says so, completely or not at all. Raises OutputError."""
        if not isinstance(path, Path):
            from mjcompose.bundle.remote import deliver_file

            with scratch("table") as folder:
                table = folder / PurePosixPath(path).name
                self.write(table)
                deliver_file(table, path)
            return
        columns = [*self._first, *self._columns]
        with staged_file(path, option) as stage:
            if path.suffix.lower() == ".parquet":
                self._write_parquet(stage, columns)
            else:
                with stage.open("w", encoding="utf-8", newline="") as file:
                    write_rows(file, columns, self._read())

    def _read(self) -> Iterator[list[Any]]:
        self.rows.seek(0)
        for line in self.rows:
            *first, row = json.loads(line)
            yield [*first, *(row.get(name) for name in self._columns)]

    def _write_parquet(self, stage: Path, columns: Sequence[str]) -> None:
        check_parquet()
        import pyarrow
        from pyarrow import parquet

        types = {str: pyarrow.string(), float: pyarrow.float64(), int: pyarrow.int64()}
        kinds: list[type] = [*self._first.values(), *self._columns.values()]
        schema = pyarrow.schema(zip(columns, map(types.__getitem__, kinds), strict=True))
        with parquet.ParquetWriter(stage, schema) as writer:
            rest = self._read()
            while rows := list(itertools.islice(rest, _BATCH)):
                filled = [
                    [None if each is None else kind(each) for each in column]
                    for kind, column in zip(kinds, zip(*rows, strict=True), strict=True)
                ]
                writer.write_table(pyarrow.table(filled, schema=schema))


def check_parquet() -> None:
    """Raise OutputError if the package that writes Parquet is not installed."""
    if find_spec("pyarrow") is None:
        help = 'run `pip install "mjcompose[parquet]"`, or write a `.csv`'
        raise OutputError("output-kind", "a Parquet table needs the package `pyarrow`", help)


def _kind(value: Value) -> type:
    return str if isinstance(value, str | bool) else int if isinstance(value, int) else float

"""A worker's side: messages, the journal, and the processes that make models.

Dask's own process reads no models and unpickles no jobs: it passes cells to processes of mjcompose, one for each of its
threads, with the limits of the run. `client.py` calls functions without a leading underscore through Dask.

The journal has the models that workers with disks of their own wrote, until the client has them in its cache: if the
client is killed, the next run finds them. Entries are signed with a key in the client's store.
"""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import hmac
import json
import os
import pickle
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.base.guard import limit
from mjcompose.base.processes import Helper, Opening
from mjcompose.base.scratch import scratch
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.read import ReadError, read
from mjcompose.bundle.remote import check_writable
from mjcompose.bundle.staging import staged_file
from mjcompose.language.expand import Cell
from mjcompose.pipeline.cache.cache import Record, from_json, to_json
from mjcompose.pipeline.cache.cache_key import FileState, FileStates, file_state
from mjcompose.pipeline.cache.cell_run import CellMaker, CellResult
from mjcompose.sources import blobs
from mjcompose.sources.kinds import KINDS
from mjcompose.sources.store import Store
from mjcompose.tools.cluster.uploads import MirrorContents, lay_out, loaded, rooted, without_root

_FOLDER = ".mjcompose-cluster"
_LARGEST = 64 << 20
_READABLE = ("folder", "archive")  # the forms of output whose contents can be compared with a record


class Journal(Struct):
    """The journal of a run, in the folder of its models; `run` is the digest of the inputs that all cells share."""

    folder: Path
    run: str
    key: bytes

    def note(self, cell: str, record: Record, inputs: Sequence[FileState]) -> None:
        data = [self.run, cell, to_json(record).decode(), [each.as_data() for each in inputs]]
        text = json.dumps(data, ensure_ascii=True).encode()
        with contextlib.suppress(OutputError, OSError), staged_file(self._place(cell)) as stage:
            stage.write_bytes(self._signed(text) + text)

    def take(self, cell: Cell, making: CellMaker, packages: Sequence[tuple[str, str, str]]) -> bool:
        """Move a completely written model from the journal to the cache; return whether there is one."""
        try:
            text = read_regular(self._place(cell.name), _LARGEST, is_source=False)
            size = len(self._signed(b""))
            if not hmac.compare_digest(self._signed(text[size:]), text[:size]):
                return False
            run, name, record_text, inputs = json.loads(text[size:])
            record = from_json(record_text.encode())
            target = making.maker.place(record.name, record.mujoco)
            if (run, name) != (self.run, cell.name) or not isinstance(target, Path):
                return False
            if making.maker.form not in _READABLE or read(target).sha256 != record.sha256:
                return False
            making.keep(cell, record, [file_state(each) for each in inputs], packages=packages)
        except (OSError, ReadError, ValueError, TypeError, KeyError, RecursionError):
            return False
        self.forget(cell.name)
        return True

    def forget(self, cell: str) -> None:
        with contextlib.suppress(OSError):
            self._place(cell).unlink(missing_ok=True)

    def end(self) -> None:
        with contextlib.suppress(OSError):
            (self.folder / _FOLDER).rmdir()

    def _place(self, cell: str) -> Path:
        return self.folder / _FOLDER / f"{hashlib.sha256(cell.encode()).hexdigest()[:40]}.json"

    def _signed(self, text: bytes) -> bytes:
        return hmac.new(self.key, text, hashlib.sha256).hexdigest().encode() + b"\n"


def journal_of(making: CellMaker, folder: object) -> Journal | None:
    """Return the journal of a run; None without a cache, which gets its entries, or without a folder for the models."""
    cache = making.maker.cache
    key = making.maker.key()
    if cache is None or key is None or not isinstance(folder, Path) or making.finish is None:
        return None
    name = blobs.key_of(["the key of journals"])
    secret = blobs.get(cache.store.folder, "asked", name)
    if secret is None:
        secret = os.urandom(32)
        with contextlib.suppress(OSError):
            blobs.put(cache.store.folder, "asked", name, content=secret)
    return Journal(folder, key.digest, secret)


class Canary(Struct):
    """A cell that is made only to check that a worker makes the same model; it is not written."""

    cell: Cell
    sha256: str


class WorkOrder(Struct):
    """The data that a worker needs before it makes cells of a run.

    `job` is a pickled `Job`, `folder` is its working folder, and `files` are the input files with their state. `store`
    and `out` are files of this run that a worker sees only if it shares the disk: in the store, and at the place of the
    models, which may be an `address`. A worker that sees them works like a process of this machine. Others get the
    files in `layout`, and `away`, another Job; `canary` checks that this gives the same model, and `is_tried` says that
    the client tried to make a canary. They record in `journal` the models that they wrote. `memory` limits each process
    that makes models, in bytes.
    """

    run: str
    job: bytes
    away: bytes | None
    folder: str
    memory: int
    files: tuple[FileState, ...]
    layout: MirrorContents
    store: str | None = None
    out: str | None = None
    address: str | None = None
    canary: Canary | None = None
    is_tried: bool = False
    journal: Journal | None = None


class CellBatch(Struct):
    """Some cells that one worker makes, one after another; `numbers` are their numbers, and `tries` counts attempts."""

    numbers: tuple[int, ...]
    cells: tuple[Cell, ...]
    tries: int = 0


class Away(Struct):
    """A result from a worker that does not share the disk of this machine, and the data for the cache here."""

    cell: CellResult
    record: Record | None
    inputs: tuple[FileState, ...]


class UnknownRun(Struct):
    """The answer of a worker that does not know the run yet."""

    worker: str


class Lacks(Struct):
    """The answer of a worker that first needs these contents, by their sha256, and the canary."""

    contents: tuple[str, ...]


class RunRefusal(Struct):
    """The reason that a worker cannot make the models."""

    message: str
    help: str | None = None


@contextmanager
def opened(memory: int, job: bytes) -> Iterator[Callable[[Any], Any]]:
    """Open the work of a pickled Job, in a process limited to this many bytes: Dask does not limit its children."""
    limit(memory, 0)
    with pickle.loads(job).opened() as make:
        yield make


@contextmanager
def opened_away(
    memory: int, job: bytes, root: str, store: str, journal: Journal | None = None
) -> Iterator[Callable[[Any], Any]]:
    """Open a job whose files are a mirror below `root`; cached results go to a store of this worker."""
    limit(memory, 0)
    here = loaded(job, root)
    context = here.context
    is_cached = here.store is not None
    environment = dict(context.environment)
    for name in ("MJCOMPOSE_CACHE", *(each for kind in KINDS for each in kind.variables)):
        path = f"{root}{environment.get(name, '')}"
        if environment.get(name, "").startswith("/") and os.path.isdir(path):
            environment[name] = path
    here = replace(here, context=replace(context, environment=environment), store=Store(Path(store)))
    kept: list[tuple[Record, tuple[FileState, ...]]] = []
    trial = replace(here, finish=None, store=None)  # a trial leaves nothing in the cache
    with here.opened(lambda *each: kept.append(each)) as make, trial.opened() as try_out:

        def made(task: Any) -> Any:
            if isinstance(task, Canary):
                found = try_out(task.cell)
                return None if found.result is None else found.result.sha256
            kept.clear()
            cell = without_root(make(task), root)
            if not is_cached and cell.result is not None:  # the store is of this run: you have no cache
                cell = replace(cell, result=replace(cell.result, is_new=True))
            # Kept for the cell, with its recipes, and then for its plan; of sources that may move, for the plan alone.
            record, inputs = kept[0] if len(kept) > 1 else (None, ())
            away = Away(cell, without_root(record, root), without_root(inputs, root))
            if journal is not None and away.record is not None and not cell.failed:
                journal.note(cell.cell.name, away.record, away.inputs)
            return away

        yield made


MODULES = (
    "mjcompose.pipeline.cache.cell_run",
    "mjcompose.pipeline.stages",
    "mjcompose.verify.run_checks",
    "mjcompose.verify.compile",
)
_IDLE = 600.0  # seconds without work after which an unclosed run is considered over
_CONTENTS = "mjcompose-sources"
_SHIPPED = "MJCOMPOSE_SHIPPED"  # a worker with this variable reads no files of its machine: all files are sent to it
_stations: dict[str, Station] = {}
_lock = threading.Lock()


class Station:
    """The processes of one run in this worker."""

    def __init__(self, run: str, opening: Opening[Any, Any], folder: str, held: ExitStack) -> None:
        self._opening = pickle.dumps(opening)
        self._folder = folder
        self._held = held
        self._helpers: list[Helper] = []
        self._idle: list[Helper] = []
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._used = time.monotonic()
        self._ended = False
        threading.Thread(target=self._watch, args=(run,), daemon=True).start()

    def made(self, cells: Sequence[Any]) -> list[Any]:
        with self._helper() as helper:
            return [helper.result(self._opening, cell) for cell in cells]

    def end(self) -> None:
        self._over.set()
        with self._lock:
            self._ended = True
            helpers = self._helpers
        for helper in helpers:
            helper.ask_to_end()
        for helper in helpers:
            helper.end()
        self._held.close()

    @contextmanager
    def _helper(self) -> Iterator[Helper]:
        with self._lock:
            if self._idle:
                helper = self._idle.pop()
            else:
                helper = Helper(MODULES, self._folder)
                helper.ends = self._ended
                self._helpers.append(helper)
        try:
            yield helper
        finally:
            with self._lock:
                self._idle.append(helper)
                self._used = time.monotonic()

    def _watch(self, run: str) -> None:
        while not self._over.wait(_IDLE / 10):
            with self._lock:
                is_idle = len(self._idle) == len(self._helpers) and time.monotonic() - self._used > _IDLE
            if is_idle:
                _close(run)


async def begin(order: WorkOrder, dask_worker: Any) -> RunRefusal | Lacks | None:
    """Get ready for a run, or return the obstacle. Dask passes the worker to a parameter of that name."""
    return await asyncio.to_thread(_begin, order, Path(dask_worker.local_directory) / _CONTENTS)


async def receive(contents: Mapping[str, bytes], dask_worker: Any) -> None:
    await asyncio.to_thread(_keep, contents, Path(dask_worker.local_directory) / _CONTENTS)


def make(run: str, cells: Sequence[Any]) -> list[Any] | UnknownRun:
    from distributed import get_worker

    with _lock:
        station = _stations.get(run)
    return UnknownRun(get_worker().address) if station is None else station.made(cells)


async def close(run: str) -> None:
    await asyncio.to_thread(_close, run)


def _begin(order: WorkOrder, contents: Path) -> RunRefusal | Lacks | None:
    with _lock:
        if order.run in _stations:
            return None
    if order.out is not None and not os.path.exists(order.out):
        folder = os.path.dirname(os.path.dirname(order.out))
        help = "write to a folder that all machines share, or to an address such as `-o 's3://bucket/{name}.zip'`"
        return RunRefusal(f"does not see the folder `{folder}` for the models", help)
    if order.address is not None:
        try:
            check_writable(order.address)
        except OutputError as error:
            return RunRefusal(error.message, error.help)
    has_store = order.store is None or os.path.exists(order.store)
    look = FileStates().look
    if not os.environ.get(_SHIPPED) and has_store and all(look(each.path).state == each.state for each in order.files):
        station = Station(order.run, partial(opened, order.memory, order.job), order.folder, held=ExitStack())
    else:
        lacking = [each for each in order.layout.files.values() if not os.path.exists(contents / each)]
        if lacking or not order.is_tried:
            return Lacks(tuple(dict.fromkeys(lacking)))
        away = _away(order, contents)
        if isinstance(away, RunRefusal):
            return away
        station = away
    with _lock:
        _stations[order.run] = station
    return None


def _away(order: WorkOrder, contents: Path) -> Station | RunRefusal:
    if order.away is None:
        message = "does not have the files of the models, which MJCF alone only names"
        return RunRefusal(message, "write bundles, such as `-o 'build/{name}.zip'`")
    with ExitStack() as opened:
        folder = opened.enter_context(scratch("cluster"))
        root = folder / "mirror"
        root.mkdir()
        lay_out(order.layout, root, contents.joinpath)
        work = rooted(Path(order.folder), str(root))
        work.mkdir(parents=True, exist_ok=True)
        opening = partial(opened_away, order.memory, order.away, str(root), str(folder / "store"), order.journal)
        station = Station(order.run, opening, str(work), held=opened.pop_all())
    if order.canary is not None:
        (answer,) = station.made([order.canary])
        if answer != order.canary.sha256:
            station.end()
            message = f"makes another model of the same files: `{order.canary.cell.name}` has other bytes there"
            return RunRefusal(message, "use one image or one environment for all workers and this machine")
    return station


def _keep(contents: Mapping[str, bytes], folder: Path) -> None:
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    for digest, content in contents.items():
        if hashlib.sha256(content).hexdigest() != digest:
            raise ValueError("the content does not have the announced sha256")
        stage = folder / f".{digest}.{os.urandom(6).hex()}"
        stage.write_bytes(content)
        stage.replace(folder / digest)


def _close(run: str) -> None:
    with _lock:
        station = _stations.pop(run, None)
    if station is not None:
        station.end()

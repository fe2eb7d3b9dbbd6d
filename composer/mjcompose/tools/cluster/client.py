"""Cells of a run on the workers of a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import os
import pickle
import re
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeAlias

from mjcompose.base.limits import in_force
from mjcompose.base.processes import Died, Undone
from mjcompose.base.scratch import scratch
from mjcompose.bundle.bundle import Location, unwritable_error
from mjcompose.bundle.staging import stage_beside
from mjcompose.language.expand import Cell
from mjcompose.pipeline.cache.cell_run import CellMaker, CellResult, Finish, Job
from mjcompose.pipeline.cache.inputs import PACKAGES
from mjcompose.tools.cluster import worker as station
from mjcompose.tools.cluster.uploads import ClusterError, away_job, batches, freight_of
from mjcompose.tools.cluster.worker import Away, Canary, CellBatch, Lacks, RunRefusal, UnknownRun, WorkOrder, journal_of

Client: TypeAlias = Any  # a `distributed.Client`
LOCAL = "local"
_ADDRESS = re.compile(r"(?:(?:tcp|tls|ws|wss|ucx)://)?[^/\s]+:\d+")
_SECONDS_TO_CONNECT = 15
_IDLE = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "10s",
}
"""Without these settings, idle processes of Dask use a tenth of a core."""


@contextmanager
def client_of(text: str, workers: int) -> Iterator[Client]:
    """Yield a client of the cluster that a text names; `local` starts this many workers here. Raises ClusterError."""
    try:
        import distributed
    except ImportError:
        raise _missing("distributed") from None
    with _silence():
        if text == LOCAL:
            with _local(distributed, workers) as cluster, distributed.Client(cluster, set_as_default=False) as client:
                yield client
            return
        client = connected(text)
        try:
            yield client
        finally:
            client.close(timeout=2)


def _missing(package: str) -> ClusterError:
    message = f"`--cluster` needs the Python package `{package}`, which is not installed"
    return ClusterError("cluster-missing", message, 'run `pip install "mjcompose[cluster]"`')


@contextmanager
def _silence() -> Iterator[None]:
    """Silence Dask's messages: mjcompose reports errors itself, and Dask would repeat them from several threads."""
    before = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)


def connected(text: str) -> Client:
    """Return a client of a running cluster. Raises ClusterError."""
    import distributed

    known: dict[str, str] = {}
    if os.path.exists(text):
        known["scheduler_file"] = text
    elif _ADDRESS.fullmatch(text):
        known["address"] = text
    else:
        message = f"`{text}` is not a cluster: it is neither a file nor an address"
        file = "the file that `dask scheduler --scheduler-file FILE` writes"
        help = f"write `local`, an address such as `tls://head:8786`, or {file}"
        raise ClusterError("cluster-unreachable", message, help)

    class Connection(distributed.Client):  # type: ignore[misc]  # its types are not checked
        def __del__(self) -> None:
            """Do nothing: Dask's method waits for half a minute if there was never a connection."""

    try:
        return Connection(**known, timeout=_SECONDS_TO_CONNECT, set_as_default=False)
    except Exception as error:  # Dask does not check whether a scheduler wrote the file, and fails later
        message = f"no scheduler of Dask answers at `{text}`"
        reach = "runs there and that you can reach its port"
        help = f"check that `dask scheduler` {reach}; `tls:` needs the keys of the cluster in Dask's configuration"
        raise ClusterError("cluster-unreachable", message, help, notes=(_words(error),)) from error


def _words(error: BaseException) -> str:
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def _local(distributed: Any, workers: int) -> Iterator[Any]:
    """Start workers on this machine. Only this process has their key, because anyone who connects can run programs."""
    from dask import config
    from distributed.security import Security

    try:
        security = Security.temporary()
    except ImportError:  # Dask installs without it
        raise _missing("cryptography") from None
    # If it is killed, Dask leaves folders and lock files of its scheduler and workers; the next run sweeps ours.
    with (
        scratch("dask") as folder,
        config.set({**_IDLE, "temporary-directory": str(folder)}),
        distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=None,
            memory_limit=0,
            security=security,
            silence_logs=logging.CRITICAL,
            worker_dashboard_address=None,
        ) as cluster,
    ):
        yield cluster


_HELP = {
    "mjcompose": 'install the same mjcompose there: `pip install "mjcompose[cluster]"`, or the same checkout',
    "Python": "run its workers with the same Python, in which only the last number may differ",
}


def versions(packages: tuple[str, ...]) -> dict[str, str]:
    """Return the versions that a model's bytes depend on, besides its sources: mjcompose's code, packages, zlib.

    Packages that are not installed are left out. Its code is sent to workers, which may lack mjcompose: so it uses
    nothing from this module.
    """
    import contextlib
    import hashlib
    import importlib.util
    import os
    import re
    import zlib
    from importlib import metadata

    found = {"zlib": zlib.ZLIB_RUNTIME_VERSION}
    for name in packages:
        with contextlib.suppress(metadata.PackageNotFoundError):
            found[name] = metadata.version(name)
    spec = importlib.util.find_spec("mjcompose")
    if spec is None or spec.origin is None:
        return found
    package = os.path.dirname(spec.origin)
    digest = hashlib.sha256()
    for folder, folders, names in os.walk(package):
        folders.sort()
        for name in sorted(name for name in names if name.endswith(".py")):
            with open(os.path.join(folder, name), "rb") as file:
                digest.update(name.encode() + hashlib.sha256(file.read()).digest())
    with open(os.path.join(package, "base", "__init__.py"), encoding="utf-8") as file:
        written = re.findall(r'^__version__ = "(.+)"$', file.read(), re.MULTILINE)
    found["mjcompose"] = f"{' '.join(written)} ({digest.hexdigest()[:16]})"
    return found


def check_versions(client: Client, workers: list[str], packages: tuple[str, ...] = ()) -> None:
    """Raise ClusterError for the first worker with a relevant difference."""
    import cloudpickle

    pythons = client.get_versions(check=False)
    here = _minor(pythons["client"]["host"]["python"])
    for worker in workers:
        there = pythons["workers"].get(worker)
        if there is not None and (python := _minor(there["host"]["python"])) != here:
            raise _differs(worker, {"Python": (python, here)})
    names = tuple(dict.fromkeys((*PACKAGES, *packages)))
    own = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(own)
    try:
        answers = client.run(versions, names, workers=workers, on_error="return")
    finally:
        cloudpickle.unregister_pickle_by_value(own)
    mine = versions(names)
    for worker, theirs in answers.items():
        if isinstance(theirs, OSError):
            continue  # it is gone
        if isinstance(theirs, BaseException):
            raise ClusterError("cluster-worker", f"the worker `{worker}` does not answer: {theirs}")
        pairs = {name: (theirs.get(name), mine.get(name)) for name in ("mjcompose", *names, "zlib")}
        different = {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}
        if different:
            raise _differs(worker, different)


def _differs(worker: str, different: Mapping[str, tuple[str | None, str | None]]) -> ClusterError:
    (name, (there, here)), *others = different.items()
    has = f"has no `{name}`" if there is None else f"has {name} {there}, and here it is {here or 'absent'}"
    listed = ", ".join(f"{each} {away or 'none'} instead of {home or 'none'}" for each, (away, home) in others)
    help = _HELP.get(name, f"run `pip install '{name}=={here}'` there")
    message = f"the worker `{worker}` {has}: it would not make the same models"
    return ClusterError("cluster-worker", message, help, notes=(f"it differs in {listed} too",) if others else ())


def _minor(python: str) -> str:
    """Return a version without its last number, which changes no bytes.

    >>> _minor("3.11.7.final.0")
    '3.11'
    """
    return ".".join(python.split(".")[:2])


Tell = Callable[[str], None]


class Stations:
    """Sends a run of cells to the workers and takes their results. Raises ClusterError and OutputError.

    `out` is the folder or address for all models, None for a run that writes no models; `away` finishes a model on a
    machine with other folders. Resources of the run are released with `held`.
    """

    def __init__(
        self,
        making: CellMaker,
        cells: Sequence[Cell],
        out: Location | None,
        away: Finish | None,
        held: ExitStack,
    ) -> None:
        self._making = making
        store = making.maker.cache.store.folder if making.maker.cache is not None else None
        freight = freight_of(making, cells)
        self._packages = freight.packages
        self._journal = journal_of(making, out)
        written = {each.name for each in cells if self._has_written(each)}
        self._first = next((each for each in cells if each.name not in written), cells[0])
        seen = None
        with contextlib.suppress(OSError):  # a read-only folder, which is reported when the run needs it
            seen = None if store is None else _token(store, held)
        try:
            out_seen = _token(out, held) if isinstance(out, Path) else None
        except OSError as error:
            raise unwritable_error(str(out), error) from error
        self.order = WorkOrder(
            os.urandom(8).hex(),
            pickle.dumps(Job.of(making)),
            away_job(making, away),
            folder=os.fspath(making.maker.context.folder),
            memory=int(in_force().memory),
            files=freight.files,
            layout=freight.layout,
            store=seen,
            out=out_seen,
            address=out if isinstance(out, str) else None,
            journal=self._journal,
        )

    def begin(self, client: Client, workers: list[str]) -> None:
        """Prepare workers: each gets its missing files before it gets a cell. Raises ClusterError."""
        check_versions(client, workers, tuple(name for name, *_ in self._packages))
        while workers:
            answers = client.run(station.begin, self.order, workers=workers, on_error="return")
            workers = []
            for worker, answer in answers.items():
                if isinstance(answer, RunRefusal):
                    raise ClusterError("cluster-worker", f"the worker `{worker}` {answer.message}", answer.help)
                if isinstance(answer, Lacks):
                    self._send(client, worker, answer)
                    workers.append(worker)
                elif answer is not None and not isinstance(answer, OSError):  # an OSError: it is gone
                    raise ClusterError("cluster-worker", f"the worker `{worker}` cannot start: {answer}")

    def known(self, cell: Cell) -> CellResult | None:
        """Return a cell that the cache has, or that an earlier run has completely written on another machine."""
        self._has_written(cell)
        return self._making.known(cell)

    def end(self) -> None:
        """Remove the journal if the cache has everything that was written."""
        if self._journal is not None:
            self._journal.end()

    def _has_written(self, cell: Cell) -> bool:
        return self._journal is not None and self._journal.take(cell, self._making, self._packages)

    def close(self, client: Client) -> None:
        with contextlib.suppress(Exception):  # workers that are gone have nothing to close
            client.run(station.close, self.order.run, on_error="ignore")

    def home(self, result: Any, tell: Tell) -> CellResult | Died:
        """Return the result of a cell, made here if no worker could; results from elsewhere go to the cache here."""
        if isinstance(result, Undone):
            return self._making.make(result.task)
        if not isinstance(result, Away):
            assert isinstance(result, CellResult | Died)
            return result
        if result.cell.result is None:  # perhaps because a file exists only on this machine
            made = self._making.make(result.cell.cell)
            if made.result is not None:
                tell(f"`{made.cell.name}` was made here: its worker does not have all files of this machine")
            return made
        if result.record is not None:
            cell = result.cell
            packages = self._packages
            self._making.keep(cell.cell, result.record, result.inputs, packages=packages, result=cell.result)
            if self._journal is not None:
                self._journal.forget(result.cell.cell.name)
        return result.cell

    def _send(self, client: Client, worker: str, lacks: Lacks) -> None:
        paths = {digest: path for path, digest in self.order.layout.files.items()}
        for contents in batches({digest: paths[digest] for digest in lacks.contents}):
            client.run(station.receive, contents, workers=[worker])
        if not self.order.is_tried:
            made = replace(self._making, finish=None).make(self._first).result
            canary = None if made is None else Canary(self._first, made.sha256)
            self.order = replace(self.order, canary=canary, is_tried=True)


def _token(folder: Path, held: ExitStack) -> str:
    """Create a file in a folder for the time of the run: a worker that sees it shares the disk. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    token = held.enter_context(stage_beside(folder / "cluster"))
    token.touch()
    return os.fspath(token)


_MOST_CELLS = 32  # cells in a part: Dask takes some milliseconds for each part
_SECONDS = 0.5  # how long a part may take: its results come at once, and are lost at once
_AHEAD = 2  # parts for each thread that are started before the first result is taken
_TRIES = 2
_MOST_LOST = 10  # how many times a connection is re-established
_LOOK_AGAIN = 5.0


class Crew:
    """The workers of the cluster at `address` (`--cluster`); `local` starts this many.

    They are connected when the first cell is made. `out` is the folder or address for all models, None for a run that
    writes no models; `away` finishes a model on a machine with other folders. `tell` receives progress messages. Use it
    as a context manager. Every method raises ClusterError.
    """

    def __init__(
        self, address: str, workers: int, out: Location | None, tell: Tell, away: Finish | None = None
    ) -> None:
        self._held = ExitStack()
        self._address = address
        self._count = workers
        self._out = out
        self._tell = tell
        self._away = away
        self._client: Client = None
        self._stations: Stations | None = None
        self._running: dict[Any, CellBatch] = {}
        self._again: deque[CellBatch] = deque()
        self._ready: dict[int, Any] = {}
        self._threads = 0
        self._counted = 0.0
        self._lost = 0
        self._workers: set[str] = set()
        self._pace = _SECONDS
        self._cells: Sequence[Cell] = ()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._held.__exit__(kind, error, trace)

    @property
    def stations(self) -> Stations:
        assert self._stations is not None
        return self._stations

    def results(self, making: CellMaker, cells: Sequence[Cell]) -> Iterator[CellResult | Died]:
        """Yield the result of each cell. If no worker can make a cell, this process makes it and raises errors."""
        self._client = self._held.enter_context(client_of(self._address, self._count))
        self._stations = stations = Stations(making, cells, self._out, away=self._away, held=self._held)
        self._held.callback(self._end_run)
        self._cells = cells
        self._count_threads()
        stations.begin(self._client, list(self._client.nthreads()))
        parts = self._parts(stations, cells)
        for taken in range(len(cells)):
            while taken not in self._ready:
                self._go_on(parts)
            yield stations.home(self._ready.pop(taken), self._tell)
        self._count_threads()  # to say which workers died

    def finished(self) -> Iterator[CellResult]:
        """End the work of an interrupted run, and yield the results that were not taken."""
        running = self._running
        self._running = {}
        taken = {number for part in (*running.values(), *self._again) for number in part.numbers}
        with contextlib.suppress(Exception):  # a lost cluster cannot answer
            for future in running:
                if future.status != "finished":
                    future.cancel()
            self._end_run()
            for future, part in running.items():
                if future.status == "finished":
                    self._note(part, future.result())
        # Workers have written more than they could report.
        for number in taken - self._ready.keys():
            known = self.stations.known(self._cells[number])
            if known is not None:
                self._ready[number] = known
        for number in sorted(self._ready):
            result = self._ready.pop(number)
            if isinstance(result, CellResult) or (isinstance(result, Away) and result.cell.result is not None):
                cell = self.stations.home(result, self._tell)
                assert isinstance(cell, CellResult)
                yield cell

    def _parts(self, stations: Stations, cells: Sequence[Cell]) -> Iterator[CellBatch]:
        """Yield parts of half a second each, without cells that exist already; the first part has one cell."""
        at = 0
        while at < len(cells):
            size = max(1, min(_MOST_CELLS, (len(cells) - at) // (2 * self._threads), int(_SECONDS / self._pace)))
            numbers = range(at, min(at + size, len(cells)))
            known = {number: cell for number in numbers if (cell := stations.known(cells[number])) is not None}
            self._ready.update(known)
            unknown = [number for number in numbers if number not in known]
            yield CellBatch(tuple(unknown), tuple(cells[number] for number in unknown))
            at += size

    def _go_on(self, parts: Iterator[CellBatch]) -> None:
        try:
            if not self._threads or time.monotonic() - self._counted > _LOOK_AGAIN:
                self._count_threads()
            while len(self._running) < _AHEAD * self._threads:
                part = self._again.popleft() if self._again else next(parts, None)
                if part is None:
                    break
                if not part.cells:
                    return
                future = self._client.submit(station.make, self.stations.order.run, part.cells, pure=False)
                self._running[future] = part
            self._take()
        except ClusterError:
            raise
        except Exception as error:  # a lost connection raises any of Dask's many exceptions
            self._connect_again(error)

    def _count_threads(self) -> None:
        is_waiting = False
        while not (threads := sum(self._client.nthreads().values())):
            if not is_waiting:
                self._tell(f"waiting for a worker of `{self._address}`")
                is_waiting = True
            with contextlib.suppress(TimeoutError):
                self._client.wait_for_workers(1, timeout=_LOOK_AGAIN)
        there = set(self._client.nthreads())
        for gone in sorted(self._workers - there):
            self._tell(f"the worker `{gone}` has ended; its cells go to others")
        self._workers = there
        self._threads = threads
        self._counted = time.monotonic()

    def _take(self) -> None:
        from distributed import wait

        with contextlib.suppress(TimeoutError), self._client.as_current():
            wait(list(self._running), timeout=_LOOK_AGAIN, return_when="FIRST_COMPLETED")
        for future in [each for each in self._running if each.done()]:
            if future.status in ("cancelled", "lost"):
                raise ConnectionError("its scheduler has gone")
            error = future.exception() if future.status == "error" else None
            answer: Any = None if error is not None else future.result()
            part = self._running.pop(future)
            if error is not None:
                self._failed(part, error)
            elif isinstance(answer, UnknownRun):
                self._again.append(part)
                self.stations.begin(self._client, [answer.worker])
            else:
                self._note(part, answer)

    def _note(self, part: CellBatch, answer: Sequence[Any]) -> None:
        self._ready.update(zip(part.numbers, answer, strict=True))
        for each in answer:
            cell = each.cell if isinstance(each, Away) else each
            if isinstance(cell, CellResult):
                took = sum(seconds for _, seconds in cell.timings)
                self._pace = max(0.9 * self._pace + 0.1 * took, _SECONDS / _MOST_CELLS)

    def _failed(self, part: CellBatch, error: BaseException) -> None:
        """Try each cell of a part alone, once, after its workers have died one after the other."""
        if len(part.cells) > 1 or part.tries + 1 < _TRIES:
            pairs = zip(part.numbers, part.cells, strict=True)
            self._again.extend(CellBatch((number,), (cell,), part.tries + 1) for number, cell in pairs)
        else:
            self._ready[part.numbers[0]] = Died(f"ended with its worker: {' '.join(str(error).split())}")

    def _end_run(self) -> None:
        if self._client.status == "running":
            self.stations.close(self._client)
        self.stations.end()

    def _connect_again(self, error: Exception) -> None:
        help = "check that its scheduler runs, and run the same command again: finished models are kept"
        message = f"the cluster `{self._address}` was lost: {_words(error)}"
        lost = ClusterError("cluster-unreachable", message, help)
        self._lost += 1
        if self._address == LOCAL or self._lost > _MOST_LOST:
            raise lost from error
        self._again.extend(self._running.values())
        self._running.clear()
        with contextlib.suppress(Exception):
            self._client.close(timeout=2)
        self._tell(f"connecting to `{self._address}` again")
        try:
            self._client = self._held.enter_context(contextlib.closing(connected(self._address)))
            self._held.callback(self._end_run)
        except ClusterError:
            raise lost from error
        self._threads = 0

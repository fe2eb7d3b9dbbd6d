"""The worker's side: each worker has a station for a run, whose own processes make the models.

Dask's process itself reads no models and unpickles no jobs. It passes cells to processes of mjcompose, one for each
of its threads, which are replaced when they die, and which have the limits of the run. `crew.py` calls functions
without a leading underscore through Dask.
"""

from __future__ import annotations

import asyncio
import hashlib
import os
import pickle
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from composer.bundle.output_error import OutputError
from composer.bundle.remote import check_writable
from composer.cache.files import Files
from composer.cluster import inside
from composer.cluster.mirror import lay_out, rooted
from composer.cluster.order import Lacks, NotOpen, Order, Refused
from composer.processes.helper import Helper, Opening
from composer.scratch import scratch

MODULES = (
    "composer.cache.making",
    "composer.stages",
    "composer.verify.checks",
    "composer.verify.compile_report",
)
_IDLE = 600.0
"""Seconds without work after which an unclosed run is considered over."""
_CONTENTS = "mjcompose-sources"
_SHIPPED = "MJCOMPOSE_SHIPPED"
"""A worker with this variable reads no files of its machine: all files are sent to it."""
_stations: dict[str, Station] = {}
_lock = threading.Lock()


class Station:
    """The processes of one run in this worker."""

    def __init__(self, run: str, opening: Opening[Any, Any], folder: str, held: ExitStack) -> None:
        self._opening, self._folder, self._held = pickle.dumps(opening), folder, held
        self._helpers: list[Helper] = []
        self._idle: list[Helper] = []
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._used = time.monotonic()
        self._ended = False
        threading.Thread(target=self._watch, args=(run,), daemon=True).start()

    def made(self, cells: Sequence[Any]) -> list[Any]:
        """Return the result of each cell: a MadeCell, Died or Undone."""
        with self._helper() as helper:
            return [helper.result(self._opening, cell) for cell in cells]

    def end(self) -> None:
        """End the processes, which remove unfinished work."""
        self._over.set()
        with self._lock:
            self._ended, helpers = True, self._helpers
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


async def begin(order: Order, dask_worker: Any) -> Refused | Lacks | None:
    """Get ready for a run, or return what is missing or why that is impossible.

    Dask's own work continues meanwhile. Dask passes the worker to a parameter of that name.
    """
    return await asyncio.to_thread(_begin, order, Path(dask_worker.local_directory) / _CONTENTS)


async def receive(contents: Mapping[str, bytes], dask_worker: Any) -> None:
    """Store contents of files by their sha256."""
    await asyncio.to_thread(_keep, contents, Path(dask_worker.local_directory) / _CONTENTS)


def make(run: str, cells: Sequence[Any]) -> list[Any] | NotOpen:
    """Make cells of a run: the scheduler's task."""
    from distributed import get_worker

    with _lock:
        station = _stations.get(run)
    return NotOpen(get_worker().address) if station is None else station.made(cells)


async def close(run: str) -> None:
    """Close a run."""
    await asyncio.to_thread(_close, run)


def _begin(order: Order, contents: Path) -> Refused | Lacks | None:
    with _lock:
        if order.run in _stations:
            return None
    if order.out is not None and not os.path.exists(order.out):
        folder = os.path.dirname(os.path.dirname(order.out))
        return Refused(
            f"does not see the folder `{folder}`, where the models go",
            "write to a folder that all machines share, or to an address such as `-o 's3://bucket/{name}.zip'`",
        )
    if order.address is not None:
        try:
            check_writable(order.address)
        except OutputError as error:
            return Refused(error.message, error.help)
    if _sees_all(order):
        opening = partial(inside.opened, order.memory, order.job)
        station = Station(order.run, opening, order.folder, held=ExitStack())
    else:
        lacking = tuple(
            dict.fromkeys(each for each in order.layout.files.values() if not os.path.exists(contents / each))
        )
        if lacking or not order.is_tried:
            return Lacks(lacking)
        made = _away(order, contents)
        if isinstance(made, Refused):
            return made
        station = made
    with _lock:
        _stations[order.run] = station
    return None


def _sees_all(order: Order) -> bool:
    """Return whether this worker shares the client's disk."""
    if os.environ.get(_SHIPPED) or (order.store is not None and not os.path.exists(order.store)):
        return False
    files = Files()
    return all(files.look(each.path).state == each.state for each in order.files)


def _away(order: Order, contents: Path) -> Station | Refused:
    """Return a station whose files are a mirror of the client's files."""
    if order.away is None:
        return Refused("does not have the files of the models, which text alone only names",
                       "write bundles, such as `-o 'build/{name}.zip'`")  # fmt: skip
    with ExitStack() as opened:
        folder = opened.enter_context(scratch("cluster"))
        root = folder / "mirror"
        root.mkdir()
        lay_out(order.layout, root, contents.joinpath)
        work = rooted(Path(order.folder), str(root))
        work.mkdir(parents=True, exist_ok=True)
        opening = partial(
            inside.opened_away, order.memory, order.away, str(root), str(folder / "store"), order.journal
        )
        station = Station(order.run, opening, str(work), held=opened.pop_all())
    if order.canary is not None:
        (answer,) = station.made([order.canary])
        if answer != order.canary.sha256:
            station.end()
            return Refused(f"makes another model of the same files: `{order.canary.cell.name}` has other bytes there",
                           "use one image or one environment for all workers and this machine")  # fmt: skip
    return station


def _keep(contents: Mapping[str, bytes], folder: Path) -> None:
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    for digest, content in contents.items():
        if hashlib.sha256(content).hexdigest() != digest:
            raise ValueError("what was sent is not what was announced")
        stage = folder / f".{digest}.{os.urandom(6).hex()}"
        stage.write_bytes(content)
        stage.replace(folder / digest)


def _close(run: str) -> None:
    with _lock:
        station = _stations.pop(run, None)
    if station is not None:
        station.end()

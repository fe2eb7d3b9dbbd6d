"""Make the cells of a run on the workers of a cluster, with the results in the order of the cells."""

from __future__ import annotations

import contextlib
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from types import TracebackType
from typing import Any

from composer.bundle.place import Place
from composer.cache.making import CellMaker, Finish, MadeCell
from composer.cluster import station
from composer.cluster.address import LOCAL, Client, client_of, connected
from composer.cluster.error import ClusterError
from composer.cluster.order import Away, NotOpen, Part
from composer.cluster.stations import Stations, Tell
from composer.expand.matrix import Cell
from composer.processes.helper import Died

_MOST_CELLS = 32
"""Cells in a part: Dask takes some milliseconds for each part."""
_SECONDS = 0.5
"""How long a part may take: its results come at once, and are lost at once."""
_AHEAD = 2
"""Parts for each thread that are started before the first result is taken."""
_TRIES = 2
_MOST_LOST = 10
"""How many times a connection is re-established."""
_LOOK_AGAIN = 5.0


class Crew:
    """The workers of the cluster at `address` (`--cluster`); `local` starts this many.

    They are connected with the first cell. `out` is the folder or address for all models, None for a run that
    writes none; `away` finishes a model on a machine with other folders. `tell` receives progress messages. Use it
    as a context manager. Every method raises ClusterError.
    """

    def __init__(
        self, address: str, workers: int, out: Place | None, tell: Tell, away: Finish | None = None
    ) -> None:
        self._address, self._count, self._out, self._tell, self._away = address, workers, out, tell, away
        self._held = ExitStack()
        self._client: Client = None
        self._stations: Stations | None = None
        self._running: dict[Any, Part] = {}
        self._again: deque[Part] = deque()
        self._ready: dict[int, Any] = {}
        self._threads, self._counted, self._lost = 0, 0.0, 0
        self._workers: set[str] = set()
        self._pace = _SECONDS
        self._cells: Sequence[Cell] = ()

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end_run()
        self._held.close()

    def results(self, making: CellMaker, cells: Sequence[Cell]) -> Iterator[MadeCell | Died]:
        """Yield the result of each cell.

        If no worker can make one, it is made here, so that exceptions are raised here.
        """
        self._client = self._held.enter_context(client_of(self._address, self._count))
        self._stations = stations = Stations(making, cells, self._out, away=self._away, held=self._held)
        self._cells = cells
        self._count_threads()
        stations.begin(self._client, list(self._client.nthreads()))
        parts = self._parts(stations, cells)
        for taken in range(len(cells)):
            while taken not in self._ready:
                self._go_on(parts)
            yield stations.home(self._ready.pop(taken), self._tell)
        self._count_threads()  # to say which workers died

    def finished(self) -> Iterator[MadeCell]:
        """End the work of an interrupted run, and yield the results that were not taken."""
        running, self._running = self._running, {}
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
            assert self._stations is not None
            if (known := self._stations.known(self._cells[number])) is not None:
                self._ready[number] = known
        for number in sorted(self._ready):
            result = self._ready.pop(number)
            if isinstance(result, MadeCell) or (isinstance(result, Away) and result.cell.made is not None):
                assert self._stations is not None
                found = self._stations.home(result, self._tell)
                assert isinstance(found, MadeCell)
                yield found

    def _parts(self, stations: Stations, cells: Sequence[Cell]) -> Iterator[Part]:
        """Yield parts of half a second each, the first of one cell, without cells that are made already."""
        at = 0
        while at < len(cells):
            size = min(_MOST_CELLS, (len(cells) - at) // (2 * self._threads), int(_SECONDS / self._pace))
            size = max(1, size)
            unknown = []
            for number in range(at, min(at + size, len(cells))):
                known = stations.known(cells[number])
                if known is None:
                    unknown.append(number)
                else:
                    self._ready[number] = known
            yield Part(tuple(unknown), tuple(cells[number] for number in unknown))
            at += size

    def _go_on(self, parts: Iterator[Part]) -> None:
        """Submit work to free threads, wait for a part to end, and take its results."""
        try:
            if not self._threads or time.monotonic() - self._counted > _LOOK_AGAIN:
                self._count_threads()
            while len(self._running) < _AHEAD * self._threads:
                part = self._again.popleft() if self._again else next(parts, None)
                if part is None:
                    break
                if not part.cells:
                    return
                self._submit(part)
            self._take()
        except ClusterError:
            raise
        except Exception as error:  # a lost connection raises any of Dask's many exceptions
            self._connect_again(error)

    def _count_threads(self) -> None:
        """Count the threads of the cluster; wait until there is one."""
        said = False
        while not (threads := sum(self._client.nthreads().values())):
            if not said:
                self._tell(f"waiting for a worker of `{self._address}`")
                said = True
            with contextlib.suppress(TimeoutError):
                self._client.wait_for_workers(1, timeout=_LOOK_AGAIN)
        there = set(self._client.nthreads())
        for gone in sorted(self._workers - there):
            self._tell(f"the worker `{gone}` has ended; its cells go to others")
        self._workers = there
        self._threads, self._counted = threads, time.monotonic()

    def _submit(self, part: Part) -> None:
        assert self._stations is not None
        future = self._client.submit(station.make, self._stations.order.run, part.cells, pure=False)
        self._running[future] = part

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
            elif isinstance(answer, NotOpen):
                self._again.append(part)
                assert self._stations is not None
                self._stations.begin(self._client, [answer.worker])
            else:
                self._note(part, answer)

    def _note(self, part: Part, answer: Sequence[Any]) -> None:
        self._ready.update(zip(part.numbers, answer, strict=True))
        for each in answer:
            cell = each.cell if isinstance(each, Away) else each
            if isinstance(cell, MadeCell):
                took = sum(seconds for _, seconds in cell.timings)
                self._pace = max(0.9 * self._pace + 0.1 * took, _SECONDS / _MOST_CELLS)

    def _failed(self, part: Part, error: BaseException) -> None:
        """Try each cell of a part alone, once, after its workers have died one after the other."""
        if len(part.cells) > 1 or part.tries + 1 < _TRIES:
            pairs = zip(part.numbers, part.cells, strict=True)
            self._again.extend(Part((number,), (cell,), part.tries + 1) for number, cell in pairs)
        else:
            self._ready[part.numbers[0]] = Died(f"ended with its worker: {' '.join(str(error).split())}")

    def _end_run(self) -> None:
        if self._stations is not None:
            if self._client.status == "running":
                self._stations.close(self._client)
            self._stations.end()

    def _connect_again(self, error: Exception) -> None:
        """Reconnect, and submit unfinished parts again. Raises ClusterError."""
        lost = ClusterError(
            "cluster-unreachable",
            f"the cluster `{self._address}` was lost: {' '.join(str(error).split()) or type(error).__name__}",
            "see that its scheduler runs, and give the same command again: what is made is not made again",
        )
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
        except ClusterError:
            raise lost from error
        self._threads = 0

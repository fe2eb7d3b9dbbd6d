"""The stations of a run from the client's side: opened before a worker gets a cell, closed at the end."""

from __future__ import annotations

import contextlib
import os
import pickle
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from composer.bundle.output_error import unwritable
from composer.bundle.place import Place
from composer.bundle.staging import stage_beside
from composer.cache.making import CellMaker, Finish, Job, MadeCell
from composer.cluster import station
from composer.cluster.address import Client
from composer.cluster.error import ClusterError
from composer.cluster.freight import away_job, batches, freight_of
from composer.cluster.journal import journal_of
from composer.cluster.order import Away, Canary, Lacks, Order, Refused
from composer.cluster.versions import check_versions
from composer.expand.matrix import Cell
from composer.limits import in_force
from composer.processes.helper import Died, Undone

Tell = Callable[[str], None]


class Stations:
    """Sends a run of cells to the workers and takes their results. Raises ClusterError and OutputError.

    `out` is the folder or address for all models, None for a run that writes none; `away` finishes a model on a
    machine with other folders. Resources of the run are released with `held`.
    """

    def __init__(
        self,
        making: CellMaker,
        cells: Sequence[Cell],
        out: Place | None,
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
        with contextlib.suppress(OSError):  # a read-only folder, which is reported where it is needed
            seen = None if store is None else _token(store, held)
        try:
            out_seen = _token(out, held) if isinstance(out, Path) else None
        except OSError as error:
            raise unwritable(str(out), error) from error
        self.order = Order(
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
        """Prepare workers: each gets its missing files before it gets a cell."""
        check_versions(client, workers, tuple(name for name, *_ in self._packages))
        while workers:
            answers = client.run(station.begin, self.order, workers=workers, on_error="return")
            workers = []
            for worker, answer in answers.items():
                if isinstance(answer, Refused):
                    message = f"the worker `{worker}` {answer.message}"
                    raise ClusterError("cluster-worker", message, answer.help)
                if isinstance(answer, Lacks):
                    self._send(client, worker, answer)
                    workers.append(worker)
                elif answer is not None and not isinstance(answer, OSError):  # an OSError: it is gone
                    raise ClusterError("cluster-worker", f"the worker `{worker}` cannot begin: {answer}")

    def known(self, cell: Cell) -> MadeCell | None:
        """Return a cell that the cache has, or that an earlier run has written whole on another machine."""
        self._has_written(cell)
        return self._making.known(cell)

    def end(self) -> None:
        """Remove the journal, if the cache has all that was written."""
        if self._journal is not None:
            self._journal.end()

    def _has_written(self, cell: Cell) -> bool:
        return self._journal is not None and self._journal.take(cell, self._making, self._packages)

    def close(self, client: Client) -> None:
        """End all work of the run on all workers."""
        with contextlib.suppress(Exception):  # workers that are gone have nothing to close
            client.run(station.close, self.order.run, on_error="ignore")

    def home(self, result: Any, tell: Tell) -> MadeCell | Died:
        """Return the result of a cell, made here if no worker could; results from elsewhere go to the cache here."""
        if isinstance(result, Undone):
            return self._making.make(result.task)
        if not isinstance(result, Away):
            assert isinstance(result, MadeCell | Died)
            return result
        if result.cell.made is None:  # perhaps because a file exists only on this machine
            made = self._making.make(result.cell.cell)
            if made.made is not None:
                tell(f"`{made.cell.name}` was made here: its worker does not have all files of this machine")
            return made
        if result.record is not None:
            self._making.keep(result.cell, result.record, result.inputs, packages=self._packages)
            if self._journal is not None:
                self._journal.forget(result.cell.cell.name)
        return result.cell

    def _send(self, client: Client, worker: str, lacks: Lacks) -> None:
        """Send contents to a worker in batches, and prepare the canary."""
        paths = {digest: path for path, digest in self.order.layout.files.items()}
        for contents in batches({digest: paths[digest] for digest in lacks.contents}):
            client.run(station.receive, contents, workers=[worker])
        if not self.order.is_tried:
            made = replace(self._making, finish=None).make(self._first).made
            canary = None if made is None else Canary(self._first, made.sha256)
            self.order = replace(self.order, canary=canary, is_tried=True)


def _token(folder: Path, held: ExitStack) -> str:
    """Create a file in a folder for the time of the run: a worker that sees it shares the disk. Raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    token = held.enter_context(stage_beside(folder / "cluster"))
    token.touch()
    return os.fspath(token)

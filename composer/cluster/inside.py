"""The openings for the processes that a worker keeps for models."""

from __future__ import annotations

import os
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from composer.cache.entry import Record
from composer.cache.files import Seen
from composer.cluster.journal import Journal
from composer.cluster.mirror import loaded, without_root
from composer.cluster.order import Away, Canary
from composer.processes.guard import limit
from composer.sources.kinds import KINDS
from composer.sources.store import Store


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
    context, is_cached = here.context, here.store is not None
    environment = dict(context.environment)
    for name in ("MJCOMPOSE_CACHE", *(each for kind in KINDS for each in kind.variables)):
        path = f"{root}{environment.get(name, '')}"
        if environment.get(name, "").startswith("/") and os.path.isdir(path):
            environment[name] = path
    here = replace(here, context=replace(context, environment=environment), store=Store(Path(store)))
    kept: list[tuple[Record, tuple[Seen, ...]]] = []
    trial = replace(here, finish=None, store=None)  # the run does not find in a cache what was only tried
    with here.opened(lambda *each: kept.append(each)) as make, trial.opened() as try_out:

        def made(task: Any) -> Any:
            if isinstance(task, Canary):
                found = try_out(task.cell)
                return None if found.made is None else found.made.sha256
            kept.clear()
            cell = without_root(make(task), root)
            if not is_cached and cell.made is not None:  # the store is of this run: you have no cache
                cell = replace(cell, made=replace(cell.made, is_new=True))
            # Kept for the cell, with its recipes, and then for its plan; of sources that may move, for the plan alone.
            record, inputs = kept[0] if len(kept) > 1 else (None, ())
            away = Away(cell, without_root(record, root), without_root(inputs, root))
            if journal is not None and away.record is not None and not cell.failed:
                journal.note(cell.cell.name, away.record, away.inputs)
            return away

        yield made

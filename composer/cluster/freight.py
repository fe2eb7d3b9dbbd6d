"""The files of this machine that a run needs, and how to send them to a worker that lacks them."""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from composer import stages
from composer.cache.cache import Package
from composer.cache.files import Files, Seen
from composer.cache.inputs import Inputs
from composer.cache.making import CellMaker, Finish, Job
from composer.cluster.error import ClusterError
from composer.cluster.mirror import Layout, layout_of
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.document.node import Scalar
from composer.expand.matrix import Cell
from composer.reading.regular import read_regular
from composer.sources.fetching import Fetching
from composer.sources.store import ENTRY, KINDS

_AT_ONCE = 16 << 20
"""Maximum bytes in one message."""


@dataclass(frozen=True, slots=True)
class Freight:
    """The files of all cells that are known beforehand, and the packages that these cells depend on."""

    files: tuple[Seen, ...]
    layout: Layout
    packages: tuple[Package, ...]


def freight_of(making: CellMaker, cells: Sequence[Cell]) -> Freight:
    """Plan enough cells to see every value that a cell gives to a parameter or variant.

    Files that only another cell needs are found when its worker fails.
    """
    maker, inputs = making.maker, Inputs()
    paths: dict[str, None] = {}
    packages: dict[Package, None] = {}
    context = replace(maker.context, sink=Sink())
    for cell in _typical(cells):
        request = stages.Request(maker.recipe, {**making.given, **cell.given}, cell.name, sample=cell.sample)
        plan = stages.planned(request, context)
        if plan is not None:
            paths.update(dict.fromkeys(inputs.planned(plan, context)))
            packages.update(dict.fromkeys(inputs.packages(plan)))
    fetching = context.fetching
    store = maker.cache.store.folder if maker.cache is not None else None
    for origin in fetching.origins.values() if fetching is not None else ():
        if store is not None and origin.root.parent.parent.name in KINDS:
            paths[os.fspath(origin.root.parent / ENTRY)] = None
    files = Files()
    return Freight(tuple(files.look(path) for path in paths), layout_of(paths), tuple(packages))


def away_job(making: CellMaker, finish: Finish | None) -> bytes | None:
    """Return the job for a machine with a mirror of the files, or None if models cannot be written there.

    It knows what was fetched, but nothing that was read.
    """
    if making.finish is not None and finish is None:
        return None
    job = Job.of(making)
    how = job.context.fetching
    fetching = None if how is None else Fetching(
        offline=True, locked=how.locked, lock=how.lock, lock_file=how.lock_file, recipe=how.recipe, fresh=how.fresh,
        origins=how.origins, outer=how.outer, trust=how.trust,
    )  # fmt: skip
    context = replace(job.context, recipes={}, concrete={}, fetching=fetching)
    return pickle.dumps(replace(job, context=context, finish=finish))


def batches(paths: Mapping[str, str]) -> Iterator[dict[str, bytes]]:
    """Yield the contents of files in batches of limited size, by their sha256. Raises ClusterError."""
    batch: dict[str, bytes] = {}
    size = 0
    for digest, path in paths.items():
        content = b""
        with contextlib.suppress(OSError):
            content = read_regular(path)
        if hashlib.sha256(content).hexdigest() != digest:
            raise ClusterError("cluster-worker", f"`{path}` changed while it was sent to the workers",
                               "give the same command again")  # fmt: skip
        batch[digest] = content
        size += len(content)
        if size > _AT_ONCE:
            yield batch
            batch, size = {}, 0
    if batch:
        yield batch


def _typical(cells: Sequence[Cell]) -> Iterator[Cell]:
    seen: set[object] = set()
    for cell in cells:
        texts = {
            (name, node.text)
            for name, node in cell.given.items()
            if isinstance(node, Scalar) and isinstance(node.value, str)
        }
        marks = {*texts, ("names", tuple(cell.given)), ("draws", cell.sample > 0)}
        if not marks <= seen:
            seen |= marks
            yield cell

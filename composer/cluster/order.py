"""The messages between client and workers: small, and picklable."""

from __future__ import annotations

from composer.cache.entry import Record
from composer.cache.files import Seen
from composer.cache.making import MadeCell
from composer.cluster.journal import Journal
from composer.cluster.mirror import Layout
from composer.dataclass import dataclass
from composer.expand.matrix import Cell


@dataclass(frozen=True, slots=True)
class Canary:
    """A cell that is made to check that a worker gives the same model; it is not written."""

    cell: Cell
    sha256: str


@dataclass(frozen=True, slots=True)
class Order:
    """What a worker needs to know before it makes cells of a run.

    `job` is a pickled `Job`, `folder` its working folder. `files` are the input files with their state
    (`cache/files.py`). `seen` are files of this run that a worker sees only if it shares the disk: in the store,
    and where the models go, which may be an `address`. A worker that sees them works like a process of this
    machine. Others get the files in `layout`, and `away`, another Job; `canary` checks that this gives the same
    model, and `is_tried` says that a canary was looked for. It notes in `journal` what it
    has written. `memory` limits each process that makes models, in
    bytes.
    """

    run: str
    job: bytes
    away: bytes | None
    folder: str
    memory: int
    files: tuple[Seen, ...]
    layout: Layout
    store: str | None = None
    out: str | None = None
    address: str | None = None
    canary: Canary | None = None
    is_tried: bool = False
    journal: Journal | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """Some cells that one worker makes, one after another; `numbers` are their numbers, `tries` counts attempts."""

    numbers: tuple[int, ...]
    cells: tuple[Cell, ...]
    tries: int = 0


@dataclass(frozen=True, slots=True)
class Away:
    """A result from a worker that does not share the disk of this machine, and the data for the cache here."""

    cell: MadeCell
    record: Record | None
    inputs: tuple[Seen, ...]


@dataclass(frozen=True, slots=True)
class NotOpen:
    """The answer of a worker that does not know the run yet."""

    worker: str


@dataclass(frozen=True, slots=True)
class Lacks:
    """The answer of a worker that first needs these contents, by their sha256, and the canary."""

    contents: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Refused:
    """Why a worker cannot make the models."""

    message: str
    help: str | None = None

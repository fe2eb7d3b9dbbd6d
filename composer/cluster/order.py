"""What passes between who asks and who works: small, and picklable."""

from __future__ import annotations

from dataclasses import dataclass

from composer.cache.entry import Record
from composer.cache.files import Seen
from composer.cache.making import MadeCell
from composer.cluster.mirror import Layout
from composer.expand.matrix import Cell


@dataclass(frozen=True, slots=True)
class Canary:
    """A cell that is made to see whether it becomes the same model, and that is not written."""

    cell: Cell
    sha256: str


@dataclass(frozen=True, slots=True)
class Order:
    """What a worker needs to know before it makes cells of a run.

    `job` is a pickled `Job`, `folder` where it works. `files` are the paths of what the models are made of, with what
    is there (`cache/files.py`). `seen` are files of this run alone that a worker sees if it has the same disk: in the
    store, and where the models go, which may be an `address`. A worker that has it works like a process of this
    machine. One that has not gets what is in `layout`, and `away`, another Job; `canary` shows whether that gives the
    same, where `is_tried` says that one was looked for. `memory` bounds each process that makes models, in bytes.
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


@dataclass(frozen=True, slots=True)
class Part:
    """Some cells that one worker makes, one after another; `numbers` are theirs, `tries` counts."""

    numbers: tuple[int, ...]
    cells: tuple[Cell, ...]
    tries: int = 0


@dataclass(frozen=True, slots=True)
class Away:
    """What a worker made without the disk of this machine, and what is to be remembered of it here."""

    cell: MadeCell
    record: Record | None
    inputs: tuple[Seen, ...]


@dataclass(frozen=True, slots=True)
class NotOpen:
    """The answer of a worker that does not know the run yet."""

    worker: str


@dataclass(frozen=True, slots=True)
class Lacks:
    """The answer of a worker that has to be sent these contents first, by their sha256, and the canary."""

    contents: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Refused:
    """Why a worker cannot make the models."""

    message: str
    help: str | None = None

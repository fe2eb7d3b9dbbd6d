"""What is different between two models: plain data, for text, Markdown and JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from composer.diagnostics.span import Span

Value: TypeAlias = bool | int | float | str | tuple["Value", ...] | None

What: TypeAlias = Literal["added", "removed", "renamed", "changed"]

SETTINGS = ("option", "visual", "statistic")
"""Kinds that are settings of the whole model and no elements."""


@dataclass(frozen=True, slots=True)
class Change:
    """One thing that is different.

    ``kind`` is MJCF's word for the element, or one of ``SETTINGS``; ``name`` is what it is called in B, in A where B
    lacks it; an element without a name is reported by its place. ``field`` is the array of `mjModel`, or the setting;
    empty where the element itself is ``added``, ``removed`` or ``renamed``. ``form`` is the type of the joint whose
    units count. ``entry`` is whose number of a keyframe it is. ``index`` are the ids in A and B, -1 where there is
    none. ``follows`` says that MuJoCo computes it from others that are reported too. ``note`` says in words what is too
    long to be listed.
    """

    what: What
    kind: str
    name: str
    field: str = ""
    before: Value = None
    after: Value = None
    form: str = ""
    entry: str = ""
    index: tuple[int, int] = (-1, -1)
    name_before: str = ""
    follows: bool = False
    note: str = ""


@dataclass(frozen=True, slots=True)
class Move:
    """An element whose numbers stand elsewhere in a vector of the whole model; addresses are 0-based."""

    vector: str
    kind: str
    name: str
    before: int
    after: int


@dataclass(frozen=True, slots=True)
class Count:
    """A size of the whole model."""

    name: str
    before: float
    after: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Contrast:
    """All that is different between two compiled models.

    ``identical`` says that every array of `mjModel` is equal bit for bit; ``arrays`` names those that are not.
    ``elements`` has by kind how many A and B have.
    """

    identical: bool
    changes: tuple[Change, ...]
    moves: tuple[Move, ...]
    counts: tuple[Count, ...]
    arrays: tuple[str, ...]
    elements: dict[str, tuple[int, int]]


@dataclass(frozen=True, slots=True)
class Cause:
    """Where it is written what makes the difference: a place in A, in B, or in both, and the lines that differ."""

    words: str
    before: Span | None = None
    after: Span | None = None
    lines_before: tuple[str, ...] = ()
    lines_after: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Group:
    """The changes that one line is the reason for; ``cause`` is None where no line is known."""

    cause: Cause | None
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True)
class End:
    """A or B: how messages call it, what it is, and the sha256 of its files without the manifest.

    `cell` is the one of its matrix that was compared. Without it, `cells` says how many the matrix has.
    """

    label: str
    kind: str
    sha256: str
    cell: str | None = None
    cells: int = 0

    @property
    def named(self) -> str:
        """The label with the cell."""
        return self.label if self.cell is None else f"{self.label}: {self.cell}"


@dataclass(frozen=True, slots=True)
class View:
    """Pictures of A and B from one place, by the name of the camera; ``differs`` is the share of pixels that do."""

    name: str
    before: str
    after: str
    differs: float


@dataclass(frozen=True, slots=True)
class Diff:
    """The answer. ``same`` is whether nothing that was asked for differs; ``files`` are those of which the bytes do."""

    a: End
    b: End
    contrast: Contrast
    groups: tuple[Group, ...]
    files: tuple[str, ...]
    follows: int
    views: tuple[View, ...] = ()

    @property
    def same(self) -> bool:
        contrast = self.contrast
        return not (self.groups or self.follows or contrast.moves or contrast.counts or contrast.arrays)

    @property
    def same_bytes(self) -> bool:
        return self.a.sha256 == self.b.sha256

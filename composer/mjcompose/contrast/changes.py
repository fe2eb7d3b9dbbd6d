"""Changes as data."""

from __future__ import annotations

from typing import Literal, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.sides.side import End

Value: TypeAlias = bool | int | float | str | tuple["Value", ...] | None

What: TypeAlias = Literal["added", "removed", "renamed", "changed"]

SETTINGS = ("option", "visual", "statistic")
"""Kinds that are settings of the whole model, not elements."""


class FieldChange(Struct):
    """One difference.

    ``kind`` is MJCF's word for the element, or one of ``SETTINGS``. ``name`` is its name in B, or in A if B lacks it.
    An unnamed element is reported by its place. ``field`` is the array of `mjModel`, or the setting; it is empty if the
    element itself is ``added``, ``removed`` or ``renamed``. ``form`` is the type of the joint that determines the unit.
    ``entry`` names the owner of a number in a keyframe. ``index`` has the ids in A and B, or -1 for none. ``follows``
    says that MuJoCo computes the value from other reported values. ``note`` describes a change that is too long to
    list.
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


class AddressMove(Struct):
    """An element whose address in a vector of the whole model changed; addresses count from 0."""

    vector: str
    kind: str
    name: str
    before: int
    after: int


class SizeChange(Struct):
    """A size of the whole model."""

    name: str
    before: float
    after: float
    unit: str = ""


class Contrast(Struct):
    """All differences between two compiled models.

    ``identical`` says that every array of `mjModel` is equal bit for bit; ``arrays`` names the other arrays.
    ``elements`` has the counts in A and B by kind.
    """

    identical: bool
    changes: tuple[FieldChange, ...]
    moves: tuple[AddressMove, ...]
    counts: tuple[SizeChange, ...]
    arrays: tuple[str, ...]
    elements: dict[str, tuple[int, int]]


class CauseLines(Struct):
    """The place where the cause of a difference is written, in A, in B, or in both, and the lines that differ."""

    words: str
    before: Span | None = None
    after: Span | None = None
    lines_before: tuple[str, ...] = ()
    lines_after: tuple[str, ...] = ()


class CausedChanges(Struct):
    """The changes that one line causes; ``cause`` is None if no line is known."""

    cause: CauseLines | None
    changes: tuple[FieldChange, ...]


class View(Struct):
    """Pictures of A and B from one place, named after the camera; ``differs`` is the share of differing pixels."""

    name: str
    before: str
    after: str
    differs: float


class Diff(Struct):
    """The result. ``same`` says that nothing in the requested scope differs; ``files`` have different bytes."""

    a: End
    b: End
    contrast: Contrast
    groups: tuple[CausedChanges, ...]
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


LEVELS = ("major", "minor", "patch")


class LevelChanges(Struct):
    """The changes of one level, which is one of `LEVELS`."""

    name: str
    groups: tuple[CausedChanges, ...]
    moves: tuple[AddressMove, ...]
    arrays: tuple[str, ...] = ()


class Breaking(Struct):
    """A diff by levels, the most important first; levels without changes are missing."""

    diff: Diff
    levels: tuple[LevelChanges, ...]

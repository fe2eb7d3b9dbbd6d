"""A lock in the middle of a merge: what the two sides pin, in one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from composer.sources.lock import Lock, Locked


def sides(text: str) -> tuple[str, str]:
    r"""The text of each side of a file with the marks of a merge in it. No I/O.

    >>> sides("a\n<<<<<<< HEAD\nb\n||||||| base\nc\n=======\nd\n>>>>>>> x\ne\n")
    ('a\nb\ne\n', 'a\nd\ne\n')
    """
    ours: list[str] = []
    theirs: list[str] = []
    writing: tuple[list[str], ...] = (ours, theirs)
    for line in text.splitlines(keepends=True):
        if line.startswith("<<<<<<<"):
            writing = (ours,)
        elif line.startswith("|||||||"):
            writing = ()
        elif line.startswith("======="):
            writing = (theirs,)
        elif line.startswith(">>>>>>>"):
            writing = (ours, theirs)
        else:
            for each in writing:
                each.append(line)
    return "".join(ours), "".join(theirs)


def joined(ours: Lock, theirs: Lock) -> Lock:
    """All that either side pins; where both do it otherwise, ours. No I/O."""
    both = {
        id: _joined(ours.sources[id], locked) if id in ours.sources else locked
        for id, locked in theirs.sources.items()
    }
    return ours.model_copy(update={"sources": {**ours.sources, **both}})


def disputed(ours: Lock, theirs: Lock) -> dict[str, tuple[str, str]]:
    """The sources that the two sides pin otherwise, and how each does in words. No I/O.

    A user's own files are none of them: they are hashed anew.
    """
    found = {}
    for id, mine in ours.sources.items():
        other = theirs.sources.get(id)
        if other is None or mine.is_local:
            continue
        if mine.pin != other.pin or mine.version != other.version:
            found[id] = (_pinned(mine), _pinned(other))
        elif any(other.files.get(name, digest) != digest for name, digest in mine.files.items()):
            found[id] = ("some bytes", "other bytes")
    return found


def _joined(mine: Locked, other: Locked) -> Locked:
    return mine.model_copy(
        update={
            "files": {**other.files, **mine.files},
            "licences": sorted({*mine.licences, *other.licences}),
            "used_by": sorted({*mine.used_by, *other.used_by}),
        }
    )


def _pinned(locked: Locked) -> str:
    return locked.pin or f"version {locked.version}"

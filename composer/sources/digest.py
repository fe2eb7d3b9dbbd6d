"""Hash files, and compare two sets of hashes."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from composer.reading.memory import Memory
from composer.reading.regular import open_regular
from composer.reading.unsaved import unsaved_text


def sha256_of(path: Path) -> str:
    """Return the sha256 of a file. Raises OSError."""
    if (kept := unsaved_text(path)) is not None:
        return hashlib.sha256(kept).hexdigest()
    with open_regular(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


_remembered = Memory(lambda path: sha256_of(Path(path)), lambda path: sha256_of(Path(path)))


def remembered_sha256(path: Path) -> str:
    """Return the sha256 of a file that many models of a run use; it is read again only if it has changed."""
    return sha256_of(path) if unsaved_text(path) is not None else _remembered.ask(os.fspath(path))


def files_below(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield every file below a folder with its relative path.

    Paths have forward slashes and come in no order; links are not followed.
    """
    for where, _, names in os.walk(folder):
        for name in names:
            path = Path(where, name)
            yield path.relative_to(folder).as_posix(), path


def differences(before: Mapping[str, str], after: Mapping[str, str]) -> tuple[str, ...]:
    """Return one line for each file that changed, sorted by name; empty if none has. No I/O.

    >>> differences({"a": "0" * 64, "b": "1" * 64}, {"a": "2" * 64, "c": "3" * 64})
    ('`a` changed: 000000000000… was locked, 222222222222… is there', '`b` is gone', '`c` is new')
    """
    return tuple(
        f"`{name}` is gone" if name not in after
        else f"`{name}` is new" if name not in before
        else f"`{name}` changed: {before[name][:12]}… was locked, {after[name][:12]}… is there"
        for name in sorted({*before, *after})
        if before.get(name) != after.get(name)
    )  # fmt: skip

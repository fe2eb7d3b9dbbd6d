"""The state of the files in a workspace: unsaved in an editor, or as they are on disk."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from composer.reading.regular import read_regular

Mark = tuple[int, int, int] | int | None
"""What changes with a file: its time, its size and which file it is; of an open one its text, as a hash."""


def marks(files: Iterable[Path], texts: Mapping[str, bytes]) -> dict[Path, Mark]:
    """Return a mark for each file, which changes with its content. `texts` are unsaved texts by real path."""
    return {file: _mark(file, texts) for file in files}


def _mark(file: Path, texts: Mapping[str, bytes]) -> Mark:
    if texts and (text := texts.get(os.path.realpath(file))) is not None:
        return hash(text)
    try:
        found = os.stat(file)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


def is_saved(path: str, text: bytes) -> bool:
    """Return whether the file on disk has the same text as the editor."""
    try:
        return read_regular(path) == text
    except OSError:
        return False

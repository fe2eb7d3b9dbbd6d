"""Text that an editor has and the disk does not: it is read in place of the file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

_TEXTS: ContextVar[Mapping[str, bytes] | None] = ContextVar("composer.reading.unsaved", default=None)


@contextmanager
def unsaved(texts: Mapping[str, bytes]) -> Iterator[None]:
    """In the block, files are read as `texts` has them, by their real paths.

    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile() as file, unsaved({os.path.realpath(file.name): b"new"}):
    ...     unsaved_text(file.name)
    b'new'
    """
    token = _TEXTS.set({**(_TEXTS.get() or {}), **texts})
    try:
        yield
    finally:
        _TEXTS.reset(token)


def unsaved_text(path: str | os.PathLike[str]) -> bytes | None:
    """What an editor has of a file; None where the disk is right."""
    texts = _TEXTS.get()
    return texts.get(os.path.realpath(path)) if texts else None

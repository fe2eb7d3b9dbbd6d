"""Text from an editor that is not saved yet: it is read in place of the file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

_TEXTS: ContextVar[Mapping[str, bytes] | None] = ContextVar("composer.reading.unsaved", default=None)


@contextmanager
def unsaved(texts: Mapping[str, bytes]) -> Iterator[None]:
    """Within the block, read `texts`, by real path, in place of files.

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
    """Return the editor's text of a file, or None if there is none."""
    texts = _TEXTS.get()
    return texts.get(os.path.realpath(path)) if texts else None

"""Text that is in no file: an editor has not saved it yet, or a command has written it into a pipe."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar

_TEXTS: ContextVar[Mapping[str, bytes] | None] = ContextVar("composer.reading.unsaved", default=None)


_piped: dict[str, bytes] = {}


def keep_piped(path: str, text: bytes) -> bytes:
    """Return what a pipe gave, which gives it only once."""
    if text or path not in _piped:
        _piped[path] = text
    return _piped[path]


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
    """Return the text to read in place of a file, or None if there is none."""
    if _piped and (kept := _piped.get(os.fspath(path))) is not None:
        return kept
    texts = _TEXTS.get()
    return texts.get(os.path.realpath(path)) if texts else None

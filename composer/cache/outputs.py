"""Record outputs: an unchanged output is not written again."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING

from composer.bundle.place import is_address
from composer.cache.files import stamp_of
from composer.sources import blobs

if TYPE_CHECKING:
    from collections.abc import Iterable
    from os import PathLike


def is_written(store: str | PathLike[str], out: str, content: str) -> bool:
    """Return whether an output is unchanged since `note_written` recorded this content."""
    text = blobs.get(store, "asked", _key(out))
    try:
        known: object = None if text is None else json.loads(text)
    except (ValueError, RecursionError):
        return False
    if not isinstance(known, list) or len(known) != 3 or not isinstance(known[1], list):
        return False
    noted, beside, stamps = known
    return bool(noted == content and stamps == (_stamps([out, *beside]) or None))


def note_written(
    store: str | PathLike[str], out: str, content: str, beside: Iterable[str | PathLike[str]] = ()
) -> None:
    """Record an output; `beside` are files elsewhere that belong to it. Raises OSError."""
    more = [os.fspath(path) for path in beside]
    note = json.dumps([content, more, _stamps([out, *more])], ensure_ascii=True)
    blobs.put(store, "asked", _key(out), content=note.encode())


def _key(out: str) -> str:
    return blobs.key_of([out])


def _stamps(outputs: Iterable[str]) -> list[list[object]]:
    """Return the stamps of all files of outputs; empty if one does not exist."""
    found: list[list[object]] = []
    paths: list[str] = []
    for out in outputs:
        if is_address(out):
            from composer.bundle.remote import stamps

            found += stamps(out)
            continue
        below = os.path.isdir(out)
        paths += (
            [os.path.join(at, name) for at, _, names in os.walk(out) for name in names] if below else [out]
        )
    for path in sorted(paths):
        try:
            found.append([path, *stamp_of(os.lstat(path))])
        except OSError:
            return []
    return found

"""The files of a linked model: read once, equal bytes stored once, every path in the model made to fit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

from composer.diagnostics.sink import Sink
from composer.link.linking import FileUse
from composer.tree.files import NAMED_AFTER_FILE, stem
from composer.tree.unit import Unit


def collect(model: Unit, uses: Iterable[FileUse], sink: Sink) -> dict[str, bytes]:
    """Bytes by path in the bundle. A file that is missing is told where the model names it."""
    files: dict[str, bytes] = {}
    stored: dict[tuple[str, bytes], str] = {}
    stands_at: dict[str, str | None] = {}
    for use in uses:
        if use.path not in stands_at:
            stands_at[use.path] = _store(model, use, files, stored, sink)
        path = stands_at[use.path]
        if path is None or path == use.path:
            continue
        if use.element.tag in NAMED_AFTER_FILE and not use.element.get("name"):
            use.element.set("name", stem(use.path))
        use.element.set(use.attribute, path)
    return files


def _store(
    model: Unit, use: FileUse, files: dict[str, bytes], stored: dict[tuple[str, bytes], str], sink: Sink
) -> str | None:
    """Where the bytes of a file are in the bundle: under its own path, or that of an equal file of its kind."""
    content = use.content
    if content is None:
        try:
            content = Path(use.source).read_bytes()
        except OSError as error:
            sink.error(
                "asset-missing",
                f"the file `{use.source}` cannot be read: {error.strerror or error}",
                model.origins.span(use.element, model.file),
            )
            return None
    if not use.shared:
        files[use.path] = content
        return use.path
    suffix = use.path.rsplit(".", 1)[-1]
    path = stored.setdefault((suffix, hashlib.sha256(content).digest()), use.path)
    if path == use.path:
        files[path] = content
    return path

"""The text of a model alone, without its files."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from mjcompose.bundle.bundle import OutputError
from mjcompose.link.linking import FileUse
from mjcompose.tree.unit import Unit
from mjcompose.tree.xml_text import write


def text_alone(model: Unit, uses: Iterable[FileUse], out: str, folder: Path) -> bytes:
    """Return the text for `out` (`-`: in `folder`), with paths to its files. Raises OutputError for made files."""
    target = folder / out
    start = folder if out == "-" else target.parent
    help = f"write a folder (`{target.stem}/`) or an archive (`{target.stem}.zip`)"
    for use in uses:
        if use.content is not None:
            message = f"text alone cannot hold `{use.path}`, which was made for this model"
            raise OutputError("output-kind", message, help)
        path = Path(os.path.relpath(use.source, start)).as_posix()
        if any("\ud800" <= char <= "\udfff" for char in path):  # a byte that cannot be decoded
            raise OutputError("output-kind", f"text alone cannot name `{path}`: that path is not UTF-8", help)
        use.element.set(use.attribute, path)
    return write(model.root)

"""Write a composed model as text that refers to its files at their original places."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from composer.bundle.output_error import OutputError
from composer.link.linking import FileUse
from composer.tree.unit import Unit
from composer.tree.write import write


def text_alone(model: Unit, uses: Iterable[FileUse], out: str, folder: Path) -> bytes:
    """Return the text for the output `out`, `-` for standard output.

    Files are named by paths from the folder of the output (from `folder` for `-`) to the sources, so that the text
    loads where it is written. Raises OutputError for files that are not on disk.
    """
    target = folder / out
    start = folder if out == "-" else target.parent
    for use in uses:
        if use.content is not None:
            raise OutputError(
                "output-kind",
                f"text alone cannot hold `{use.path}`, which was made for this model",
                f"write a folder (`{target.stem}/`) or an archive (`{target.stem}.zip`)",
            )
        path = Path(os.path.relpath(use.source, start)).as_posix()
        if not _is_text(path):
            raise OutputError(
                "output-kind",
                f"text alone cannot name `{path}`: that path is not UTF-8",
                f"write a folder (`{target.stem}/`) or an archive (`{target.stem}.zip`)",
            )
        use.element.set(use.attribute, path)
    return write(model.root)


def _is_text(path: str) -> bool:
    """Return whether a path is valid UTF-8; in other paths, undecodable bytes are surrogates."""
    return not any("\ud800" <= char <= "\udfff" for char in path)

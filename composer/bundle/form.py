"""The forms that a bundle is written in, selected by the output's name."""

from __future__ import annotations

import os
from enum import StrEnum
from os import PathLike, fspath
from pathlib import Path

from composer.bundle.output_error import OutputError


class Form(StrEnum):
    """The forms that a bundle is written in."""

    FOLDER = "folder"
    ARCHIVE = "archive"
    TEXT = "text"
    MJB = "mjb"
    USD = "usd"
    SHARED = "folder with shared assets"


_SUFFIXES = {".zip": Form.ARCHIVE, ".mjz": Form.ARCHIVE, ".xml": Form.TEXT, ".mjb": Form.MJB}
_SUFFIXES |= dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), Form.USD)


def form_of(out: str | PathLike[str]) -> Form:
    """Return the form for an output's name. Raises OutputError.

    A name that ends in a slash or has no suffix is a folder, and so is an existing folder.

    >>> form_of("build/arm"), form_of("arm.mjz")
    (<Form.FOLDER: 'folder'>, <Form.ARCHIVE: 'archive'>)
    """
    name = fspath(out)
    path = Path(name)
    if not name:
        raise OutputError(
            "output-kind", "the output has no name", "write where the model should go: `-o out/`"
        )
    if name.endswith(("/", "\\")) or not path.suffix or os.path.isdir(path):
        return Form.FOLDER
    form = _SUFFIXES.get(path.suffix.lower())
    if form is None:
        raise OutputError(
            "output-kind",
            f"no output is called `*{path.suffix}`: `{name}`",
            f"end it in `.mjz`, `.zip`, `.xml`, `.mjb` or `.usdz`, or write `{name}/` for a folder",
        )
    return form

"""Where a bundle goes, by the name of the output."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from enum import StrEnum
from os import PathLike, fspath
from pathlib import Path

from composer import engine
from composer.bundle.archive import write_archive
from composer.bundle.bundle import Bundle
from composer.bundle.folder import write_folder
from composer.bundle.mjb import write_mjb
from composer.bundle.output_error import OutputError
from composer.bundle.text import write_text
from composer.bundle.usd import SUFFIXES, write_usd


class Form(StrEnum):
    """The forms a bundle can be written in."""

    FOLDER = "folder"
    ARCHIVE = "archive"
    TEXT = "text"
    MJB = "mjb"
    USD = "usd"


_SUFFIXES = {".zip": Form.ARCHIVE, ".mjz": Form.ARCHIVE, ".xml": Form.TEXT, ".mjb": Form.MJB}
_SUFFIXES |= dict.fromkeys(SUFFIXES, Form.USD)


def form_of(out: str | PathLike[str]) -> Form:
    """The form that an output's name asks for. Raises OutputError.

    A name that ends in a slash or has no suffix is a folder, and so is a folder that is there.

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


def write(
    bundle: Bundle,
    out: str | PathLike[str],
    *,
    environment: Mapping[str, str],
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> Form:
    """Write the bundle to `out` in the form its name asks for; the form is returned.

    Either the output is complete or everything is as it was, and OutputError says why. `environment` may hold
    SOURCE_DATE_EPOCH; `limits` or `session` are for MJB and USD, which MuJoCo is needed for; `tell` hears what USD does
    not hold.
    """
    form = form_of(out)
    path = Path(out)
    match form:
        case Form.FOLDER:
            write_folder(bundle, path)
        case Form.ARCHIVE:
            write_archive(bundle, path, environment)
        case Form.TEXT:
            write_text(bundle, path)
        case Form.MJB:
            write_mjb(bundle, path, limits=limits, session=session)
        case Form.USD:
            write_usd(bundle, path, tell, limits=limits, session=session)
    return form

"""Check the types of arguments; errors are `MjcfError`s with a diagnostic."""

from __future__ import annotations

import contextlib
import operator
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from composer.diagnostics.call_site import call_site
from composer.mjcf.errors import MjcfError, failure
from composer.reading.door import ALL, Door


def as_path(argument: str, value: object) -> Path:
    """Return the argument as a path. Raises `MjcfError` if it is not a path or contains a null character."""
    if isinstance(value, str | os.PathLike):
        path = Path(value)
        if "\0" in str(path):
            raise expects(argument, "a path", str(path).replace("\0", "\\0"))
        return path
    raise expects(argument, "a path", type(value).__name__)


Folders = Sequence[str | os.PathLike[str]]


def as_folders(argument: str, value: object) -> tuple[Path, ...]:
    """Return the argument, a list of folders, as paths. Raises `MjcfError` if it is anything else."""
    if isinstance(value, str | bytes) or not isinstance(value, Sequence):
        raise expects(argument, "a list of folders", repr(value))
    return tuple(as_path(argument, each) for each in value)


def door_of(confine_to: Folders | None) -> Door:
    """Return the door of a model that a program reads: to these folders, or to all that MuJoCo reads."""
    if confine_to is None:
        return ALL
    folders = as_folders("confine_to", confine_to)
    whose = ", ".join(f"`{folder}`" for folder in folders) or "no folder"
    return Door.of(
        folders,
        f"{whose}, which is all that `confine_to` names",
        "add the folder: `confine_to=[…, '{absolute}']`",
    )


def as_name(argument: str, value: object) -> str:
    """Return the argument if it is text. Raises `MjcfError` if it is not."""
    if isinstance(value, str):
        return value
    raise expects(argument, "a name", repr(value))


def as_index(argument: str, value: object) -> int:
    """Return the argument as an int. Raises `MjcfError` if it is not an integer of Python or numpy."""
    if not isinstance(value, bool):
        with contextlib.suppress(TypeError):  # arrays have the method too
            return operator.index(value)  # type: ignore[arg-type]
    raise expects(argument, "an integer", repr(value))


def as_files(argument: str, value: object) -> dict[str, bytes]:
    """Return the argument, the bytes of files by path or None, as a dict. Raises `MjcfError` if it is anything else."""
    if not isinstance(value, Mapping | None):
        raise expects(argument, "bytes by path", type(value).__name__)
    found: dict[str, bytes] = {}
    for name, content in (value or {}).items():
        if not isinstance(name, str) or not isinstance(content, bytes):
            got = f"{type(content).__name__}` by `{type(name).__name__}"
            raise expects(argument, "bytes by path", got)
        found[name] = content
    return found


def expects(argument: str, what: str, got: object) -> MjcfError:
    """Return the error that `argument` expects `what` and got something else."""
    return failure("wrong-type", f"`{argument}` expects {what}, got `{got}`", call_site())

"""The place of an output: a path on this machine, or an address such as `s3://bucket/cell.zip`."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TypeAlias

Place: TypeAlias = Path | str
"""A path, or an address as text."""
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]+://")


def is_address(text: object) -> bool:
    """Return whether a text is an address and not a path.

    >>> is_address("s3://bucket/a.zip"), is_address("build/a.zip"), is_address("c:/a.zip")
    (True, False, False)
    """
    return isinstance(text, str) and _ADDRESS.match(text) is not None


def place(folder: Path, out: str) -> Place:
    """Return the place that a text in a folder names.

    >>> place(Path("/home/me"), "a.zip").as_posix(), place(Path("/home/me"), "s3://bucket/a.zip")
    ('/home/me/a.zip', 's3://bucket/a.zip')
    """
    return out if is_address(out) else Path(os.path.abspath(folder / out))

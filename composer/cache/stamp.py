"""The stamps of files: what changes when a file does, as far as one can tell without reading it."""

from __future__ import annotations

import os

Stamp = tuple[int, int, int, int]
"""Size, times of the last change of content and of the inode in ns, and inode."""


def stamp_of(status: os.stat_result) -> Stamp:
    """The stamp of a file by its status. No I/O."""
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino

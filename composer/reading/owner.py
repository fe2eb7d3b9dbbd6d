"""Whose a folder is: what another user can change is not trusted."""

from __future__ import annotations

import os
import stat


def untrusted(folder: str | os.PathLike[str]) -> str | None:
    """Why a folder for this user alone is not trusted; None if it is, or does not exist.

    >>> untrusted("/no/such/folder") is None
    True
    """
    status = _status(folder)
    if status is None:
        return None
    if status.st_uid != os.geteuid():
        return "it belongs to another user"
    return "every user may write to it" if status.st_mode & stat.S_IWOTH else None


def untrusted_for_temporary(folder: str | os.PathLike[str] | None = None) -> str | None:
    """The same of the folder for temporary files, which may be the system's if none removes what others have there."""
    if folder is None:
        import tempfile  # the store, whose owner is asked by every build, is elsewhere

        folder = tempfile.gettempdir()
    status = _status(folder)
    if status is None:
        return None
    if status.st_uid not in (os.geteuid(), 0):
        return "it belongs to another user"
    is_open = status.st_mode & stat.S_IWOTH and not status.st_mode & stat.S_ISVTX
    return "every user may remove what others have in it" if is_open else None


def _status(folder: str | os.PathLike[str]) -> os.stat_result | None:
    """None also where files have no owner of this kind, as on Windows."""
    if not hasattr(os, "geteuid"):
        return None
    try:
        return os.stat(folder)
    except (OSError, ValueError):
        return None

"""Check the owner of a folder: folders that another user can change are not trusted."""

from __future__ import annotations

import os
import stat


def untrusted(folder: str | os.PathLike[str]) -> str | None:
    """Return why a private folder is not trusted; None if it is, or if it does not exist.

    >>> untrusted("/no/such/folder") is None
    True
    """
    try:
        status = _status(folder)
    except Exception as error:
        return _unknown(error)
    if status is None:
        return None
    if status.st_uid != os.geteuid():
        return "it belongs to another user"
    return "every user may write to it" if status.st_mode & stat.S_IWOTH else None


def untrusted_for_temporary(folder: str | os.PathLike[str] | None = None) -> str | None:
    """Return why a folder for temporary files is not trusted. It may be the system's if its sticky bit is set."""
    if folder is None:
        import tempfile  # the store, whose owner is asked by every build, is elsewhere

        folder = tempfile.gettempdir()
    try:
        status = _status(folder)
    except Exception as error:
        return _unknown(error)
    if status is None:
        return None
    if status.st_uid not in (os.geteuid(), 0):
        return "it belongs to another user"
    is_open = status.st_mode & stat.S_IWOTH and not status.st_mode & stat.S_ISVTX
    return "every user may remove what others have in it" if is_open else None


def _status(folder: str | os.PathLike[str]) -> os.stat_result | None:
    """Return the status; None also on systems without such owners, as on Windows. Raises OSError and ValueError."""
    if not hasattr(os, "geteuid"):
        return None
    try:
        return os.stat(folder)
    except (FileNotFoundError, NotADirectoryError):
        return None


def _unknown(error: Exception) -> str:
    return (
        f"nobody can tell whose it is: {(getattr(error, 'strerror', None) or type(error).__name__).lower()}"
    )

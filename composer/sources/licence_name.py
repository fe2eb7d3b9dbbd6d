"""What licence files are called."""

from __future__ import annotations

import os
import re

_NAME = re.compile(r"(licen[sc]e|copying|notice)s?([-_. ].*)?", re.IGNORECASE)
_FOLDER = re.compile("licen[sc]es", re.IGNORECASE)
_DEPTH = 3
_NOT_TEXT = frozenset(
    {".py", ".pyc", ".pyi", ".js", ".json", ".xml", ".yaml", ".yml", ".toml", ".sh", ".h", ".png"}
)


def is_licence(name: str) -> bool:
    """Whether a file of that name is a licence or a notice. No I/O.

    >>> [name for name in ("LICENSE", "licence-mit.txt", "licenses.py", "NOTICED") if is_licence(name)]
    ['LICENSE', 'licence-mit.txt']
    """
    return _NAME.fullmatch(name) is not None and _is_text(name)


def licences_in(folder: str) -> list[str]:
    """The licences in a folder, by their paths in it, in order. Raises OSError.

    All texts in a folder `LICENSES` there are such: the layout of REUSE, and of a bundle.
    """
    names = os.listdir(folder)
    found = [name for name in names if is_licence(name) and not os.path.isdir(os.path.join(folder, name))]
    for name in filter(_FOLDER.fullmatch, names):
        for path, _, files in os.walk(os.path.join(folder, name)):
            below = os.path.relpath(path, folder)
            found += [os.path.join(below, file) for file in files if _is_text(file)]
    return sorted(found)


def licence_folders(folder: str) -> list[str]:
    """The folders `LICENSES` in a folder, and those below them; none where it cannot be read."""
    try:
        names = [name for name in os.listdir(folder) if _FOLDER.fullmatch(name)]
    except OSError:
        return []
    return sorted(path for name in names for path, _, _ in os.walk(os.path.join(folder, name)))


def licence_names(folder: str) -> str:
    """What tells whether the licences in a folder are others, a line for each. Raises OSError.

    That has the folders in which there may be more, of which each is asked by itself.
    """
    if any(map(_FOLDER.fullmatch, folder.split(os.sep)[-_DEPTH:])):
        return "\n".join(sorted(os.listdir(folder)))
    return "\n".join(sorted(name for name in os.listdir(folder) if is_licence(name)))


def _is_text(name: str) -> bool:
    return not name.startswith(".") and os.path.splitext(name)[1].lower() not in _NOT_TEXT

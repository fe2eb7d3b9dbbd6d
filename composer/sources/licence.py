"""Find the licence files of a model, and recognise them by name."""

from __future__ import annotations

import os
import re
from pathlib import Path

from composer.reading.folders import real_folder
from composer.reading.memory import Memory

LEVELS = 3
"""How many folders above its own a model's licence may be."""
_NAME = re.compile(r"(licen[sc]e|copying|notice)s?([-_. ].*)?", re.IGNORECASE)
_FOLDER = re.compile("licen[sc]es", re.IGNORECASE)
_DEPTH = 3
_NOT_TEXT = frozenset(
    {".py", ".pyc", ".pyi", ".js", ".json", ".xml", ".yaml", ".yml", ".toml", ".sh", ".h", ".png"}
)


def find(model: Path, base: Path | None = None) -> tuple[Path, ...]:
    """Return the licence files of the nearest folder that has any: the model's own, or one of the `LEVELS` above it.

    All texts in a folder `LICENSES` count. The search stays inside `base`, does not go above a folder with `.git`,
    and stops below the folder where Python packages are installed. Empty if there are none. Reads folders only, no
    files.
    """
    folder = Path(real_folder(os.fspath(model.parent)))
    top = Path(os.path.realpath(base)) if base is not None else None
    for _ in range(LEVELS + 1):
        if folder.name in ("site-packages", "dist-packages"):
            break
        if found := tuple(sorted(_in_folder(folder))):
            return found
        if folder in (top, folder.parent) or os.path.exists(folder / ".git"):
            break
        folder = folder.parent
    return ()


def _in_folder(folder: Path) -> list[Path]:
    try:
        return [path for name in licences_in(os.fspath(folder)) if os.path.isfile(path := folder / name)]
    except OSError:
        return []


def is_licence(name: str) -> bool:
    """Return whether a file name is that of a licence or a notice. No I/O.

    >>> [name for name in ("LICENSE", "licence-mit.txt", "licenses.py", "NOTICED") if is_licence(name)]
    ['LICENSE', 'licence-mit.txt']
    """
    return _NAME.fullmatch(name) is not None and _is_text(name)


def licences_in(folder: str) -> list[str]:
    """Return the sorted relative paths of the licences in a folder. Raises OSError.

    All texts in a folder `LICENSES` count, as in the layout of REUSE and in a bundle.
    """
    names = _remembered.ask(folder)
    found = [name for name in names if is_licence(name) and not os.path.isdir(os.path.join(folder, name))]
    for name in filter(_FOLDER.fullmatch, names):
        for path, _, files in os.walk(os.path.join(folder, name)):
            below = os.path.relpath(path, folder)
            found += [os.path.join(below, file) for file in files if _is_text(file)]
    return sorted(found)


def _names(folder: str) -> list[str]:
    """What has to do with licences in a folder."""
    return [name for name in os.listdir(folder) if is_licence(name) or _FOLDER.fullmatch(name)]


# Each of many models looks in the same four folders.
_remembered = Memory(_names, _names)


def licence_folders(folder: str) -> list[str]:
    """Return the folders `LICENSES` in a folder and all folders below them; none if it cannot be read."""
    try:
        names = [name for name in os.listdir(folder) if _FOLDER.fullmatch(name)]
    except OSError:
        return []
    return sorted(path for name in names for path, _, _ in os.walk(os.path.join(folder, name)))


def licence_names(folder: str) -> str:
    """Return a text that changes when the licences in a folder change. Raises OSError.

    Folders that may hold more licences are checked separately.
    """
    if any(map(_FOLDER.fullmatch, folder.split(os.sep)[-_DEPTH:])):
        return "\n".join(sorted(os.listdir(folder)))
    return "\n".join(sorted(name for name in os.listdir(folder) if is_licence(name)))


def _is_text(name: str) -> bool:
    return not name.startswith(".") and os.path.splitext(name)[1].lower() not in _NOT_TEXT

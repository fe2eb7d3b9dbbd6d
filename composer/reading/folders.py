"""Resolve and list folders, cached until a folder changes.

Each model has its own door. Resolving the links of six folders and searching each for markers of a project takes
longer than the rest of reading a 3 kB model; one `stat` of a folder shows whether it is unchanged.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from itertools import islice

from composer.reading.memory import Memory

_FEW, _LISTED = 4, 16
"""The least number of files for which a folder is listed, and how many entries are looked at for each of them."""
_real = Memory(os.path.realpath, os.path.realpath)


def real_folder(folder: str) -> str:
    """Return the real path of a folder, which need not exist."""
    return _real.ask(folder)


def parted(path: str) -> tuple[str, str]:
    """Split a path into its folder, including the separator, and the name."""
    if os.altsep is not None:
        return os.path.split(path)
    at = path.rfind(os.sep) + 1
    return path[:at], path[at:]


def files_among(paths: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
    """Yield folders, and those of the paths in them that one look at the folder shows to be ordinary files.

    It misses links, single files in a folder, and files far down in a long folder. Asking for sixty files one by
    one takes ten times as long.
    """
    wanted: dict[str, dict[str, str]] = {}
    for path in paths:
        folder, name = parted(path)
        wanted.setdefault(folder, {})[name] = path
    for folder, names in wanted.items():
        if len(names) < _FEW:
            continue
        found: list[str] = []
        try:
            with os.scandir(folder) as entries:
                for each in islice(entries, _LISTED * len(names)):
                    if (name := each.name) in names and each.is_file(follow_symlinks=False):
                        found.append(names[name])
        except (OSError, ValueError):
            continue
        yield folder, found


def real_path(path: str | os.PathLike[str]) -> str:
    """Return the real path of a path, which need not exist."""
    text = os.fspath(path)
    folder, name = os.path.split(text)
    if name in ("", os.curdir, os.pardir) or os.path.islink(text):
        return os.path.realpath(text)
    return os.path.join(real_folder(folder), name)


def memory_of(names: tuple[str, ...]) -> Callable[[str], bool]:
    """Return a cached function that says whether a folder has an entry with one of these names."""

    def holds_any(folder: str) -> bool:
        # `exists` raises and catches an exception for each missing name.
        return any(os.access(f"{folder}{os.sep}{name}", os.F_OK) for name in names)

    return Memory(holds_any, lambda _: False).ask

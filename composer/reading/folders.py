"""Where folders really are and what is in them: looked up once, and again as soon as a folder has changed.

Each model has a door of its own. To follow the links of six folders and to look in each for what makes it a project
takes longer than all else of reading a model of 3 kB; one look at a folder (`stat`) says whether it is still the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from itertools import islice

from composer.reading.memory import Memory

_FEW, _LISTED = 4, 16
"""Files of a folder for which it is listed, and how many entries of it are looked at for each."""
_real = Memory(os.path.realpath, os.path.realpath)


def real_folder(folder: str) -> str:
    """Where a folder really is, links followed; also one that does not exist."""
    return _real.ask(folder)


def parted(path: str) -> tuple[str, str]:
    """The folder of a path, with what parts it from the name, and the name."""
    if os.altsep is not None:
        return os.path.split(path)
    at = path.rfind(os.sep) + 1
    return path[:at], path[at:]


def files_among(paths: Iterable[str]) -> Iterator[tuple[str, list[str]]]:
    """Folders, and those of some paths in them that one look at the folder shows to be ordinary files, no links.

    Others may be, too: links, what is alone in its folder, and what is far down in a long list are not looked at. To
    ask for sixty files one by one takes ten times as long.
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
    """Where a path leads, links followed, also where there is nothing."""
    text = os.fspath(path)
    folder, name = os.path.split(text)
    if name in ("", os.curdir, os.pardir) or os.path.islink(text):
        return os.path.realpath(text)
    return os.path.join(real_folder(folder), name)


def memory_of(names: tuple[str, ...]) -> Callable[[str], bool]:
    """A function that says whether something of one of these names is in a folder."""

    def holds_any(folder: str) -> bool:
        # `exists` raises and catches an exception for each name that is not there.
        return any(os.access(f"{folder}{os.sep}{name}", os.F_OK) for name in names)

    return Memory(holds_any, lambda _: False).ask

"""Collect the licence files of the parts for a bundle."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from composer.dataclass import dataclass
from composer.reading.regular import read_regular

LICENCES = "LICENSES"
_UNSAFE = re.compile(r"[^\w.+@=-]+")


@dataclass(frozen=True, slots=True)
class Licences:
    """The licence files of a bundle: `files` by their paths in it, `of` their paths by label."""

    files: Mapping[str, bytes]
    of: Mapping[str, tuple[str, ...]]


def licence_files(
    licences: Mapping[str, Iterable[Path]], read: Callable[[Path], bytes] = read_regular
) -> Licences:
    """Return every licence file once, as `LICENSES/LABEL/FILE NAME`.

    `licences` maps a label (a part's prefix such as `left/gripper`, or a source) to its licence files. Equal files
    of one name go under the first label. Files of one label with the same name and different contents are numbered.
    Raises OSError if a file cannot be read.
    """
    files: dict[str, bytes] = {}
    of: dict[str, tuple[str, ...]] = {}
    taken: set[str] = set()
    placed: dict[tuple[str, bytes], str] = {}
    known: dict[Path, bytes] = {}
    for label, sources in sorted(licences.items()):
        paths: dict[str, None] = {}
        for file in sorted(sources):
            if file not in known:
                known[file] = read(file)
            name, content = _segment(file.name), known[file]
            if (name, content) not in placed:
                path = _free(f"{licence_folder(label)}/{name}", file.suffix, taken)
                placed[name, content] = path
                files[path] = content
            paths[placed[name, content]] = None
        of[label] = tuple(paths)
    return Licences(files, of)


def _free(path: str, suffix: str, taken: set[str]) -> str:
    """Return the path, with a number if it is taken."""
    stem, number = path.removesuffix(suffix), 1
    while path.casefold() in taken:
        number += 1
        path = f"{stem}-{number}{suffix}"
    taken.add(path.casefold())
    return path


def licence_folder(label: str) -> str:
    """Return the folder in the bundle for the licences of a label.

    >>> licence_folder("left/gripper")
    'LICENSES/left/gripper'
    """
    parts = [_segment(part) for part in re.split(r"[/\\]", label) if part]
    return "/".join([LICENCES, *(parts or ["model"])])


def _segment(name: str) -> str:
    """Return a name as a path segment that is valid on every file system."""
    return _UNSAFE.sub("_", name).strip(".") or "_"

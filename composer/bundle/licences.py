"""The licences of the parts, which travel with what is made of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from composer.reading.regular import read_regular

LICENCES = "LICENSES"
_UNSAFE = re.compile(r"[^\w.+@=-]+")


@dataclass(frozen=True, slots=True)
class Licences:
    """`files` are paths in the bundle and contents; `of` has the paths of each label."""

    files: Mapping[str, bytes]
    of: Mapping[str, tuple[str, ...]]


def licence_files(
    licences: Mapping[str, Iterable[Path]], read: Callable[[Path], bytes] = read_regular
) -> Licences:
    """Every licence file once, as `LICENSES/LABEL/FILE NAME`: equal bytes of one name have the first of their labels.

    `licences` maps a label (a part's prefix such as `left/gripper`, or a source) to its licence files. Files
    of one label with the same name and different content are numbered. Raises OSError when a file cannot be
    read.
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
    """The path, numbered if there is one like it already."""
    stem, number = path.removesuffix(suffix), 1
    while path.casefold() in taken:
        number += 1
        path = f"{stem}-{number}{suffix}"
    taken.add(path.casefold())
    return path


def licence_folder(label: str) -> str:
    """Where the licences of one label stand in the bundle.

    >>> licence_folder("left/gripper")
    'LICENSES/left/gripper'
    """
    parts = [_segment(part) for part in re.split(r"[/\\]", label) if part]
    return "/".join([LICENCES, *(parts or ["model"])])


def _segment(name: str) -> str:
    """A name as one segment of a path that every file system can hold."""
    return _UNSAFE.sub("_", name).strip(".") or "_"

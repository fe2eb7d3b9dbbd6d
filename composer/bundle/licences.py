"""The licences of the parts, which travel with what is made of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

LICENCES = "LICENSES"
_UNSAFE = re.compile(r"[^\w.+@=-]+")


def licence_files(
    licences: Mapping[str, Iterable[Path]], read: Callable[[Path], bytes] = Path.read_bytes
) -> dict[str, bytes]:
    """Paths in the bundle and contents: `LICENSES/LABEL/FILE NAME`.

    `licences` maps a label (a part's prefix such as `left/gripper`, or a source) to its licence files. Files
    of one label with the same name and different content are numbered. Raises OSError when a file cannot be
    read.
    """
    found: dict[str, bytes] = {}
    taken: set[str] = set()
    for label, files in sorted(licences.items()):
        for file in sorted(files):
            content = read(file)
            path = f"{licence_folder(label)}/{_segment(file.name)}"
            stem, suffix = path.removesuffix(file.suffix), file.suffix
            number = 1
            while path.casefold() in taken and found.get(path) != content:
                number += 1
                path = f"{stem}-{number}{suffix}"
            taken.add(path.casefold())
            found[path] = content
    return found


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

"""Find the folders for `package://NAME` in a URDF file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

_REFERENCE = re.compile(r"package://([^/\"'<>\s]+)/")


def packages_in(text: str) -> tuple[str, ...]:
    """Return the sorted names of the packages that a text refers to. No I/O.

    >>> packages_in('<mesh filename="package://arm/a.stl"/> <mesh filename="package://arm/b.stl"/>')
    ('arm',)
    """
    return tuple(sorted(set(_REFERENCE.findall(text))))


def folders(names: tuple[str, ...], urdf: Path, given: Mapping[str, Path]) -> dict[str, Path]:
    """Return the folder of each package: the given one, or the nearest folder of that name above the file.

    ROS keeps the description of a robot in the package that provides its meshes.
    """
    above = {folder.name: folder for folder in reversed(list(_above(urdf)))}
    known = {**above, **given}
    return {name: known[name] for name in names if name in known}


def beside(name: str, urdf: Path) -> Path | None:
    """Return a folder of that name beside one above the file. It is probably meant, but only suggested."""
    return next((found for folder in _above(urdf) if (found := folder / name).is_dir()), None)


def _above(urdf: Path) -> Iterator[Path]:
    yield from Path(os.path.abspath(urdf)).parents

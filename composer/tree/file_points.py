"""How many points the files of a model have: counted before MuJoCo makes bodies or hulls of them."""

from __future__ import annotations

import os
from collections.abc import Callable

from lxml.etree import _Element as Node

from composer.numerics.points import most_points, most_points_in, points_in
from composer.reading.memory import Memory
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.tree.files import join, written_path
from composer.tree.unit import Unit

_MOST_KINDS = 16
"""Kinds of files of which something is remembered: models may make up others."""


def file_points(element: Node, unit: Unit) -> int:
    """At least so many points that its file has; 0 for a file that there is not, which is reported elsewhere."""
    return _asked(points_in, element, unit) or 0


def most_file_points(element: Node, unit: Unit) -> int | None:
    """Return an upper bound of the points of its file after a quick look; None if only counting can tell."""
    return _asked(most_points_in, element, unit)


def most_points_by_size(element: Node, unit: Unit) -> int | None:
    """Return an upper bound of the points of its file, which is not opened; None if only its bytes can tell."""
    held, kind = _file(element, unit)
    try:
        return most_points(
            len(held) if isinstance(held, bytes) else os.stat(unit.door.admit(held)).st_size, kind
        )
    except (OSError, Refused):
        return 0


def _file(element: Node, unit: Unit) -> tuple[bytes | str, str]:
    """Its bytes, or the path of them, and how its name ends; MuJoCo believes `content_type` rather than the name."""
    path = written_path(unit.settings, element, str(element.get("file") or ""))
    told = str(element.get("content_type") or "").lower().rpartition("/")[2]
    held = unit.contents.get(path)
    where = held if isinstance(held, bytes) else str(held or join(str(unit.directory), path))
    return where, told or path.lower().rpartition(".")[2]


def _asked(count: _Count, element: Node, unit: Unit) -> int | None:
    held, kind = _file(element, unit)
    if isinstance(held, bytes):
        return count(held, kind)
    try:
        return _memory(count, kind).ask(unit.door.admit(held))
    except (OSError, Refused):
        return 0


_Count = Callable[[bytes, str], int | None]
_memories: dict[tuple[_Count, str], Memory[int | None]] = {}


def _memory(count: _Count, kind: str) -> Memory[int | None]:
    """Return what is known of the files that are counted in this way and read as this kind."""
    known = _memories.get((count, kind))
    if known is None:
        known = Memory(lambda path: count(read_regular(path), kind), lambda _: 0)
        if len(_memories) <= _MOST_KINDS:
            _memories[count, kind] = known
    return known

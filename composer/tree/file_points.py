"""How many points the files of a model have: counted before MuJoCo makes bodies or hulls of them."""

from __future__ import annotations

import os

from lxml.etree import _Element as Node

from composer.numerics.points import most_points, points_in
from composer.reading.memory import Memory
from composer.reading.refused import Refused
from composer.reading.regular import read_regular
from composer.tree.files import join, written_path
from composer.tree.unit import Unit


def file_points(element: Node, unit: Unit) -> int:
    """At least so many points that its file has; 0 for a file that there is not, which is reported elsewhere."""
    held, kind = _file(element, unit)
    if isinstance(held, bytes):
        return points_in(held, kind)
    try:
        return _memory(kind).ask(unit.door.admit(held))
    except (OSError, Refused):
        return 0


def most_file_points(element: Node, unit: Unit) -> int | None:
    """No more than so many, as its size shows; None where only its bytes can tell."""
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


_memories: dict[str, Memory[int]] = {}


def _memory(kind: str) -> Memory[int]:
    """What is known of the files that are read as this kind."""
    if kind not in _memories:
        if len(_memories) > 8:  # kinds that somebody made up
            return Memory(lambda path: points_in(read_regular(path), kind), lambda _: 0)
        _memories[kind] = Memory(lambda path: points_in(read_regular(path), kind), lambda _: 0)
    return _memories[kind]

"""Count the elements that a unit's sub-models contribute: each file once, however often it is attached."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.limits import in_force
from composer.link.submodels import door_of_submodel, parse_held
from composer.tree.expansion import expanded
from composer.tree.files import join
from composer.tree.parse import parse_file
from composer.tree.unit import Unit


def attached_size(unit: Unit) -> Callable[[Node], int]:
    """Return a function for the number of elements that an `<attach>` of the unit adds, 0 for an unreadable model."""
    return _sizes_in(unit, {}, 0)


def _sizes_in(unit: Unit, known: dict[str, int], depth: int) -> Callable[[Node], int]:
    files = {
        str(each.get("name") or Path(str(each.get("file"))).stem): str(each.get("file") or "")
        for each in unit.root.iterfind("asset/model")
    }

    def size(attach: Node) -> int:
        file = files.get(str(attach.get("model")), "")
        return _size_of(unit, file, known, depth + 1) if file else 0

    return size


def _size_of(unit: Unit, file: str, known: dict[str, int], depth: int) -> int:
    if depth > in_force().nesting:  # reported where it is bundled
        return 0
    held = unit.contents.get(file)
    key = str(held) if isinstance(held, Path) else join(str(unit.directory), file)
    if isinstance(held, bytes):
        key = f"{key}#{id(held)}"
    if key not in known:
        known[key] = 0  # a model that is made of itself, which is reported where it is bundled
        sub = (
            parse_held(unit, file, held, Sink())
            if isinstance(held, bytes)
            else parse_file(Path(key), Sink(), door=door_of_submodel(unit, Path(key), held))
        )
        known[key] = expanded(sub.root, _sizes_in(sub, known, depth)) if sub is not None else 0
    return known[key]

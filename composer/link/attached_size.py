"""How much the sub-models of a unit bring: each file is counted once, however often it is attached."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.limits import in_force
from composer.link.submodels import door_of_submodel, parse_held
from composer.tree.expansion import expanded
from composer.tree.file_points import file_points
from composer.tree.files import join
from composer.tree.mesh_points import mesh_points
from composer.tree.parse import parse_file
from composer.tree.unit import Unit
from composer.tree.weight import NOTHING, Weight


def attached_size(unit: Unit) -> Callable[[Node], Weight]:
    """A function that says what an `<attach>` of the unit brings; nothing for what cannot be read."""
    return _sizes_in(unit, {}, 0)


def _sizes_in(unit: Unit, known: dict[str, Weight], depth: int) -> Callable[[Node], Weight]:
    files = {
        str(each.get("name") or Path(str(each.get("file"))).stem): str(each.get("file") or "")
        for each in unit.root.iterfind("asset/model")
    }

    def size(attach: Node) -> Weight:
        file = files.get(str(attach.get("model")), "")
        return _size_of(unit, file, known, depth + 1) if file else NOTHING

    return size


def _size_of(unit: Unit, file: str, known: dict[str, Weight], depth: int) -> Weight:
    if depth > in_force().nesting:  # reported where it is bundled
        return NOTHING
    held = unit.contents.get(file)
    key = str(held) if isinstance(held, Path) else join(str(unit.directory), file)
    if isinstance(held, bytes):
        key = f"{key}#{id(held)}"
    if key not in known:
        known[key] = NOTHING  # a model that is made of itself, which is reported where it is bundled
        sub = (
            parse_held(unit, file, held, Sink())
            if isinstance(held, bytes)
            else parse_file(Path(key), Sink(), door=door_of_submodel(unit, Path(key), held))
        )
        known[key] = NOTHING if sub is None else _whole(sub, known, depth)
    return known[key]


def _whole(sub: Unit, known: dict[str, Weight], depth: int) -> Weight:
    weight = expanded(sub.root, _sizes_in(sub, known, depth), lambda flexcomp: file_points(flexcomp, sub))
    return weight._replace(points=weight.points + mesh_points(sub))

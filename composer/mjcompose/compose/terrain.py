"""Height fields that mjcompose makes: their files, and the places of their geoms."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from mjcompose.base.access import held
from mjcompose.base.dataclass import Struct
from mjcompose.base.naming import portable_path
from mjcompose.base.rotation import IDENTITY_QUAT, Pose
from mjcompose.compose.elements import ElementBuilder
from mjcompose.link import numbers
from mjcompose.link.files import ASSETS
from mjcompose.link.linking import FileUse, Linking
from mjcompose.link.numbers import read_pose
from mjcompose.tree import journal
from mjcompose.tree.classes import ORIENTATIONS, text_in_effect
from mjcompose.tree.select import kind_of, name_of, section_of

if TYPE_CHECKING:
    from mjcompose.language.terrain import Terrain
    from mjcompose.mujoco.heights import HeightField

_BASE = 0.5
"""The thickness of the ground below its lowest place: bodies would fall through a thin one."""
_FILE_NAME = re.compile(r"[^\w.+-]")
_LOWERED = journal.because("placed so that height 0 of the terrain is at `pos`")


class MadeTerrain(Struct):
    """A height field of the model that mjcompose made."""

    node: Node
    terrain: Terrain
    field: HeightField


def write_terrains(linking: Linking, making: ElementBuilder) -> list[MadeTerrain]:
    """Write the files of the terrains of a recipe, and lower its geoms with these."""
    found = [_written(linking, node, element.terrain) for node, element in making.made.items() if element.terrain]
    if found:
        lows = {name_of(each.node): each.field.low for each in found}
        for geom in [node for node in making.made if node.tag == "geom" and section_of(node) == "worldbody"]:
            name = text_in_effect(geom, kind_of(geom), "hfield", classes=linking.base.classes)
            if low := lows.get(name, 0.0):
                _lower(linking, making, geom, low)
    return found


def _written(linking: Linking, node: Node, terrain: Terrain) -> MadeTerrain:
    field = height_field(terrain)
    content = field.content
    name = _FILE_NAME.sub("_", name_of(node) or "")
    path = portable_path(f"{ASSETS}/{name}.{hashlib.sha256(content).hexdigest()[:8]}.hfield")
    rows, columns = terrain.shape
    size = ((columns - 1) * terrain.cell / 2, (rows - 1) * terrain.cell / 2, field.rise, _BASE)
    base = linking.base
    computed = journal.because("computed from `terrain`", base.origins.lasting_place(node, base.file))
    journal.write(node, "file", path, computed)
    journal.write(node, "size", numbers.text([round(each, 9) for each in size]), computed)
    source = held(os.path.join(linking.base.directory, path))
    linking.files.append(FileUse(node, "file", path, source=source, content=content))
    return MadeTerrain(node, terrain, field)


def height_field(terrain: Terrain) -> HeightField:
    """Return the heights of a terrain of a recipe."""
    from mjcompose.mujoco.heights import GroundKind, TerrainLayout, made  # imports numpy

    layout = TerrainLayout(
        [GroundKind(str(ground.kind), ground.settings()) for ground in terrain.grounds],
        terrain.levels,
        terrain.size,
        cell=terrain.cell,
        border=terrain.border,
        seed=terrain.seed,
        cells=terrain.cells,
        shape=terrain.shape,
    )
    return made(layout)


def _lower(linking: Linking, making: ElementBuilder, geom: Node, low: float) -> None:
    """Move a geom so that its place is that of height 0, not of the lowest height as in MuJoCo."""
    classes = linking.base.classes
    kind = kind_of(geom)
    given = {name: text_in_effect(geom, kind, name, classes=classes) for name in ("pos", *ORIENTATIONS)}
    own = [name for name in ORIENTATIONS if geom.get(name)]
    turned = own or [name for name in ORIENTATIONS if given[name]]
    attributes = {name: str(given[name]) for name in ("pos", *turned) if given[name]}
    pose = read_pose(attributes, making.model_angle == "degree", making.model_eulerseq)
    lowered = pose @ Pose((0.0, 0.0, low), IDENTITY_QUAT)
    journal.write(geom, "pos", numbers.text([round(each, 9) for each in lowered.pos]), _LOWERED)


def about(terrains: Iterable[MadeTerrain]) -> bytes | None:
    """Return the file about the terrains of a model, or None if it has none."""
    found = {name_of(each.node): dict(_facts(each)) for each in terrains}
    if not found:
        return None
    return (json.dumps(found, indent=1) + "\n").encode()


def _facts(made: MadeTerrain) -> Iterator[tuple[str, object]]:
    terrain = made.terrain
    yield "kinds", [ground.kind for ground in terrain.grounds]
    yield "difficulties", [round(level, 9) for level in terrain.levels]
    yield "size", list(terrain.size)
    yield "cell", terrain.cell
    yield "seed", terrain.seed
    yield "origins", made.field.origins.round(9).tolist()

"""Join cells of one kinematic tree into one model: its bodies have places for the geoms of all cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.read import read
from mjcompose.bundle.staging import write_folder
from mjcompose.mujoco.attributes import NameTable
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.varying import Differences, flat
from mjcompose.sources.context import Context
from mjcompose.tools.worlds.cell_numbers import FRAMED, CellNumbers
from mjcompose.tools.worlds.join import Joined, WorldGroup
from mjcompose.tools.worlds.joint_text import MODEL, CellText, JointText, asset_numbers, hulls
from mjcompose.tools.worlds.load import load
from mjcompose.tools.worlds.names import failure
from mjcompose.tools.worlds.of_sources import build_of_sources
from mjcompose.tools.worlds.proof import check_cell
from mjcompose.tools.worlds.same_tree import CODE, check_same_tree
from mjcompose.tools.worlds.slots import GeomKey, GeomSlot, shared_of, slots_of_bodies
from mjcompose.tools.worlds.worlds import Varying, model_of_world

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_BODY_DISTANCES = frozenset(
    int(getattr(mujoco.mjtSensor, f"mjSENS_GEOM{word}")) for word in ("DIST", "NORMAL", "FROMTO")
)
_OF_BODIES = (int(mujoco.mjtObj.mjOBJ_BODY), int(mujoco.mjtObj.mjOBJ_XBODY))


class JointModel(Struct):
    """Cells of one tree as one group of worlds. `present` has the geoms of each cell, `(cells, ngeom)`."""

    group: WorldGroup
    bundle: Bundle
    present: NDArray[np.bool_]


class JointPlace(Struct):
    """Where a joint model is written: its name, and the means to build it."""

    folder: Path
    name: str
    context: Context
    session: Session


def join_cells(groups: Sequence[WorldGroup], place: JointPlace, *, fixed_assets: bool = False) -> JointModel:
    """Join groups of worlds with one kinematic tree.

    With `fixed_assets`, a geom has one mesh and one material in all worlds. Raises LoadError.
    """
    first = groups[0].first
    models = [group.first.loaded.model for group in groups]
    for group in groups[1:]:
        check_same_tree(models[0], group.first.loaded.model, (first.name, group.first.name))
    texts = [CellText(_folder(group.first), group.first.name, group.first.loaded.model) for group in groups]
    bodies = slots_of_bodies(models, _with_assets(texts) if fixed_assets else shared_of)
    _check_distances(groups, bodies)
    _warn_of_padding(bodies, groups, place.context)
    text = JointText(texts)
    text.add_geoms(bodies)
    text.set_inertias()
    text.make_convex(hulls(text, bodies).missing)
    bundle = _built(text, place, [read(_folder(group.first)) for group in groups])
    folder = place.folder / f"{place.name}-joint"
    write_folder(bundle, folder)
    loaded = load(folder)
    slots = [slot for own in bodies for slot in own]
    numbers = asset_numbers(text, loaded.model)
    cells = [CellNumbers(loaded.model, model, slots, cell, numbers[cell]) for cell, model in enumerate(models)]
    joined = Joined(loaded, first.name, first.cell, sample=first.sample, table=first.table, folder=folder)
    worlds = [world for group in groups for world in group.worlds]
    group = WorldGroup(joined, _differences(loaded.model, groups, cells), worlds=worlds)
    check_worlds(group, groups, cells)
    present = np.array([cell.geoms >= 0 for cell in cells]).reshape(len(cells), -1)
    return JointModel(group, bundle, present)


def _folder(joined: Joined) -> Path:
    assert joined.folder is not None
    return joined.folder


def _with_assets(texts: Sequence[CellText]) -> Callable[[MjModel, int], GeomKey]:
    """Return a key that lets two geoms share a slot only if they have the same mesh and the same material."""
    contents = {id(text.model): text.contents for text in texts}

    def key(model: MjModel, geom: int) -> GeomKey:
        hashes = contents[id(model)].hashes
        data = int(model.geom_dataid[geom])
        kind = "hfield" if model.geom_type[geom] == int(mujoco.mjtGeom.mjGEOM_HFIELD) else "mesh"
        material = int(model.geom_matid[geom])
        return (
            shared_of(model, geom),
            hashes[kind][data] if data >= 0 else "",
            hashes["material"][material] if material >= 0 else "",
        )

    return key


def _check_distances(groups: Sequence[WorldGroup], bodies: Sequence[Sequence[GeomSlot]]) -> None:
    """Raise LoadError if a sensor measures the distance of a body with geoms that some cell lacks."""
    padded = {body for body, slots in enumerate(bodies) if any(len(slot.geoms) < len(groups) for slot in slots)}
    first = groups[0].first
    model = first.loaded.model
    table = NameTable(model)
    for sensor in np.flatnonzero(np.isin(model.sensor_type, list(_BODY_DISTANCES))).tolist():
        for word in ("obj", "ref"):
            body = int(getattr(model, f"sensor_{word}id")[sensor])
            if int(getattr(model, f"sensor_{word}type")[sensor]) in _OF_BODIES and body in padded:
                message = (
                    f"`{groups[1].first.name}` cannot be a world of `{first.name}`: the sensor"
                    f" `{table.describe('sensor', sensor)}` measures the distance of the body"
                    f" `{table.describe('body', body)}`, whose absent geoms it would see"
                )
                raise failure(CODE, message, "name the geom in the sensor")


_MUCH = 2


def _warn_of_padding(bodies: Sequence[Sequence[GeomSlot]], groups: Sequence[WorldGroup], context: Context) -> None:
    count = sum(map(len, bodies))
    largest = max(group.first.loaded.model.ngeom for group in groups)
    if count <= _MUCH * largest:
        return
    slots = max(bodies, key=len)
    most = max(sum(cell in slot.geoms for slot in slots) for cell in range(len(groups)))
    context.sink.warning(
        "worlds-padded",
        f"one body has {len(slots)} places for geoms, of which a world uses {most} at most",
        help="use the same contype, conaffinity, condim, priority and group in all cells",
    )


def _built(text: JointText, place: JointPlace, bundles: Sequence[Bundle]) -> Bundle:
    source = place.folder / f"{place.name}-text"
    source.mkdir(parents=True)
    text.write(source, place.name)
    recipe = {"recipe": 1, "name": place.name, "base": f"./{source.name}/{MODEL}"}
    path = place.folder / f"{place.name}.yaml"
    return build_of_sources(recipe, path, bundles, place.context, session=place.session)


def _differences(joint: MjModel, groups: Sequence[WorldGroup], cells: Sequence[CellNumbers]) -> Differences:
    """Return the differences of all worlds from a joint model, in the order of the groups."""
    found = Differences(joint, sum(len(group.worlds) for group in groups))
    first = 0
    for group, cell in zip(groups, cells, strict=True):
        varying = dict(group.varying())
        if _FOLLOWED & varying.keys():
            for world in range(len(group.worlds)):
                found.take(first + world, cell.of(model_of_world(cell.model, varying, world)).whole())
        else:
            found.take(first, cell.whole(), len(group.worlds))
            for name, own in varying.items():
                index, values = _in_joint(cell, name, own)
                found.take_numbers(first, name, index, values)
        first += len(group.worlds)
    return found


_FOLLOWED = frozenset(("bvh_aabb", "bvh_child", "bvh_nodeid", *FRAMED))
"""Arrays of a cell that the volumes of bodies, or frames of meshes, follow in the joint model."""


def _in_joint(cell: CellNumbers, name: str, own: Varying) -> tuple[NDArray[np.int64], NDArray[np.generic]]:
    """Return the places in the joint model of numbers that differ between worlds of a cell, and the numbers."""
    places = cell.places(name)
    order = np.empty(flat(cell.model, name).size, np.int64)
    order[places.cell] = places.joint
    whole = np.repeat(flat(cell.model, name)[None], len(own.values), axis=0)
    whole[:, own.index] = own.values
    return order[own.index], cell.values(name, whole)[:, own.index]


def check_worlds(joint: WorldGroup, groups: Sequence[WorldGroup], cells: Sequence[CellNumbers]) -> None:
    """Compare the first and the last world of each cell with the model that was built alone. Raises LoadError."""
    varying = dict(joint.varying())
    first = 0
    for group, cell in zip(groups, cells, strict=True):
        own = dict(group.varying())
        for world in sorted({0, len(group.worlds) - 1}):
            alone = model_of_world(cell.model, own, world)
            made = model_of_world(cell.joint, varying, first + world)
            check_cell(cell.of(alone), made, alone, group.first.name)
        first += len(group.worlds)

"""References of an element of a compiled model, as kinds and ids."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.arrays import Treatment, about
from mjcompose.mujoco.attributes import KINDS, OF_OBJECT_TYPE

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Array = NDArray[np.generic]

DOF = "dof"
"""Not a kind of element: the rows belong to joints."""


@cache
def _arrays_of(model_type: Hashable) -> dict[str, tuple[str, ...]]:
    """Return the attributes of a class of models by their first word: the word of a kind, or ``dof``."""
    words = {kind.arrays: word for word, kind in KINDS.items()} | {DOF: DOF}
    found: dict[str, list[str]] = {}
    for attribute in sorted(dir(model_type)):
        word = words.get(attribute.split("_", 1)[0])
        if word is not None and not attribute.startswith("_"):
            found.setdefault(word, []).append(attribute)
    return {word: tuple(names) for word, names in found.items()}


def arrays(model: MjModel, kind: str) -> Iterator[tuple[str, Array, Treatment]]:
    """Yield the arrays of one kind with one row for each element (or dof), sorted by name, and their comparison.

    The shapes are (n,) or (n, width). An array of data whose length happens to be the number of elements is included.
    """
    is_single = not hasattr(model, "actuator_ctrladr")
    count = len(model.dof_bodyid) if kind == DOF else len(getattr(model, KINDS[kind].addresses))
    for name in _arrays_of(cast("Hashable", type(model))).get(kind, ()):
        array = getattr(model, name)
        if isinstance(array, np.ndarray) and array.ndim and array.shape[0] == count:
            known = about(name)
            yield name, array, known.single if is_single else known.treatment


def row_key(model: MjModel, kind: str, index: int) -> bytes:
    """Return the plain values of one element as bytes, without its place and references."""
    return b"".join(
        array[index].tobytes()
        for _, array, how in arrays(model, kind)
        if how is Treatment.PLAIN or (kind == "body" and how is Treatment.HOST)
    )


def same_width(a: Array, b: Array) -> tuple[Array, Array]:
    """Return two tables, shape (n, width), with the narrower one padded with columns of zeros."""
    width = max(a.shape[1], b.shape[1])
    one, other = (np.pad(each, ((0, 0), (0, width - each.shape[1]))) for each in (a, b))
    return one, other


class World(StrEnum):
    """The meaning of a reference to body 0 of the part in the composition."""

    MOUNT = "mount"
    """The parent of the part's roots."""
    WORLD = "world"
    """An equality, an exclude or a target names the world: the parent of the part's roots, too."""
    KEPT = "kept"
    """A sensor or a tuple names the world: the world of the composition."""
    EITHER = "either"
    """Both: vertices and bones pinned to the part's world."""


class Link(Struct):
    """A reference. ``index`` is -1 for an empty field."""

    field: str
    kind: str
    index: int
    world: World = World.WORLD


def links(model: MjModel, kind: str, index: int) -> list[Link]:
    """Return the references of one element, always the same fields in the same order.

    A material has one reference for each role of a texture, and an actuator has one for each id in `actuator_trnid`
    that its transmission uses. A geom that was fitted to a mesh has no reference to it, although MuJoCo 3 leaves the id
    there.
    """
    return [link for reader in _READERS.get(kind, ()) for link in reader(model, index)]


Reader: TypeAlias = "Callable[[MjModel, int], Iterator[Link]]"


def _row(array: str, kind: str, world: World = World.WORLD) -> Reader:

    def read(model: MjModel, index: int) -> Iterator[Link]:
        values = getattr(model, array, None)
        if values is not None:
            yield Link(array, kind, int(values[index]), world=world)

    return read


def _run(array: str, kind: str, rows: str) -> Reader:
    """Return a reader of the ids in several rows; the parts that are pinned to the world may name either world."""
    world = World.EITHER if kind == "body" else World.WORLD

    def read(model: MjModel, index: int) -> Iterator[Link]:
        start, count = (int(getattr(model, f"{rows}{each}")[index]) for each in ("adr", "num"))
        for place, target in enumerate(getattr(model, array)[start : start + count].tolist()):
            yield Link(f"{array}[{place}]", kind, target, world=world)

    return read


def _parent(model: MjModel, index: int) -> Iterator[Link]:
    # MuJoCo 4.0 puts the bodies in which a rod is twisted into the world, wherever its `<flexcomp>` is.
    return _row("body_parentid", "body", World.EITHER if twists_a_rod(model, index) else World.MOUNT)(model, index)


_HFIELD = 1
_MESH = 7
_SDF = 8


def _shape(model: MjModel, index: int) -> Iterator[Link]:
    # MuJoCo 3 leaves the meaningless mesh id in primitives that were fitted to a mesh.
    shape = int(model.geom_type[index])
    data = int(model.geom_dataid[index]) if shape in (_HFIELD, _MESH, _SDF) else -1
    yield Link("geom_dataid", "hfield" if shape == _HFIELD else "mesh", data)


def _textures(model: MjModel, index: int) -> Iterator[Link]:
    for role, texture in enumerate(model.mat_texid[index].tolist()):
        yield Link(f"mat_texid[{role}]", "texture", texture)


def _twists(model: MjModel, index: int) -> Iterator[Link]:
    rows = bending(model, index)
    if rows is not None:
        for place in twists(rows):
            yield Link(f"flex_bending[{place}]", "joint", int(rows[place]))


BEND = 10
"""The numbers of one bend of a rod, a flex of one dimension, in `flex_bending` since MuJoCo 4.0."""
_NO_VERTEX = 3
_TWIST = 7


def twists(bending: Array) -> list[int]:
    """Return the places in a rod's `flex_bending` that have the id of a joint, which is a bend's second twist."""
    # Their number comes first, then for each bend of three vertices the vertices, -1, a stiffness and two angles, the
    # joint (-1 if the rod is not twisted), and a stiffness and an angle for the twist. Bends of four vertices have no
    # joint: those of `<flexcomp type="circle" count="5 1 1" dim="1" …/>` begin with 3 0 1 2.
    rows = bending.ravel()
    if not len(rows) or len(rows) != 1 + BEND * int(rows[0]):
        return []
    return [at + _TWIST for at in range(1, len(rows), BEND) if rows[at + _NO_VERTEX] == -1]


def bending(model: MjModel, index: int) -> Array | None:
    """Return the bends of a flex if it is a rod, else None."""
    addresses = getattr(model, "flex_bendingadr", None)
    if addresses is None or model.flex_dim[index] != 1 or addresses[index] < 0:
        return None
    later = addresses[addresses > addresses[index]]
    rows: Array = model.flex_bending.ravel()[addresses[index] : int(later.min()) if len(later) else None]
    return rows


def twists_a_rod(model: MjModel, body: int) -> bool:
    """Return whether a rod is twisted in a body."""
    if not model.nflex or model.body_parentid[body] or model.body_jntnum[body] != 1:
        return False
    joint = int(model.body_jntadr[body])
    rods = (rows for flex in range(model.nflex) if (rows := bending(model, flex)) is not None)
    # The twist of the first edge is right before.
    return any(int(rows[at]) in (joint, joint + 1) for rows in rods for at in twists(rows))


def _flex_materials(model: MjModel, index: int) -> Iterator[Link]:
    """Yield the materials of a flex and, since MuJoCo 4, of its elements."""
    several = len(model.flex_matid) == model.nflexelem
    return (_run("flex_matid", "material", "flex_elem") if several else _row("flex_matid", "material"))(model, index)


WRAP_JOINT = 1
"""The value of `wrap_type` for which `wrap_objid` is the id of a joint."""
WRAP_SITE = 3
"""The value of `wrap_type` for which `wrap_objid` is the id of a site."""
WRAPS_A_GEOM = (4, 5)
"""The values of `wrap_type` whose `wrap_prm` is the id of a side site."""


def _path(model: MjModel, index: int) -> Iterator[Link]:
    first = int(model.tendon_adr[index])
    for place in range(int(model.tendon_num[index])):
        at = first + place
        wrapped = int(model.wrap_type[first + place])
        kind = "geom" if wrapped in WRAPS_A_GEOM else {WRAP_JOINT: "joint", WRAP_SITE: "site"}.get(wrapped)
        if kind is not None:
            yield Link(f"wrap_objid[{place}]", kind, int(model.wrap_objid[at]))
        if kind == "geom":
            yield Link(f"wrap_prm[{place}]", "site", int(model.wrap_prm[at]))


_CONSTRAINED = {2: "joint", 3: "tendon", 4: "flex", 5: "flex", 6: "flex", 7: "geom"}


def _equality(model: MjModel, index: int) -> Iterator[Link]:
    by_type = _CONSTRAINED.get(int(model.eq_type[index]))
    kind = by_type or OF_OBJECT_TYPE.get(int(model.eq_objtype[index]), "body")
    for array in ("eq_obj1id", "eq_obj2id"):
        yield from _row(array, kind)(model, index)


def _two(kind: str, *ids: int) -> Iterator[Link]:
    return (Link(f"{kind}{place}", kind, target) for place, target in enumerate(sorted(ids), 1))


def _pair(model: MjModel, index: int) -> Iterator[Link]:
    return _two("geom", int(model.pair_geom1[index]), int(model.pair_geom2[index]))


def _exclude(model: MjModel, index: int) -> Iterator[Link]:
    signature = int(model.exclude_signature[index])
    return _two("body", signature >> 16, signature & 0xFFFF)


ON_JOINTS = (0, 1)
"""Values of `actuator_trntype` for an actuator on a joint, in its own frame or in its parent's."""
ON_TENDON = 3
"""The value of `actuator_trntype` for an actuator on a tendon."""

_TARGETS: dict[int, tuple[str, ...]] = {
    **dict.fromkeys(ON_JOINTS, ("joint",)),
    2: ("site", "site"),
    ON_TENDON: ("tendon",),
    4: ("site", "site"),
    5: ("body",),
}
_ROTATION = 6
"""The value of `actuator_trntype` for a ball joint or, with a second id, for a site relative to another."""


def _transmission(model: MjModel, index: int) -> Iterator[Link]:
    transmission = int(model.actuator_trntype[index])
    targets = _TARGETS.get(transmission, ())
    if transmission == _ROTATION:
        targets = ("site", "site") if model.actuator_trnid[index, 1] >= 0 else ("joint",)
    for place, kind in enumerate(targets):
        yield Link(f"actuator_trnid[{place}]", kind, int(model.actuator_trnid[index, place]))


def _sensor(model: MjModel, index: int) -> Iterator[Link]:
    for array, typed in (("sensor_objid", "sensor_objtype"), ("sensor_refid", "sensor_reftype")):
        kind = OF_OBJECT_TYPE.get(int(getattr(model, typed)[index]))
        if kind is not None:
            yield from _row(array, kind, World.KEPT)(model, index)


def _tuple(model: MjModel, index: int) -> Iterator[Link]:
    first = int(model.tuple_adr[index])
    for place in range(int(model.tuple_size[index])):
        kind = OF_OBJECT_TYPE.get(int(model.tuple_objtype[first + place]))
        if kind is not None:
            yield Link(f"tuple_objid[{place}]", kind, int(model.tuple_objid[first + place]), world=World.KEPT)


_READERS: dict[str, tuple[Reader, ...]] = {
    "body": (_parent, _row("body_plugin", "plugin")),
    "joint": (_row("jnt_bodyid", "body", World.MOUNT), _row("jnt_actuatorid", "actuator")),
    "geom": (
        _row("geom_bodyid", "body", World.MOUNT),
        _shape,
        _row("geom_matid", "material"),
        _row("geom_plugin", "plugin"),
    ),
    "site": (_row("site_bodyid", "body", World.MOUNT), _row("site_dataid", "mesh"), _row("site_matid", "material")),
    "camera": (_row("cam_bodyid", "body", World.MOUNT), _row("cam_targetbodyid", "body")),
    "light": (
        _row("light_bodyid", "body", World.MOUNT),
        _row("light_targetbodyid", "body"),
        _row("light_texid", "texture"),
    ),
    "material": (_textures,),
    "skin": (_row("skin_matid", "material"), _run("skin_bonebodyid", "body", "skin_bone")),
    "flex": (
        _flex_materials,
        _run("flex_vertbodyid", "body", "flex_vert"),
        _run("flex_nodebodyid", "body", "flex_node"),
        _twists,
    ),
    "tendon": (_row("tendon_matid", "material"), _row("tendon_actuatorid", "actuator"), _path),
    "equality": (_equality,),
    "pair": (_pair,),
    "exclude": (_exclude,),
    "tuple": (_tuple,),
    "actuator": (_transmission, _row("actuator_plugin", "plugin")),
    "sensor": (_sensor, _row("sensor_plugin", "plugin")),
}
"""By kind, in the order of `links`."""

UNORDERED = frozenset({"pair", "exclude"})
"""Kinds whose two references are a set, stored by MuJoCo in the order of ids."""

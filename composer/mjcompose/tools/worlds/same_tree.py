"""Whether two models have one kinematic tree: all but geoms and assets is the same, except for its numbers."""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING

import numpy as np

from mjcompose.mujoco.arrays import JOINT_TYPES
from mjcompose.mujoco.attributes import KINDS, NameTable
from mjcompose.mujoco.varying import arrays, flat
from mjcompose.tools.worlds.names import LoadError, failure

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

CODE = "not-a-world"
ASSETS = ("texture", "material", "mesh", "hfield")
_OWN_OF_A_CELL = ("geom", *ASSETS)
APART_OR_UNION = "build these cells separately with `--pick`, or add `--as union`: one model has the parts of all"

_SPARSITY = ("M", "D", "B", "mapM2M", "mapM2D", "mapD2M")
OF_THE_JOINT_MODEL = ("mesh", "hfield", "tex", "mat", "names", "name", "paths", "bvh", "oct", *_SPARSITY)
"""The first words of arrays that a joint model has once, for all cells."""
SIMPLE = "body_simple"
ADDRESSES = frozenset(
    ("body_geomadr", "body_geomnum", "body_bvhadr", "body_bvhnum", SIMPLE, "dof_simplenum", "dof_Madr")
)
"""Arrays that follow from the geoms, the volumes and the sparsity of the joint model.

The sparsity depends on inertias: MuJoCo 4.0 has only the diagonal of a simple body, which is one whose inertial frame
is its own. In a joint model, a body is as simple as in the cell in which it is least simple.
"""
GEOM_REFERENCES = ("sensor_objid", "sensor_refid", "wrap_objid", "pair_geom1", "pair_geom2")
ASSET_REFERENCES = {
    "mat_texid": "texture",
    "site_matid": "material",
    "tendon_matid": "material",
    "light_texid": "texture",
}
_SWITCHES = frozenset(
    f"{kind}_{switch}"
    for kind, switches in {
        "body": "sameframe contype conaffinity",
        "site": "sameframe group type",
        "jnt": "limited actfrclimited actgravcomp group",
        "tendon": "limited actfrclimited group",
        "actuator": "ctrllimited forcelimited actlimited group",
        "eq": "active0",
        "cam": "resolution",
        "light": "active castshadow",
    }.items()
    for switch in switches.split()
)
"""Arrays of integers that are properties, like numbers. All other integers are the structure of a model."""


def check_same_tree(first: MjModel, other: MjModel, called: tuple[str, str]) -> None:
    """Raise LoadError with the first difference, the most telling one, if two models have different trees."""
    message = f"`{called[1]}` cannot be a world of `{called[0]}`"
    reason = _different_names(first, other)
    if reason is None:
        _check_joint_types(first, other, message)
        reason = _different_parent(first, other) or _different_structure(first, other)
    if reason is not None:
        raise failure(CODE, f"{message}: it has another tree", APART_OR_UNION, notes=[reason])


def is_same_tree(first: MjModel, other: MjModel) -> bool:
    try:
        check_same_tree(first, other, ("", ""))
    except LoadError:
        return False
    return True


def _different_names(first: MjModel, other: MjModel) -> str | None:
    tables = NameTable(first), NameTable(other)
    for kind in KINDS:
        ours, theirs = (table.names[kind] for table in tables)
        if kind in _OWN_OF_A_CELL or ours == theirs:
            continue
        more = [name for name in theirs if name not in ours]
        fewer = [name for name in ours if name not in theirs]
        if more or fewer:
            verb, name = ("has", more[0]) if more else ("lacks", fewer[0])
            return f"it {verb} the {kind} `{name}`"
        if len(ours) != len(theirs):
            return f"it has {len(theirs)} elements of the kind {kind}, not {len(ours)}"
        return f"its elements of the kind {kind} are in another order"
    return None


def _check_joint_types(first: MjModel, other: MjModel, message: str) -> None:
    for number in np.flatnonzero(first.jnt_type != other.jnt_type):
        now, before = (JOINT_TYPES[int(model.jnt_type[number])].word for model in (other, first))
        name = NameTable(first).describe("joint", int(number))
        help = "use one type of joint in all cells, or add `--as union`"
        raise failure(CODE, f"{message}: the joint `{name}` is a {now}, not a {before}", help)


def _different_parent(first: MjModel, other: MjModel) -> str | None:
    table = NameTable(first)
    for number in np.flatnonzero(first.body_parentid != other.body_parentid):
        now, before = (table.describe("body", int(model.body_parentid[number])) for model in (other, first))
        return f"the body `{table.describe('body', int(number))}` is on `{now}`, not on `{before}`"
    return None


def _different_structure(first: MjModel, other: MjModel) -> str | None:
    for name in arrays(first):
        if is_of_geoms_or_assets(name) or "." in name:
            continue
        before = flat(first, name)
        now = flat(other, name)
        if before.size != now.size:
            return f"the array `{name}` has {now.size} numbers, not {before.size}"
        is_structure = before.dtype.kind in "iub" and name not in _SWITCHES | {*GEOM_REFERENCES, *ASSET_REFERENCES}
        if is_structure and (before != now).any():
            return f"`{name}` differs"
    return None


_NOT_STRUCTURE = ("name", "names", "paths", "bvh", "oct", "mat", "key")
_IDS_OF_ASSETS = frozenset(("geom_dataid", "geom_matid", "geom_sameframe", *ASSET_REFERENCES))


def structure_of(model: MjModel) -> str:
    """Return a hash of everything that worlds of one model have in common: names, sizes, assets, structure."""
    whole = blake2b(digest_size=16)
    table = NameTable(model)
    for kind in KINDS:
        whole.update("\0".join((kind, *table.names[kind], "\n")).encode())
    for name in arrays(model):
        array = flat(model, name)
        word = name.partition("_")[0]
        whole.update(f"{name} {array.size}".encode() if word not in ("names", "paths") else b"")
        is_asset = word in ("mesh", "hfield", "tex") and not name.endswith("pathadr")
        is_integer = array.dtype.kind in "iub" and word not in _NOT_STRUCTURE and "." not in name
        if is_asset or (is_integer and name not in _SWITCHES | _IDS_OF_ASSETS | ADDRESSES and "pathadr" not in name):
            whole.update(np.ascontiguousarray(array).data)
    return whole.hexdigest()


def is_of_geoms_or_assets(name: str) -> bool:
    """Return whether an array is about geoms, or is one of the joint model alone."""
    return name.partition("_")[0] in ("geom", *OF_THE_JOINT_MODEL) or name in ADDRESSES

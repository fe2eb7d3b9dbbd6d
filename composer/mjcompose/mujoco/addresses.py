"""The addresses of an element's numbers in arrays without one row for each element, and the data that it points to.

`RUNS` has them by kind and by the size that the array has rows for: `RUNS["joint"]["nv"]` serves every `dof_` array
and `qvel`. `rows_of` takes the name of an array, and `span` takes the name of a vector.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.arrays import ARRAYS, FREE, JOINT_TYPES, about
from mjcompose.mujoco.attributes import KIND_OF
from mjcompose.mujoco.references import WRAPS_A_GEOM, Array, twists

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_CORNERS = {1: 2, 2: 3, 3: 4}
"""The number of corners of an element of a flex, by its dimension."""
_EDGES = {1: 1, 2: 3, 3: 6}
"""The number of edges of an element of a flex, by its dimension."""

Shape = tuple[int, ...]


class RowRange(Struct):
    """Consecutive rows of an array for each element: its first row, and their number.

    `first` is an array of `mjModel` with the first rows, negative if the element has none. With `as_row`, a single
    row is the element's own, as if the array had one for each element. `shape` is the shape of the rows of one
    element, if it contains more than their number.
    """

    first: str
    number: Callable[[MjModel, int], int]
    as_row: bool = False
    required: str | None = None
    shape: Callable[[MjModel, int], Shape] | None = None

    def rows(self, model: MjModel, index: int) -> range:
        """Return the rows of one element, or an empty range."""
        firsts = getattr(model, self.first, None)
        if firsts is None:  # MuJoCo 3 does not count controls and outputs: an actuator has one of each
            return range(index, index + 1)
        first = int(firsts[index])
        return range(first, first + self.number(model, index)) if first >= 0 else range(0)


def counted(array: str) -> Callable[[MjModel, int], int]:
    """Return a function for the number of rows that an array of counts gives to each element."""
    return lambda model, index: int(getattr(model, array)[index])


def _grid(*arrays: str) -> Callable[[MjModel, int], Shape]:
    return lambda model, index: tuple(int(getattr(model, array)[index]) for array in arrays)


def _cells(*arrays: str) -> Callable[[MjModel, int], int]:
    return lambda model, index: math.prod(_grid(*arrays)(model, index))


def _up_to_the_next(own: str, size: str, *addresses: str) -> Callable[[MjModel, int], int]:
    """Return a function for the size of packed data without a count: up to the next address, or the end."""

    def number(model: MjModel, index: int) -> int:
        first = int(getattr(model, own)[index])
        starts = [int(each) for array in addresses for each in getattr(model, array)]
        return min([each for each in starts if each > first], default=int(getattr(model, size))) - first

    return number


def _plastic(own: str) -> RowRange:
    return RowRange(own, _up_to_the_next(own, "nplastic", "jnt_plasticadr", "tendon_plasticadr", "flex_plasticadr"))


def _of_elements(numbers: Mapping[int, int]) -> Callable[[MjModel, int], int]:
    return lambda model, index: int(model.flex_elemnum[index]) * numbers[int(model.flex_dim[index])]


def _each(kind: str, names: str) -> dict[str, RowRange]:
    """Return runs by size whose first rows and counts have these names: `mesh_vertadr` and `mesh_vertnum`."""
    return {f"n{kind}{each}": RowRange(f"{kind}_{each}adr", counted(f"{kind}_{each}num")) for each in names.split()}


_HFIELD = ("hfield_nrow", "hfield_ncol")
_TEXTURE = ("tex_height", "tex_width", "tex_nchannel")

RUNS: Mapping[str, Mapping[str, RowRange]] = {
    "body": {"nmocap": RowRange("body_mocapid", lambda model, index: 1, as_row=True, required="a mocap body")},
    "joint": {
        "nq": RowRange("jnt_qposadr", lambda model, index: JOINT_TYPES[int(model.jnt_type[index])].positions),
        "nv": RowRange("jnt_dofadr", lambda model, index: JOINT_TYPES[int(model.jnt_type[index])].velocities),
        "nplastic": _plastic("jnt_plasticadr"),
    },
    "actuator": {
        "nu": RowRange("actuator_ctrladr", counted("actuator_ctrlnum"), as_row=True),
        "nout": RowRange("actuator_outadr", counted("actuator_outnum"), as_row=True),
        "na": RowRange("actuator_actadr", counted("actuator_actnum"), as_row=True),
    },
    "sensor": {"nsensordata": RowRange("sensor_adr", counted("sensor_dim"))},
    "tendon": {
        "nwrap": RowRange("tendon_adr", counted("tendon_num")),
        "nJten": RowRange("ten_J_rowadr", counted("ten_J_rownnz")),
        "nplastic": _plastic("tendon_plasticadr"),
    },
    "mesh": {
        **_each("mesh", "vert normal texcoord face poly"),
        "nmeshgraph": RowRange("mesh_graphadr", _up_to_the_next("mesh_graphadr", "nmeshgraph", "mesh_graphadr")),
    },
    "hfield": {"nhfielddata": RowRange("hfield_adr", _cells(*_HFIELD), shape=_grid(*_HFIELD))},
    "texture": {"ntexdata": RowRange("tex_adr", _cells(*_TEXTURE), shape=_grid(*_TEXTURE))},
    "skin": {
        **_each("skin", "vert"),
        "nskintexvert": RowRange("skin_texcoordadr", counted("skin_vertnum")),
        **_each("skin", "face bone"),
    },
    "flex": {
        **_each("flex", "vert node edge elem"),
        "nflexelemdata": RowRange("flex_elemdataadr", _of_elements(_CORNERS)),
        "nflexelemedge": RowRange("flex_elemedgeadr", _of_elements(_EDGES)),
        "nplastic": _plastic("flex_plasticadr"),
        "nflexshelldata": RowRange("flex_shelldataadr", _cells("flex_shellnum", "flex_dim")),
    },
    "numeric": {"nnumericdata": RowRange("numeric_adr", counted("numeric_size"))},
    "tuple": {"ntupledata": RowRange("tuple_adr", counted("tuple_size"))},
    "plugin": {"npluginstate": RowRange("plugin_stateadr", counted("plugin_statenum"))},
}
"""By kind, and by the size that an array has rows for."""

VECTORS: Mapping[str, tuple[str, str]] = {
    "qpos": ("joint", "nq"), "qvel": ("joint", "nv"), "ctrl": ("actuator", "nu"), "act": ("actuator", "na"),
    "sensordata": ("sensor", "nsensordata"), "mocap_pos": ("body", "nmocap"),
}  # fmt: skip
"""The vectors of `mjData` that users address: the kind of their elements, and their length in `mjModel`."""


def span(model: MjModel, vector: str, index: int) -> range:
    """Return the addresses of an element in a vector of its kind; empty if it has none."""
    kind, size = VECTORS[vector]
    return RUNS[kind][size].rows(model, index)


def rows_of(model: MjModel, kind: str, array: str, index: int) -> range:
    """Return the rows of an element in an array of `mjModel` named after its kind or state.

    Most arrays have one row for each element. Joints have several rows in `qpos0`, `qpos_spring` and the `dof_`
    arrays; since MuJoCo 4 actuators may have several in the arrays about controls (`actuator_ctrlrange`) and outputs
    (`actuator_gear`).
    """
    run = RUNS.get(kind, {}).get("nv" if array.startswith("dof_") else about(array).rows)
    return range(index, index + 1) if run is None else run.rows(model, index)


def numbers_of(model: MjModel, kind: str, array: str, index: int) -> Array:
    """Return the rows of an element in an array of `mjModel`: in `mesh_vert`, the vertices of one mesh."""
    rows = rows_of(model, kind, array, index)
    numbers: Array = getattr(model, array)
    return numbers[rows.start : rows.stop]


_TO_THE_NEXT: Mapping[str, RowRange] = {
    own: RowRange(own, _up_to_the_next(own, size, own))
    for own, size in (
        ("flex_stiffnessadr", "nflexstiffness"),
        ("flex_bendingadr", "nflexbending"),
        ("flex_texcoordadr", "nflextexcoord"),
        ("plugin_attradr", "npluginattr"),
    )
}
"""By the array of addresses: data without a count, which an element lacks if its address is negative."""

_COUNTED: Mapping[str, RowRange] = {
    "noct": RowRange("mesh_octadr", counted("mesh_octnum")),
    "flex_evpairadr": RowRange("flex_evpairadr", counted("flex_evpairnum")),
    "text_adr": RowRange("text_adr", counted("text_size")),
}
_KINDS = {**KIND_OF, "flexedge": "flex", "oct": "mesh"}


@cache
def data_of(kind: str) -> tuple[tuple[str, RowRange, str], ...]:
    """Return the arrays of data of a kind with their runs, and the prefix of the addresses in these arrays."""
    found = []
    for name in ARRAYS:
        rows, _, nested = about(name).rows.partition(" ")
        if rows and _KINDS.get(name.split("_", 1)[0]) == kind:
            found.append((name, {**RUNS.get(kind, {}), **_TO_THE_NEXT, **_COUNTED}[rows], nested))
    return tuple(found)


def runs(model: MjModel, kind: str, index: int) -> Iterator[tuple[str, Array]]:
    """Yield the data of one element by array, (n,) or (n, width), in a fixed order; `links` has its references."""
    if kind == "joint" and int(model.jnt_type[index]) == FREE:
        return  # its numbers are the pose of its body
    for name, run, nested in data_of(kind):
        if not hasattr(model, run.first) or not hasattr(model, name):
            continue  # in MuJoCo 3 an actuator has one row in the arrays about controls and outputs
        rows = run.rows(model, index)
        if not rows and (nested or run.first == "mesh_graphadr" or run.first in _TO_THE_NEXT):
            continue
        if nested:  # the rows have addresses and counts in turn
            start = int(getattr(model, f"{nested}adr")[rows.start])
            rows = range(start, start + int(getattr(model, f"{nested}num")[rows.start : rows.stop].sum()))
        array = getattr(model, name)
        numbers = np.frombuffer(array, np.uint8) if isinstance(array, bytes) else array
        yield name, _without_references(model, index, name, numbers=numbers[rows.start : rows.stop])


def _without_references(model: MjModel, index: int, name: str, numbers: Array) -> Array:
    """Return the data with 0 instead of each id, because `links` has the ids."""
    ids: Any = ()
    if name == "wrap_prm":
        first = int(model.tendon_adr[index])
        ids = np.isin(model.wrap_type[first : first + len(numbers)], WRAPS_A_GEOM)
    elif name == "flex_bending" and model.flex_dim[index] == 1:
        ids = twists(numbers)
    if not len(ids):
        return numbers
    numbers = numbers.ravel().copy()
    numbers[ids] = 0
    return numbers

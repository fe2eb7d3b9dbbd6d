"""The data that an element points to: vertices, pixels, paths, positions; without the addresses."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from composer.compiled.addresses import RUNS, counted, span
from composer.compiled.addresses import Run as Rows
from composer.compiled.joints import FREE
from composer.compiled.kinds import Model
from composer.compiled.links import WRAPS_A_GEOM, twists
from composer.compiled.rows import Array

Run = tuple[str, Array]

_OCTREE = Rows("mesh_octadr", counted("mesh_octnum"))
_VERTEX_PAIRS = Rows("flex_evpairadr", counted("flex_evpairnum"))


def runs(model: Model, kind: str, index: int) -> Iterator[Run]:
    """Yield the data of one element, array by array, in a fixed order; shape (n,) or (n, width) as in `mjModel`.

    Arrays that this MuJoCo does not have are left out. ``links`` has the references.
    """
    reader = _READERS.get(kind)
    if reader:
        yield from reader(model, index)


def _slices(model: Model, rows: range, *arrays: str) -> Iterator[Run]:
    for name in arrays:
        array = getattr(model, name, None)
        if array is not None:
            yield name, array[rows.start : rows.stop]


def _joint(model: Model, index: int) -> Iterator[Run]:
    if int(model.jnt_type[index]) != FREE:
        yield from _slices(model, span(model, "qpos", index), "qpos0", "qpos_spring")


def _mesh(model: Model, index: int) -> Iterator[Run]:
    own = {size: run.rows(model, index) for size, run in RUNS["mesh"].items() if hasattr(model, run.first)}
    yield from _slices(model, own["nmeshvert"], "mesh_vert", "mesh_polymapnum")
    yield from _slices(model, own["nmeshnormal"], "mesh_normal")
    yield from _slices(model, own["nmeshtexcoord"], "mesh_texcoord")
    yield from _slices(model, own["nmeshface"], "mesh_face", "mesh_facenormal", "mesh_facetexcoord")
    graph = int(model.mesh_graphadr[index])
    if graph >= 0:
        vertices, faces = model.mesh_graph[graph : graph + 2].tolist()
        yield "mesh_graph", model.mesh_graph[graph : graph + 2 + 3 * vertices + 6 * faces]
    if (polygons := own.get("nmeshpoly")) is not None:
        yield from _slices(model, polygons, "mesh_polynormal", "mesh_polyvertnum")
        yield from _nested(model, polygons, "mesh_polyvertadr", "mesh_polyvertnum", "mesh_polyvert")
        yield from _nested(model, own["nmeshvert"], "mesh_polymapadr", "mesh_polymapnum", "mesh_polymap")
    if hasattr(model, "mesh_octadr"):
        yield from _slices(model, _OCTREE.rows(model, index), "oct_depth", "oct_aabb", "oct_coeff")


def _nested(model: Model, rows: range, first: str, number: str, *arrays: str) -> Iterator[Run]:
    """Yield the data that consecutive rows of an element point to in turn."""
    if rows:
        start = int(getattr(model, first)[rows.start])
        count = int(getattr(model, number)[rows.start : rows.stop].sum())
        yield from _slices(model, range(start, start + count), *arrays)


def _hfield(model: Model, index: int) -> Iterator[Run]:
    yield from _slices(model, RUNS["hfield"]["nhfielddata"].rows(model, index), "hfield_data")


def _texture(model: Model, index: int) -> Iterator[Run]:
    yield from _slices(model, RUNS["texture"]["ntexdata"].rows(model, index), "tex_data")


def _skin(model: Model, index: int) -> Iterator[Run]:
    own = {size: run.rows(model, index) for size, run in RUNS["skin"].items()}
    yield from _slices(model, own["nskinvert"], "skin_vert")
    yield from _slices(model, own["nskintexvert"], "skin_texcoord")
    yield from _slices(model, own["nskinface"], "skin_face")
    bones = own["nskinbone"]
    yield from _slices(model, bones, "skin_bonebindpos", "skin_bonebindquat", "skin_bonevertnum")
    yield from _nested(
        model, bones, "skin_bonevertadr", "skin_bonevertnum", "skin_bonevertid", "skin_bonevertweight"
    )


_FLEX_ARRAYS = (
    ("nflexvert", ("flex_vert", "flex_vert0", "flex_vertcell", "flex_vertmetric")),
    ("nflexnode", ("flex_node", "flex_node0")),
    ("nflexedge", ("flex_edge", "flex_edgeflap", "flexedge_length0", "flexedge_rigid")),
    ("nflexelem", ("flex_elemlayer",)),
    ("nflexelemdata", ("flex_elem", "flex_elemtexcoord")),
    ("nflexelemedge", ("flex_elemedge",)),
    ("nflexshelldata", ("flex_shell",)),
)
_FLEX_RUNS_TO_THE_NEXT = (
    ("flex_stiffnessadr", "flex_stiffness"),
    ("flex_bendingadr", "flex_bending"),
    ("flex_texcoordadr", "flex_texcoord"),
)
FROM_THE_WORLD = frozenset("flex_vertmetric flex_node flexedge_length0 flex_stiffness flex_bending".split())
"""Flex data that MuJoCo computes from world positions, so that a moved part has it up to rounding."""

IN_THE_WORLD = frozenset({"flex_node0", "flex_vert0"})
"""Flex data that is a position in the world, or in the flex's box along the axes of the world."""


def _flex(model: Model, index: int) -> Iterator[Run]:
    for size, arrays in _FLEX_ARRAYS:
        if hasattr(model, RUNS["flex"][size].first):
            yield from _slices(model, RUNS["flex"][size].rows(model, index), *arrays)
    if hasattr(model, "flex_evpairadr"):  # until MuJoCo 4
        yield from _slices(model, _VERTEX_PAIRS.rows(model, index), "flex_evpair")
    for address, name in _FLEX_RUNS_TO_THE_NEXT:
        addresses, array = getattr(model, address, None), getattr(model, name, None)
        if addresses is not None and array is not None and addresses[index] >= 0:
            later = addresses[addresses > addresses[index]]
            rows = array[addresses[index] : int(later.min()) if len(later) else len(array)]
            if name == "flex_bending" and model.flex_dim[index] == 1 and (ids := twists(rows)):
                rows = rows.ravel().copy()
                rows[ids] = 0  # references, which `links` has
            yield name, rows


def _tendon(model: Model, index: int) -> Iterator[Run]:
    path = RUNS["tendon"]["nwrap"].rows(model, index)
    kinds = model.wrap_type[path.start : path.stop]
    yield "wrap_type", kinds
    yield "wrap_prm", np.where(np.isin(kinds, WRAPS_A_GEOM), 0.0, model.wrap_prm[path.start : path.stop])


def _actuator(model: Model, index: int) -> Iterator[Run]:
    if not hasattr(model, "actuator_ctrladr"):
        return  # MuJoCo 3: these arrays have one row for each actuator
    own = RUNS["actuator"]
    yield from _slices(model, own["nu"].rows(model, index), "actuator_ctrllimited", "actuator_ctrlrange")
    outputs = own["nout"].rows(model, index)
    yield from _slices(
        model, outputs, "actuator_gear", "actuator_length0", "actuator_lengthrange", "actuator_acc0"
    )


def _numeric(model: Model, index: int) -> Iterator[Run]:
    yield from _slices(model, RUNS["numeric"]["nnumericdata"].rows(model, index), "numeric_data")


def _text(model: Model, index: int) -> Iterator[Run]:
    data = bytes(model.text_data)
    first = int(model.text_adr[index])
    yield "text_data", np.frombuffer(data[first : first + int(model.text_size[index])], dtype=np.uint8)


def _tuple(model: Model, index: int) -> Iterator[Run]:
    yield from _slices(model, RUNS["tuple"]["ntupledata"].rows(model, index), "tuple_objtype", "tuple_objprm")


def _plugin(model: Model, index: int) -> Iterator[Run]:
    first = int(model.plugin_attradr[index])
    later = model.plugin_attradr[model.plugin_attradr > first]
    end = int(later.min()) if len(later) else len(model.plugin_attr)
    yield "plugin_attr", model.plugin_attr[first:end]


_READERS: dict[str, Callable[[Model, int], Iterator[Run]]] = {
    "joint": _joint,
    "mesh": _mesh,
    "hfield": _hfield,
    "texture": _texture,
    "skin": _skin,
    "flex": _flex,
    "tendon": _tendon,
    "actuator": _actuator,
    "numeric": _numeric,
    "text": _text,
    "tuple": _tuple,
    "plugin": _plugin,
}

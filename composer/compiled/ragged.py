"""The data an element points to: vertices, pixels, paths, positions; without the addresses."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from composer.compiled.kinds import FREE_JOINT, JOINT_POSITIONS, Model
from composer.compiled.links import WRAPS_A_GEOM
from composer.compiled.rows import Array

Run = tuple[str, Array]


def runs(model: Model, kind: str, index: int) -> Iterator[Run]:
    """The data of one element, array by array, always in the same order. References are left to ``links``."""
    reader = _READERS.get(kind)
    if reader:
        yield from reader(model, index)


def _slices(model: Model, first: int, number: int, *arrays: str) -> Iterator[Run]:
    for name in arrays:
        array = getattr(model, name, None)
        if array is not None:
            yield name, array[first : first + number] if first >= 0 else array[:0]


def _joint(model: Model, index: int) -> Iterator[Run]:
    kind = int(model.jnt_type[index])
    if kind != FREE_JOINT:
        yield from _slices(
            model, int(model.jnt_qposadr[index]), JOINT_POSITIONS[kind], "qpos0", "qpos_spring"
        )


def _mesh(model: Model, index: int) -> Iterator[Run]:
    def counted(first: str, number: str, *arrays: str) -> Iterator[Run]:
        yield from _slices(
            model, int(getattr(model, first)[index]), int(getattr(model, number)[index]), *arrays
        )

    yield from counted("mesh_vertadr", "mesh_vertnum", "mesh_vert", "mesh_polymapnum")
    yield from counted("mesh_normaladr", "mesh_normalnum", "mesh_normal")
    yield from counted("mesh_texcoordadr", "mesh_texcoordnum", "mesh_texcoord")
    yield from counted("mesh_faceadr", "mesh_facenum", "mesh_face", "mesh_facenormal", "mesh_facetexcoord")
    graph = int(model.mesh_graphadr[index])
    if graph >= 0:
        vertices, faces = model.mesh_graph[graph : graph + 2].tolist()
        yield "mesh_graph", model.mesh_graph[graph : graph + 2 + 3 * vertices + 6 * faces]
    if hasattr(model, "mesh_polyadr"):
        polygon, polygons = int(model.mesh_polyadr[index]), int(model.mesh_polynum[index])
        yield from _slices(model, polygon, polygons, "mesh_polynormal", "mesh_polyvertnum")
        if polygons:
            corners = int(model.mesh_polyvertnum[polygon : polygon + polygons].sum())
            yield from _slices(model, int(model.mesh_polyvertadr[polygon]), corners, "mesh_polyvert")
        vertex, vertices = int(model.mesh_vertadr[index]), int(model.mesh_vertnum[index])
        if vertices:
            uses = int(model.mesh_polymapnum[vertex : vertex + vertices].sum())
            yield from _slices(model, int(model.mesh_polymapadr[vertex]), uses, "mesh_polymap")
    if hasattr(model, "mesh_octadr"):
        yield from counted("mesh_octadr", "mesh_octnum", "oct_depth", "oct_aabb", "oct_coeff")


def _hfield(model: Model, index: int) -> Iterator[Run]:
    cells = int(model.hfield_nrow[index]) * int(model.hfield_ncol[index])
    yield from _slices(model, int(model.hfield_adr[index]), cells, "hfield_data")


def _texture(model: Model, index: int) -> Iterator[Run]:
    pixels = int(model.tex_width[index]) * int(model.tex_height[index]) * int(model.tex_nchannel[index])
    yield from _slices(model, int(model.tex_adr[index]), pixels, "tex_data")


def _skin(model: Model, index: int) -> Iterator[Run]:
    vertices = int(model.skin_vertnum[index])
    yield from _slices(model, int(model.skin_vertadr[index]), vertices, "skin_vert")
    yield from _slices(model, int(model.skin_texcoordadr[index]), vertices, "skin_texcoord")
    yield from _slices(model, int(model.skin_faceadr[index]), int(model.skin_facenum[index]), "skin_face")
    bone, bones = int(model.skin_boneadr[index]), int(model.skin_bonenum[index])
    yield from _slices(model, bone, bones, "skin_bonebindpos", "skin_bonebindquat", "skin_bonevertnum")
    if bones:
        first = int(model.skin_bonevertadr[bone])
        weights = int(model.skin_bonevertnum[bone : bone + bones].sum())
        yield from _slices(model, first, weights, "skin_bonevertid", "skin_bonevertweight")


_FLEX_RUNS = (
    ("flex_vertadr", "flex_vertnum", ("flex_vert", "flex_vert0", "flex_vertcell", "flex_vertmetric")),
    ("flex_nodeadr", "flex_nodenum", ("flex_node", "flex_node0")),
    ("flex_edgeadr", "flex_edgenum", ("flex_edge", "flex_edgeflap", "flexedge_length0", "flexedge_rigid")),
    ("flex_elemadr", "flex_elemnum", ("flex_elemlayer",)),
    ("flex_evpairadr", "flex_evpairnum", ("flex_evpair",)),
)
_EDGES_OF_AN_ELEMENT = {1: 1, 2: 3, 3: 6}
_FLEX_RUNS_TO_THE_NEXT = (
    ("flex_stiffnessadr", "flex_stiffness"),
    ("flex_bendingadr", "flex_bending"),
    ("flex_texcoordadr", "flex_texcoord"),
)
FROM_THE_WORLD = frozenset("flex_vertmetric flex_node flexedge_length0 flex_stiffness flex_bending".split())
"""Flex data that MuJoCo computes from positions in the world, so that a moved part has it up to rounding."""

IN_THE_WORLD = frozenset({"flex_node0", "flex_vert0"})
"""Flex data that is a position in the world, or in the flex's box along the axes of the world."""


def _flex(model: Model, index: int) -> Iterator[Run]:
    for first, number, arrays in _FLEX_RUNS:
        if hasattr(model, first):
            at, rows = int(getattr(model, first)[index]), int(getattr(model, number)[index])
            yield from _slices(model, at, rows, *arrays)
    dimension, elements = int(model.flex_dim[index]), int(model.flex_elemnum[index])
    corners = elements * (dimension + 1)
    yield from _slices(model, int(model.flex_elemdataadr[index]), corners, "flex_elem", "flex_elemtexcoord")
    edges = elements * _EDGES_OF_AN_ELEMENT[dimension]
    yield from _slices(model, int(model.flex_elemedgeadr[index]), edges, "flex_elemedge")
    shells = int(model.flex_shellnum[index]) * dimension
    yield from _slices(model, int(model.flex_shelldataadr[index]), shells, "flex_shell")
    for address, name in _FLEX_RUNS_TO_THE_NEXT:
        addresses, array = getattr(model, address, None), getattr(model, name, None)
        if addresses is not None and array is not None and addresses[index] >= 0:
            later = addresses[addresses > addresses[index]]
            yield name, array[addresses[index] : int(later.min()) if len(later) else len(array)]


def _tendon(model: Model, index: int) -> Iterator[Run]:
    first, number = int(model.tendon_adr[index]), int(model.tendon_num[index])
    kinds = model.wrap_type[first : first + number]
    yield "wrap_type", kinds
    yield "wrap_prm", np.where(np.isin(kinds, WRAPS_A_GEOM), 0.0, model.wrap_prm[first : first + number])


def _actuator(model: Model, index: int) -> Iterator[Run]:
    if not hasattr(model, "actuator_ctrladr"):
        return
    controls, outputs = int(model.actuator_ctrlnum[index]), int(model.actuator_outnum[index])
    yield from _slices(
        model, int(model.actuator_ctrladr[index]), controls, "actuator_ctrllimited", "actuator_ctrlrange"
    )
    yield from _slices(
        model,
        int(model.actuator_outadr[index]),
        outputs,
        "actuator_gear",
        "actuator_length0",
        "actuator_lengthrange",
        "actuator_acc0",
    )


def _numeric(model: Model, index: int) -> Iterator[Run]:
    yield from _slices(model, int(model.numeric_adr[index]), int(model.numeric_size[index]), "numeric_data")


def _text(model: Model, index: int) -> Iterator[Run]:
    data = bytes(model.text_data)
    first = int(model.text_adr[index])
    yield "text_data", np.frombuffer(data[first : first + int(model.text_size[index])], dtype=np.uint8)


def _tuple(model: Model, index: int) -> Iterator[Run]:
    first, number = int(model.tuple_adr[index]), int(model.tuple_size[index])
    yield from _slices(model, first, number, "tuple_objtype", "tuple_objprm")


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

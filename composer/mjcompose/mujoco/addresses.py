"""The addresses of an element's numbers, and the data that it points to.

Addresses of an element's numbers in arrays that do not have one row for each element of its kind.

`RUNS` has them by kind and by the size that the array has rows for: `RUNS["joint"]["nv"]` serves every `dof_` array
and `qvel`. `rows_of` takes the name of an array, `span` the name of a vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from mjcompose.base.dataclass import dataclass
from mjcompose.mujoco.arrays import FREE, JOINT_TYPES
from mjcompose.mujoco.attributes import Model
from mjcompose.mujoco.references import WRAPS_A_GEOM, Array, twists

POSITIONS = tuple(each.positions for each in JOINT_TYPES)
VELOCITIES = tuple(each.velocities for each in JOINT_TYPES)
_EDGES_OF_AN_ELEMENT = {1: 1, 2: 3, 3: 6}

Shape = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Run:
    """Consecutive rows of an array for each element: its first row, and how many.

    `first` is an array of `mjModel` with the first rows, negative if the element has none. With `as_row`, a single
    row is the element's own, as if the array had one for each element. `shape` is that of the rows of one element,
    if it says more than their number.
    """

    first: str
    number: Callable[[Model, int], int]
    as_row: bool = False
    required: str | None = None
    shape: Callable[[Model, int], Shape] | None = None

    def rows(self, model: Model, index: int) -> range:
        """Return the rows of one element, or an empty range."""
        firsts = getattr(model, self.first, None)
        if firsts is None:  # MuJoCo 3 does not count controls and outputs: an actuator has one of each
            return range(index, index + 1)
        first = int(firsts[index])
        return range(first, first + self.number(model, index)) if first >= 0 else range(0)


def counted(array: str) -> Callable[[Model, int], int]:
    """Return a function for the number of rows that an array of counts gives to each element."""
    return lambda model, index: int(getattr(model, array)[index])


def _of_joint(numbers: tuple[int, ...]) -> Callable[[Model, int], int]:
    return lambda model, index: numbers[int(model.jnt_type[index])]


def _grid(*arrays: str) -> Callable[[Model, int], Shape]:
    return lambda model, index: tuple(int(getattr(model, array)[index]) for array in arrays)


def _cells(*arrays: str) -> Callable[[Model, int], int]:
    def number(model: Model, index: int) -> int:
        cells = 1
        for array in arrays:
            cells *= int(getattr(model, array)[index])
        return cells

    return number


def _up_to_the_next(own: str, size: str, *addresses: str) -> Callable[[Model, int], int]:
    """Return a function for the size of packed data without a count: up to the next address, or the end."""

    def number(model: Model, index: int) -> int:
        first = int(getattr(model, own)[index])
        starts = [int(each) for array in addresses for each in getattr(model, array)]
        return min([each for each in starts if each > first], default=int(getattr(model, size))) - first

    return number


def _plastic(own: str) -> Run:
    return Run(
        own,
        _up_to_the_next(own, "nplastic", "jnt_plasticadr", "tendon_plasticadr", "flex_plasticadr"),
    )


def _corners(model: Model, index: int) -> int:
    return int(model.flex_elemnum[index]) * (int(model.flex_dim[index]) + 1)


def _edges(model: Model, index: int) -> int:
    return int(model.flex_elemnum[index]) * _EDGES_OF_AN_ELEMENT[int(model.flex_dim[index])]


_HFIELD = ("hfield_nrow", "hfield_ncol")
_TEXTURE = ("tex_height", "tex_width", "tex_nchannel")

RUNS: Mapping[str, Mapping[str, Run]] = {
    "body": {"nmocap": Run("body_mocapid", lambda model, index: 1, as_row=True, required="a mocap body")},
    "joint": {
        "nq": Run("jnt_qposadr", _of_joint(POSITIONS)),
        "nv": Run("jnt_dofadr", _of_joint(VELOCITIES)),
        "nplastic": _plastic("jnt_plasticadr"),
    },
    "actuator": {
        "nu": Run("actuator_ctrladr", counted("actuator_ctrlnum"), as_row=True),
        "nout": Run("actuator_outadr", counted("actuator_outnum"), as_row=True),
        "na": Run("actuator_actadr", counted("actuator_actnum"), as_row=True),
    },
    "sensor": {"nsensordata": Run("sensor_adr", counted("sensor_dim"))},
    "tendon": {
        "nwrap": Run("tendon_adr", counted("tendon_num")),
        "nJten": Run("ten_J_rowadr", counted("ten_J_rownnz")),
        "nplastic": _plastic("tendon_plasticadr"),
    },
    "mesh": {
        "nmeshvert": Run("mesh_vertadr", counted("mesh_vertnum")),
        "nmeshnormal": Run("mesh_normaladr", counted("mesh_normalnum")),
        "nmeshtexcoord": Run("mesh_texcoordadr", counted("mesh_texcoordnum")),
        "nmeshface": Run("mesh_faceadr", counted("mesh_facenum")),
        "nmeshpoly": Run("mesh_polyadr", counted("mesh_polynum")),
        "nmeshgraph": Run("mesh_graphadr", _up_to_the_next("mesh_graphadr", "nmeshgraph", "mesh_graphadr")),
    },
    "hfield": {"nhfielddata": Run("hfield_adr", _cells(*_HFIELD), shape=_grid(*_HFIELD))},
    "texture": {"ntexdata": Run("tex_adr", _cells(*_TEXTURE), shape=_grid(*_TEXTURE))},
    "skin": {
        "nskinvert": Run("skin_vertadr", counted("skin_vertnum")),
        "nskintexvert": Run("skin_texcoordadr", counted("skin_vertnum")),
        "nskinface": Run("skin_faceadr", counted("skin_facenum")),
        "nskinbone": Run("skin_boneadr", counted("skin_bonenum")),
    },
    "flex": {
        "nflexvert": Run("flex_vertadr", counted("flex_vertnum")),
        "nflexnode": Run("flex_nodeadr", counted("flex_nodenum")),
        "nflexedge": Run("flex_edgeadr", counted("flex_edgenum")),
        "nflexelem": Run("flex_elemadr", counted("flex_elemnum")),
        "nflexelemdata": Run("flex_elemdataadr", _corners),
        "nflexelemedge": Run("flex_elemedgeadr", _edges),
        "nplastic": _plastic("flex_plasticadr"),
        "nflexshelldata": Run("flex_shelldataadr", _cells("flex_shellnum", "flex_dim")),
    },
    "numeric": {"nnumericdata": Run("numeric_adr", counted("numeric_size"))},
    "tuple": {"ntupledata": Run("tuple_adr", counted("tuple_size"))},
    "plugin": {"npluginstate": Run("plugin_stateadr", counted("plugin_statenum"))},
}
"""By kind, and by the size that an array has rows for."""

VECTORS: Mapping[str, tuple[str, str]] = {
    "qpos": ("joint", "nq"),
    "qvel": ("joint", "nv"),
    "ctrl": ("actuator", "nu"),
    "act": ("actuator", "na"),
    "sensordata": ("sensor", "nsensordata"),
    "mocap_pos": ("body", "nmocap"),
}
"""The vectors of `mjData` that users address: the kind of their elements, and their length in `mjModel`."""

_OUTPUTS = frozenset({"actuator_gear", "actuator_lengthrange", "actuator_length0", "actuator_acc0"})


def span(model: Model, vector: str, index: int) -> range:
    """Return the addresses of an element in a vector of its kind; empty if it has none."""
    kind, size = VECTORS[vector]
    return RUNS[kind][size].rows(model, index)


def rows_of(model: Model, kind: str, array: str, index: int) -> range:
    """Return the rows of an element in an array of `mjModel` named after its kind or state.

    Most arrays have one row for each element. Joints have several rows in `qpos0`, `qpos_spring` and the `dof_`
    arrays; since MuJoCo 4 actuators may have several in those about controls (`actuator_ctrlrange`) and outputs
    (`actuator_gear`).
    """
    size = None
    if kind == "joint":
        size = "nv" if array.startswith("dof_") else "nq" if array.startswith("qpos") else None
    elif kind == "actuator":
        size = "nu" if "ctrl" in array else "nout" if array in _OUTPUTS else None
    return range(index, index + 1) if size is None else RUNS[kind][size].rows(model, index)


RaggedRun = tuple[str, Array]

_OCTREE = Run("mesh_octadr", counted("mesh_octnum"))
_VERTEX_PAIRS = Run("flex_evpairadr", counted("flex_evpairnum"))


def runs(model: Model, kind: str, index: int) -> Iterator[RaggedRun]:
    """Yield the data of one element, array by array, in a fixed order; shape (n,) or (n, width) as in `mjModel`.

    Arrays that this MuJoCo does not have are left out. ``links`` has the references.
    """
    reader = _READERS.get(kind)
    if reader:
        yield from reader(model, index)


def _slices(model: Model, rows: range, *arrays: str) -> Iterator[RaggedRun]:
    for name in arrays:
        array = getattr(model, name, None)
        if array is not None:
            yield name, array[rows.start : rows.stop]


def _joint(model: Model, index: int) -> Iterator[RaggedRun]:
    if int(model.jnt_type[index]) != FREE:
        yield from _slices(model, span(model, "qpos", index), "qpos0", "qpos_spring")


def _mesh(model: Model, index: int) -> Iterator[RaggedRun]:
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


def _nested(model: Model, rows: range, first: str, number: str, *arrays: str) -> Iterator[RaggedRun]:
    """Yield the data that consecutive rows of an element point to in turn."""
    if rows:
        start = int(getattr(model, first)[rows.start])
        count = int(getattr(model, number)[rows.start : rows.stop].sum())
        yield from _slices(model, range(start, start + count), *arrays)


def _hfield(model: Model, index: int) -> Iterator[RaggedRun]:
    yield from _slices(model, RUNS["hfield"]["nhfielddata"].rows(model, index), "hfield_data")


def _texture(model: Model, index: int) -> Iterator[RaggedRun]:
    yield from _slices(model, RUNS["texture"]["ntexdata"].rows(model, index), "tex_data")


def _skin(model: Model, index: int) -> Iterator[RaggedRun]:
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


def _flex(model: Model, index: int) -> Iterator[RaggedRun]:
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


def _tendon(model: Model, index: int) -> Iterator[RaggedRun]:
    path = RUNS["tendon"]["nwrap"].rows(model, index)
    kinds = model.wrap_type[path.start : path.stop]
    yield "wrap_type", kinds
    yield "wrap_prm", np.where(np.isin(kinds, WRAPS_A_GEOM), 0.0, model.wrap_prm[path.start : path.stop])


def _actuator(model: Model, index: int) -> Iterator[RaggedRun]:
    if not hasattr(model, "actuator_ctrladr"):
        return  # MuJoCo 3: these arrays have one row for each actuator
    own = RUNS["actuator"]
    yield from _slices(model, own["nu"].rows(model, index), "actuator_ctrllimited", "actuator_ctrlrange")
    outputs = own["nout"].rows(model, index)
    yield from _slices(
        model, outputs, "actuator_gear", "actuator_length0", "actuator_lengthrange", "actuator_acc0"
    )


def _numeric(model: Model, index: int) -> Iterator[RaggedRun]:
    yield from _slices(model, RUNS["numeric"]["nnumericdata"].rows(model, index), "numeric_data")


def _text(model: Model, index: int) -> Iterator[RaggedRun]:
    data = bytes(model.text_data)
    first = int(model.text_adr[index])
    yield "text_data", np.frombuffer(data[first : first + int(model.text_size[index])], dtype=np.uint8)


def _tuple(model: Model, index: int) -> Iterator[RaggedRun]:
    yield from _slices(model, RUNS["tuple"]["ntupledata"].rows(model, index), "tuple_objtype", "tuple_objprm")


def _plugin(model: Model, index: int) -> Iterator[RaggedRun]:
    first = int(model.plugin_attradr[index])
    later = model.plugin_attradr[model.plugin_attradr > first]
    end = int(later.min()) if len(later) else len(model.plugin_attr)
    yield "plugin_attr", model.plugin_attr[first:end]


_READERS: dict[str, Callable[[Model, int], Iterator[RaggedRun]]] = {
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

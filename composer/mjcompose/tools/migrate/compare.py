"""Compare the models that two versions of MuJoCo made, array by array."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from typing import Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.base.words import element_text
from mjcompose.mujoco.arrays import UNSAID, about
from mjcompose.mujoco.attributes import KINDS
from mjcompose.mujoco.environments import CompiledByVersion
from mjcompose.mujoco.unequal import Bound, differing_rows, unequal
from mjcompose.tools.migrate.editing import later

FLAGS = {
    "nativeccd": False,
    "multiccd": False,
    "island": False,
    "autoreset": True,
    "sleep": False,
    "diagexact": False,
    "ipc": False,
    "speculative": False,
    "sensornoise": False,
    "spring": True,
    "damper": True,
}
"""The behavior of a version without the flag."""

Array = np.ndarray[Any, Any]

TOLERANCE = 1e-6
"""Relative to the largest number of a row: meshes are in single precision, and versions add in different orders."""
_SMALL = 1e-8
_BOUND = Bound(TOLERANCE, absolute=_SMALL, floor=0.0, of="row")
_SURFACE = 1e-4
_SUMS = "3.5.0"
_GAPS = "3.9.0"
_MOST = 2000
_DRAWN = 6  # standard deviations between two counts of random marks
_AUTO = 2
_STATISTICS = ("stat.center", "stat.extent", "stat.meansize")
_LOOSE = 2e4
_SHOWN = 6
_PREFIXES = {kind.arrays: word for word, kind in KINDS.items()} | {"dof": "dof"}
_NOT_COMPARED = re.compile("n[^_]*|nnames_map|(name|flg)_.*")
"""Numbers of rows, flags of the compiler, and addresses of names."""
_ALIASES = {
    "opt.mpr_iterations": "opt.ccd_iterations",
    "opt.mpr_tolerance": "opt.ccd_tolerance",
    "cam_orthographic": "cam_projection",
    "tex_rgb": "tex_data",
}


class ArrayDifference(Struct):
    """A difference in one array; `element` is the first one that differs, and `count` is their number."""

    array: str
    element: str
    before: str
    after: str
    count: int

    def words(self) -> str:
        more = f", and of {self.count - 1} more" if self.count > 1 else ""
        return f"`{self.array}` of {self.element}{more}: {self.before} before, {self.after} now"


class ArrayComparison(Struct, frozen=False):
    """`equal` arrays agree bit for bit, `rounded` arrays up to rounding; `apart` cannot be compared."""

    differences: list[ArrayDifference] = field(default_factory=list)
    equal: list[str] = field(default_factory=list)
    rounded: list[str] = field(default_factory=list)
    apart: list[str] = field(default_factory=list)
    recut: list[str] = field(default_factory=list)
    """Meshes with the same surface, in other triangles."""

    @property
    def same(self) -> bool:
        return not self.differences

    @property
    def settled(self) -> frozenset[str]:
        return frozenset((*self.equal, *self.rounded))


def compare(before: CompiledByVersion, after: CompiledByVersion) -> ArrayComparison:
    """Compare two models, both compiled without error."""
    outcome = ArrayComparison()
    one = _Side.of(before)
    two = _Side.of(after)
    _combine_margins(one, two, outcome)
    _settle_surfaces(one, two, outcome)
    _settle_marks(one, two)
    pairs = _pairs(one, two, outcome)
    for array in sorted(one.arrays.keys() | two.arrays.keys()):
        if not about(array).version and not _NOT_COMPARED.fullmatch(array):
            _compare(array, one, two, pairs=pairs, outcome=outcome)
    flags = [_flags(side) for side in (one, two)]
    for flag in sorted(flags[0].keys() | flags[1].keys()):
        words = ["enabled" if each.get(flag, FLAGS.get(flag, False)) else "disabled" for each in flags]
        if words[0] == words[1]:
            outcome.equal.append(f"flags.{flag}")
        else:
            outcome.differences.append(ArrayDifference(f"flags.{flag}", "the model", words[0], after=words[1], count=1))
    return outcome


class _Side(Struct, frozen=False):
    arrays: dict[str, Array]
    names: Mapping[str, Any]
    words: Mapping[str, Any]
    version: str = ""
    scale: Array = field(default_factory=lambda: np.zeros(0))
    """The size of the mesh of each triangle."""

    @classmethod
    def of(cls, compiled: CompiledByVersion) -> _Side:
        assert compiled.arrays is not None
        with np.load(compiled.arrays, allow_pickle=False) as stored:
            arrays = {_ALIASES.get(name, name): stored[name] for name in stored.files}
        side = cls(arrays, compiled.names, compiled.words, compiled.version)
        side.normalize()
        return side

    def normalize(self) -> None:
        """Bring arrays that versions store in different forms into one form."""
        arrays = self.arrays
        for array, words in self.words.items():
            if array != "flags" and array in arrays:
                arrays[array] = np.array(words)
        types = arrays.get("light_type")
        if types is not None:
            arrays["light_directional"] = types == "mjLIGHT_DIRECTIONAL"
        if arrays["eq_data"].ndim > 1:
            arrays["eq_data"] = arrays["eq_data"][:, :11]
        textures = arrays["mat_texid"]
        arrays["mat_texid"] = textures.reshape(len(textures), -1).max(axis=1) if textures.size else textures.ravel()
        if "flex_matid" in arrays and len(arrays["flex_matid"]) != len(arrays["flex_dim"]):
            arrays["flex_matid"] = arrays["flex_matid"][arrays["flex_elemadr"]]
        for name in ("flex_stiffness", "flex_bending"):
            if name in arrays:
                arrays[name] = arrays[name].ravel() if arrays[name].any() else np.zeros(0)
        policy = arrays.pop("tree_sleep_policy", None)
        if policy is not None:
            arrays["tree_sleep"] = np.where(policy >= 3, policy, 0)  # the compiler chooses smaller policies
        if later(_GAPS, self.version):  # the force of a contact began at the margin less the gap
            for kind in ("geom", "pair"):
                arrays[f"{kind}_margin"] = arrays[f"{kind}_margin"] - arrays[f"{kind}_gap"]
        self._unrotate_meshes()
        rotations = _matrices(arrays["body_iquat"])
        tensors = np.einsum("nij,nj,nkj->nik", rotations, arrays["body_inertia"], rotations)
        arrays["body_inertia"] = tensors.reshape(len(tensors), 9)
        del arrays["body_iquat"]

    def _unrotate_meshes(self) -> None:
        """Put meshes and their geoms in the frame of the file: MuJoCo turns a mesh by its inertia, whose axes vary."""
        arrays = self.arrays
        poses = _matrices(arrays["mesh_quat"]), arrays["mesh_pos"]
        vertices = arrays["mesh_vert"].astype(float)
        corners = np.zeros((len(arrays["mesh_face"]), 9))
        self.scale = np.zeros_like(corners)
        for mesh, (start, count) in enumerate(zip(arrays["mesh_vertadr"], arrays["mesh_vertnum"], strict=True)):
            rows = slice(start, start + count)
            vertices[rows] = vertices[rows] @ poses[0][mesh].T + poses[1][mesh]
            faces = slice(arrays["mesh_faceadr"][mesh], arrays["mesh_faceadr"][mesh] + arrays["mesh_facenum"][mesh])
            corners[faces] = vertices[arrays["mesh_face"][faces] + start].reshape(-1, 9)
            self.scale[faces] = np.abs(vertices[rows]).max(initial=0)
        # Versions merge equal vertices in other orders; the triangles stay.
        arrays["mesh_face"] = corners
        kinds = np.asarray(self.words.get("geom_type", ()))
        of_meshes = np.flatnonzero(np.isin(kinds, ("mjGEOM_MESH", "mjGEOM_SDF")) & (arrays["geom_dataid"] >= 0))
        fitted = ~np.isin(kinds, ("mjGEOM_MESH", "mjGEOM_SDF", "mjGEOM_HFIELD"))
        arrays["geom_dataid"] = np.where(fitted, -1, arrays["geom_dataid"])  # the mesh that it was fitted to
        rotations = _matrices(arrays["geom_quat"])
        places = arrays["geom_pos"].copy()
        for geom in of_meshes:
            mesh = arrays["geom_dataid"][geom]
            rotations[geom] = rotations[geom] @ poses[0][mesh].T
            places[geom] = places[geom] - rotations[geom] @ poses[1][mesh]
        arrays["geom_pos"] = places
        for name in ("geom_size", "geom_rbound"):  # of the box of the mesh along its own axes
            arrays[name] = arrays[name].copy()
            arrays[name][of_meshes] = 0
        arrays["geom_quat"] = rotations.reshape(len(rotations), 9)


def _matrices(quats: Array) -> Array:
    w, x, y, z = (quats[:, i].astype(float) for i in range(4))
    rows = [
        1 - 2 * (y * y + z * z),
        2 * (x * y - w * z),
        2 * (x * z + w * y),
        2 * (x * y + w * z),
        1 - 2 * (x * x + z * z),
        2 * (y * z - w * x),
        2 * (x * z - w * y),
        2 * (y * z + w * x),
        1 - 2 * (x * x + y * y),
    ]
    return np.stack(rows, axis=-1).reshape(-1, 3, 3)


def _combine_margins(one: _Side, two: _Side, outcome: ArrayComparison) -> None:
    """Compare margins of contacts if one version uses the sum of both geoms' margins and the other the larger one."""
    is_same_rule = later(_SUMS, one.version) == later(_SUMS, two.version)
    if is_same_rule or len(one.arrays["geom_margin"]) != len(two.arrays["geom_margin"]):
        return
    collide = (one.arrays["geom_contype"] | one.arrays["geom_conaffinity"]) != 0
    if collide.sum() > _MOST:
        outcome.apart.append("geom_margin")
        collide = collide & (np.cumsum(collide) <= _MOST)
    for side in (one, two):
        for name in ("margin", "gap"):
            values = side.arrays.pop(f"geom_{name}")[collide]
            each = np.maximum.outer if later(_SUMS, side.version) else np.add.outer
            side.arrays[f"contact_{name}"] = each(values, values)


def _settle_surfaces(one: _Side, two: _Side, outcome: ArrayComparison) -> None:
    """Treat meshes with different triangles as equal if their surface is equal."""
    x = one.arrays["mesh_face"]
    y = two.arrays["mesh_face"]
    starts = one.arrays["mesh_faceadr"]
    others = two.arrays["mesh_faceadr"]
    if len(starts) != len(others):
        return
    counts = one.arrays["mesh_facenum"]
    lengths = two.arrays["mesh_facenum"]
    used = {int(each) for side in (one, two) for each in side.arrays["geom_dataid"]}
    used |= {int(each) for side in (one, two) for each in side.arrays.get("site_dataid", ())}
    kept: list[Array] = []
    for mesh, (start, other) in enumerate(zip(starts, others, strict=True)):
        a = x[start : start + counts[mesh]]
        b = y[other : other + lengths[mesh]]
        # Versions place a mesh that no geom shows differently.
        is_same = mesh not in used and a.shape == b.shape
        if not is_same and (a.shape != b.shape or unequal(a, b, _BOUND, one.scale[start : start + counts[mesh]]).any()):
            is_same = _same_surface(a, b)
            if is_same:
                outcome.recut.append(_called("mesh", mesh, one))
            is_same = is_same or _look_alike(a, b, mesh, one=one, two=two)
        kept.append(a if is_same else b)
    if kept:
        two.arrays["mesh_face"] = np.concatenate(kept)


def _settle_marks(one: _Side, two: _Side) -> None:
    """Treat random marks of a texture as equal if their number and the other pixels agree.

    MuJoCo 3.2 draws them with a different generator from 3.1.
    """
    marks = one.words.get("marks", ())
    if not any(marks) or list(marks) != list(two.words.get("marks", ())):
        return
    x, y = (side.arrays["tex_data"] for side in (one, two))
    if x.shape != y.shape or not np.array_equal(one.arrays["tex_adr"], two.arrays["tex_adr"]):
        return
    ends = [*one.arrays["tex_adr"][1:], len(x)]
    for start, end, mark in zip(one.arrays["tex_adr"], ends, marks, strict=True):
        if mark is None or (end - start) % len(mark):
            continue
        ours, theirs = (each[start:end].reshape(-1, len(mark)) for each in (x, y))
        marked = [(each == np.array(mark)).all(axis=1) for each in (ours, theirs)]
        counts = [int(each.sum()) for each in marked]
        if abs(counts[0] - counts[1]) <= _DRAWN * np.sqrt(sum(counts)):
            theirs[marked[0] | marked[1]] = ours[marked[0] | marked[1]]


def _look_alike(x: Array, y: Array, mesh: int, one: _Side, two: _Side) -> bool:
    """Return whether all geoms with a mesh look alike in their bodies: a mesh may move if its geoms compensate."""
    geoms = np.flatnonzero(one.arrays["geom_dataid"] == mesh)
    if not np.array_equal(geoms, np.flatnonzero(two.arrays["geom_dataid"] == mesh)):
        return False

    def placed(corners: Array, side: _Side, geom: Any) -> Array:
        rotation = side.arrays["geom_quat"][geom].reshape(3, 3)
        place = side.arrays["geom_pos"][geom]
        return np.asarray(corners.reshape(-1, 3) @ rotation.T + place)

    if not all(_same_surface(placed(x, one, geom), placed(y, two, geom)) for geom in geoms):
        return False
    for name in ("geom_pos", "geom_quat"):
        two.arrays[name][geoms] = one.arrays[name][geoms]
    return bool(len(geoms))


def _same_surface(x: Array, y: Array) -> bool:
    if not x.size or not y.size:
        return False
    one, two = (_measures(each.reshape(-1, 3, 3)) for each in (x, y))
    return bool((np.abs(one - two) <= _SURFACE * np.abs(one).max()).all())


def _measures(triangles: Array) -> Array:
    """Return lengths: the box, the center of the surface, and the roots of the area and the volume."""
    a = triangles[:, 0]
    b = triangles[:, 1]
    c = triangles[:, 2]
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
    center = (areas[:, None] * triangles.mean(axis=1)).sum(axis=0) / max(areas.sum(), 1e-300)
    corners = triangles.reshape(-1, 3)
    sizes = [np.sqrt(areas.sum()), np.cbrt(volume)]
    return np.concatenate([corners.min(axis=0), corners.max(axis=0), center, sizes])


def _pairs(one: _Side, two: _Side, outcome: ArrayComparison) -> dict[str, Array]:
    """Return the places in the second model of the elements of the first, for kinds whose order differs."""
    found: dict[str, Array] = {}
    for kind, names in one.names.items():
        other = list(two.names.get(kind, ()))
        if list(names) == other:
            continue
        keys = _keys(list(names))
        others = _keys(other)
        for here, there, words in ((keys, others, ("present", "missing")), (others, keys, ("missing", "present"))):
            several = [key for key in here if key not in there]
            if several:
                name = several[0][0]
                element = element_text(kind, name)
                outcome.differences.append(ArrayDifference(f"{kind} names", element, *words, len(several)))
        if sorted(keys, key=str) == sorted(others, key=str):
            found[kind] = np.array([others.index(each) for each in keys])
    return found


def _keys(names: list[str | None]) -> list[tuple[str | None, int]]:
    """Return names with the number of earlier elements of the same name, because several may be unnamed."""
    return [(name, names[:at].count(name)) for at, name in enumerate(names)]


def _compare(array: str, one: _Side, two: _Side, pairs: Mapping[str, Array], outcome: ArrayComparison) -> None:
    x = one.arrays.get(array)
    y = two.arrays.get(array)
    if x is None or y is None or (x.size != y.size and not (x.size and y.size)):
        _compare_one_sided(array, one, two, outcome)
        return
    kind = _PREFIXES.get(array.partition("_")[0], "")
    if x.shape != y.shape:
        if len(x) == len(y) or not _counts_differ(kind, one, two):  # `_pairs` reports other elements
            outcome.apart.append(array)
        return
    if kind in pairs and len(pairs[kind]) == len(y):
        y = y[pairs[kind]]
    if x.dtype.kind in "US" or y.dtype.kind in "US":
        wrong = x != y
    else:
        x = x.astype(float)
        y = y.astype(float)
        if np.array_equal(x, y, equal_nan=True):
            outcome.equal.append(array)
            return
        x, y = _as_same_version(array, x, y)
        wrong = unequal(x, y, _BOUND, _scale(array, x, one))
    if not wrong.any():
        outcome.rounded.append(array)
        return
    row, element, count = _first(array, wrong, one)
    before, after = (_shown_at(row, values) for values in (x, y))
    outcome.differences.append(ArrayDifference(array, element, before, after=after, count=count))


def _compare_one_sided(array: str, one: _Side, two: _Side, outcome: ArrayComparison) -> None:
    """Compare an array of which at most one version has values."""
    before = one.arrays.get(array)
    is_new = before is None or not before.size
    side = two if is_new else one
    values = side.arrays.get(array)
    if values is not None and values.size:
        _compare_with_neutral(array, values, is_new, side=side, outcome=outcome)


def _counts_differ(kind: str, one: _Side, two: _Side) -> bool:
    """Return whether the models have different numbers of elements of a kind with names."""
    return kind in one.names and len(one.names[kind]) != len(two.names.get(kind, ()))


def _as_same_version(array: str, x: Array, y: Array) -> tuple[Array, Array]:
    """Return two arrays in which equal meanings in both versions have equal numbers."""
    if array == "vis.headlight.active":
        # `auto` of 4.0 is always on in earlier versions and their renderer.
        y = np.where(x == _AUTO, _AUTO, y)
    if UNSAID in about(array).traits:
        unsaid = about(array).neutral
        x = np.where(np.isin(x, unsaid), unsaid[0], x)
        y = np.where(np.isin(y, unsaid), unsaid[0], y)
    if "." in array and x.ndim == 1:  # of the whole model
        x = x[None]
        y = y[None]
    return x, y


def _first(array: str, wrong: Array, side: _Side) -> tuple[int, str, int]:
    """Return the first row that differs, the element with it, and the number of such rows."""
    if not wrong.ndim:
        return 0, "the model", 1
    rows = differing_rows(wrong)
    return rows[0], _label(array, rows[0], side), len(rows)


def _scale(array: str, x: Array, one: _Side) -> Array | None:
    """Return the sizes that differences are relative to; None for the values themselves."""
    if array in _STATISTICS:  # of boxes along the axes of meshes, which vary
        return np.full_like(x, _LOOSE * np.abs(x).max(initial=1.0))
    return one.scale if array == "mesh_face" else None


def _compare_with_neutral(array: str, values: Array, is_new: bool, side: _Side, outcome: ArrayComparison) -> None:
    """Compare an array that only one version has with the values that it has if nobody writes it."""
    if array in ("light_type", "light_directional"):
        return
    known = about(array).neutral
    if not known:
        outcome.apart.append(array)
        return
    wrong = ~np.isclose(values.astype(float)[..., None], known, rtol=TOLERANCE, atol=_SMALL).any(axis=-1)
    if not wrong.any():
        outcome.equal.append(array)
        return
    row, element, count = _first(array, wrong, side)
    words = ["absent", _shown_at(row, values)]
    before, after = words if is_new else reversed(words)
    outcome.differences.append(ArrayDifference(array, element, before, after=after, count=count))


def _flags(side: _Side) -> dict[str, bool]:
    flags = dict(side.words["flags"])
    if "passive" in flags:
        flags["spring"] = flags["damper"] = flags.pop("passive")
    return flags


def _label(array: str, row: int, side: _Side) -> str:
    kind = _PREFIXES.get(array.partition("_")[0])
    if array == "mesh_face":
        kind = "mesh"
        row = int(np.searchsorted(side.arrays["mesh_faceadr"], row, side="right")) - 1
    if kind == "dof" and "dof_jntid" in side.arrays:
        kind = "joint"
        row = int(side.arrays["dof_jntid"][row])
    if array.startswith("contact_"):
        row = int(np.flatnonzero((side.arrays["geom_contype"] | side.arrays["geom_conaffinity"]) != 0)[row])
        kind = "geom"
    return "the model" if kind is None else _called(kind, row, side)


def _called(kind: str, row: int, side: _Side) -> str:
    names = side.names.get(kind, ())
    if row >= len(names):
        return f"row {row}"
    return f"{kind} `{names[row]}`" if names[row] else f"{kind} {row}"


def _shown(value: Any) -> str:
    flat = np.ravel(value)
    words = [f"{each:.6g}" if isinstance(each, float) else str(each) for each in flat[:_SHOWN].tolist()]
    return " ".join(words) + (" …" if len(flat) > _SHOWN else "")


def _shown_at(row: int, values: Array) -> str:
    return _shown(values[row] if values.ndim else values)

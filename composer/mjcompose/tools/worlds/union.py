"""Turn models with different parts into worlds of one model with all parts."""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.read import read
from mjcompose.bundle.staging import write_folder
from mjcompose.mujoco.addresses import VECTORS
from mjcompose.mujoco.arrays import Treatment, about
from mjcompose.mujoco.attributes import KINDS, NameTable
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.references import links
from mjcompose.mujoco.settable import are_close
from mjcompose.mujoco.varying import (
    MEAN_INERTIA,
    MEAN_MASS,
    Differences,
    Rows,
    flat,
    owners,
    places_of_rows,
    put,
    rows_of_size,
)
from mjcompose.sources.context import Context
from mjcompose.tools.worlds.cell_numbers import APART
from mjcompose.tools.worlds.join import Joining, Tree, UnsharedBody, WorldGroup, common, parts as joined_parts
from mjcompose.tools.worlds.load import load
from mjcompose.tools.worlds.names import failure
from mjcompose.tools.worlds.of_sources import build_of_sources
from mjcompose.tools.worlds.same_tree import CODE
from mjcompose.tools.worlds.volumes import set_volumes
from mjcompose.tools.worlds.worlds import Varying, Worlds, model_of_world

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


class UnionPart(Struct):
    """A part of a union: its prefix there, and the number of the model that it comes from."""

    part: UnsharedBody
    prefix: str
    source: int


class UnionPlan(Struct):
    """The contents of a union: bodies that all models share, all parts, and the parts of each model."""

    shared: set[str]
    placed: list[UnionPart]
    active: list[list[UnionPart]]


def plan_union(trees: Sequence[Tree], labels: Sequence[str]) -> UnionPlan:
    """Plan a union: parts of all models except the first get prefixes from their labels. Raises LoadError."""
    shared = common(trees)
    placed: list[UnionPart] = []
    active: list[list[UnionPart]] = []
    for number, tree in enumerate(trees):
        own = []
        for each in joined_parts(tree, shared):
            known = next((other for other in placed if other.part == each), None)
            if known is None:
                known = UnionPart(each, _prefix(labels[number], placed) if number else "", number)
                placed.append(known)
            own.append(known)
        active.append(own)
    return UnionPlan(shared, placed, active)


def _prefix(label: str, placed: Sequence[UnionPart]) -> str:
    stem = "".join(each if each.isalnum() else "_" for each in Path(label).stem) or "part"
    taken = {each.prefix for each in placed}
    names = (f"{stem}{number or ''}/" for number in range(len(placed) + 1))
    return next(name for name in names if name not in taken)


def compose_union(
    plan: UnionPlan, name: str, folders: Sequence[Path], separator: str, context: Context, session: Session
) -> Bundle:
    """Return the bundle of a union of the bundles in folders. Raises LoadError if it cannot be composed."""
    attach = {}
    for each in plan.placed:
        if each.source:
            place = {} if each.part.parent == "world" else {"body": each.part.parent}
            model = f"./{folders[each.source].name}/model.xml"
            part = {"model": model, "subtree": each.part.body, "drop": [{"key": "**", "optional": True}], **place}
            attach[each.prefix.rstrip("/")] = part
    recipe = {
        "recipe": 1,
        "name": name,
        "separator": separator,
        "base": f"./{folders[0].name}/model.xml",
        "attach": attach,
        "conflict": "base",
    }
    models = [read(folder) for folder in folders]
    return build_of_sources(recipe, folders[0].parent / "union.yaml", models, context, session=session)


def bodies_of(trees: Sequence[Tree], each: UnionPart) -> Iterator[str]:
    return (each.prefix + body for body in trees[each.source].below(each.part.body))


def _presence(groups: Sequence[WorldGroup], plan: UnionPlan, count: int) -> Any:
    """Return which world (row) has which part of the union (column)."""
    has = np.zeros((count, len(plan.placed)), bool)
    for group, active in zip(groups, plan.active, strict=True):
        has[np.ix_(group.worlds, [plan.placed.index(part) for part in active])] = True
    return has


def unite(joining: Joining, name: str, context: Context, session: Session) -> tuple[Worlds, Bundle]:
    """Return the worlds of all models, and the bundle of their common model. Raises LoadError."""
    import mujoco

    groups = joining.groups
    trees = [Tree(each.first.loaded.model, each.first.name) for each in groups]
    plan = plan_union(trees, [_label(each, groups) for each in groups])
    folders = [each.first.folder for each in groups if each.first.folder is not None]
    separator = groups[0].first.loaded.manifest.separator
    bundle = compose_union(plan, name, folders, separator=separator, context=context, session=session)
    folder = folders[0].parent / "union"
    write_folder(bundle, folder)
    loaded = load(folder)
    union = loaded.model
    count = sum(len(each.worlds) for each in groups)
    found = Differences(union, count)
    for group, tree, active in zip(groups, trees, plan.active, strict=True):
        prefix_of = {body: each.prefix for each in active for body in tree.below(each.part.body)}
        mapped = Mapped(union, group.first.loaded.model, group.first.name, prefix_of=prefix_of)
        unused = [body for each in plan.placed if each not in active for body in bodies_of(trees, each)]
        mapped.check_no_more_acts(unused)
        for place, (world, model) in enumerate(zip(group.worlds, _models(group), strict=True)):
            made = _world(mujoco, union, mapped, model=model, unused=unused)
            if place in (0, len(group.worlds) - 1):
                _check(mapped, made, model, name=group.first.name)
            found.take(world, made)
    varying = {name: Varying(index, values) for name, index, values in found.found()}
    parts = tuple(each.prefix + each.part.body for each in plan.placed)
    table = replace(joining.table(loaded, varying), parts=parts, has=_presence(groups, plan, count))
    return Worlds(union, loaded.manifest, loaded.index, table=table), bundle


def _label(group: WorldGroup, groups: Sequence[WorldGroup]) -> str:
    ours = group.first.cell
    first = groups[0].first.cell
    other = [str(value) for axis, value in ours.items() if axis != "name" and first.get(axis) != value]
    return "-".join(Path(each).stem for each in other) or str(ours["name"])


def _models(group: WorldGroup) -> Iterator[MjModel]:
    nominal = group.first.loaded.model
    varying = dict(group.varying())
    for place in range(len(group.worlds)):
        yield model_of_world(nominal, varying, place)


def _world(mujoco: object, union: MjModel, mapped: Mapped, model: MjModel, unused: Sequence[str]) -> MjModel:
    made = copy.copy(union)
    for name in numbers(union):
        if hasattr(model, name):
            to, of = mapped.pairs(name)
            flat(made, name)[to] = flat(model, name)[of]
    mapped.put_keys(made, model)
    for name in dir(model.opt):
        if not name.startswith("_") and isinstance(getattr(model.opt, name), np.ndarray | float | int):
            put(made, f"opt.{name}", flat(model, f"opt.{name}"))
    for name, index, value in silenced(union, unused):
        flat(made, name)[index] = value
    set_volumes(made, _with_other_geoms(union, made), np.flatnonzero(made.geom_margin == APART).tolist())
    mujoco.mj_setConst(made, mujoco.MjData(made))  # type: ignore[attr-defined]
    # Solvers stop when a step improves less than their tolerance, in units of this times the number of dofs.
    put(made, MEAN_INERTIA, flat(model, MEAN_INERTIA) * model.nv / max(1, made.nv))
    put(made, MEAN_MASS, flat(model, MEAN_MASS))
    return made


def _with_other_geoms(union: MjModel, made: MjModel) -> list[int]:
    """Return the bodies whose bounding volumes are others than in the union."""
    bodies: set[int] = set()
    for name in ("geom_pos", "geom_quat", "geom_aabb", "geom_margin"):
        differ = getattr(union, name) != getattr(made, name)
        bodies.update(made.geom_bodyid[differ.reshape(len(differ), -1).any(axis=1)].tolist())
    for name in ("body_ipos", "body_iquat"):
        bodies.update(np.flatnonzero((getattr(union, name) != getattr(made, name)).any(axis=1)).tolist())
    return sorted(bodies)


def _check(mapped: Mapped, made: MjModel, model: MjModel, name: str) -> None:
    """Check that MuJoCo computes the same for the union in a world as for the model. Raises LoadError."""
    different = []
    for array in (*numbers(model), *derived(model)):
        to, of = mapped.pairs(array) if hasattr(made, array) else (np.empty(0, int), np.empty(0, int))
        if not are_close(flat(made, array)[to], flat(model, array)[of]):
            different.append(array)
    if different:
        listed = ", ".join(f"`{each}`" for each in different)
        help = "build this cell by itself with `--pick`"
        raise failure(CODE, f"`{name}` differs from the union of all models in its world: {listed}", help)


Label = Callable[[str, int], str]
"""Returns an element's name by kind and number."""
References = Iterator[tuple[str, int]]
"""The kind and number of each element."""

ACTING = ("actuator", "tendon", "equality", "pair", "exclude", "sensor")
"""Kinds of elements that act on their references."""
_TRANSMISSIONS = range(6)
_ALONE = "build these cells separately with `--pick`"
_OTHER_LINKS = ("tendon_matid", "tendon_actuatorid")


def references(model: MjModel, kind: str, number: int) -> References:
    """Return the kind and number of each element that one acts on. Raises LoadError for an unknown transmission."""
    if kind == "actuator" and (transmission := int(model.actuator_trntype[number])) not in _TRANSMISSIONS:
        message = f"an actuator with a transmission of type {transmission} cannot be in a union"
        raise failure(CODE, message, _ALONE)
    if kind in ACTING:
        for link in links(model, kind, number):
            if link.index >= 0 and link.kind != "plugin" and link.field not in _OTHER_LINKS:
                yield link.kind, link.index


def words(model: MjModel, kind: str, number: int, label: Label) -> str:
    """Return an element's type and references: `equality 1 body a body b`."""
    of_type = {"actuator": "actuator_trntype", "equality": "eq_type", "sensor": "sensor_type"}.get(kind)
    head = f"{kind} {int(getattr(model, of_type)[number])}" if of_type else kind
    return " ".join([head, *(f"{of} {label(of, each)}" for of, each in references(model, kind, number))])


def referring_bodies(model: MjModel, kind: str, number: int) -> Iterator[int]:
    for of, each in references(model, kind, number):
        if of == "body":
            yield each
        elif of in ("joint", "site", "geom", "camera"):
            yield int(getattr(model, {"joint": "jnt", "camera": "cam"}.get(of, of) + "_bodyid")[each])
        elif of == "tendon":
            yield from referring_bodies(model, "tendon", each)


_KEYS = {
    **{f"key_{vector}": VECTORS[vector] for vector in ("qpos", "qvel", "ctrl", "act")},
    **dict.fromkeys(("key_mpos", "key_mquat"), VECTORS["mocap_pos"]),
}
_TREE = ("body", "joint", "geom", "site", "camera", "light")
_NEEDED = (*_TREE, *ACTING, "numeric", "tuple", "material", "key")
_NOT_NUMBERS = {Treatment.SKIPPED, Treatment.PRESENT, Treatment.LINKED, Treatment.SUBTREE, Treatment.DERIVED}


class Mapped:
    """Maps the numbers of a model to a union; `prefix_of` has the prefix of each body of its parts."""

    def __init__(self, union: MjModel, model: MjModel, name: str, prefix_of: Mapping[str, str]) -> None:
        self.union = union
        self.model = model
        self.name = name
        self.prefix_of = prefix_of
        self.theirs = NameTable(model)
        self.ours = NameTable(union)
        self._pairs: dict[str, tuple[np.ndarray, np.ndarray]] = {}
        self.places: dict[str, list[list[int]]] = {}
        for kind in KINDS:  # elements on bodies first, and tendons before elements that refer to them
            ids = {}
            for n, name in enumerate(self.ours.names[kind]):  # references identify unnamed elements
                is_known = name or kind not in ACTING
                label = self.ours.describe(kind, n) if is_known else words(union, kind, n, label=self.ours.describe)
                ids[label] = n
            found = []
            for number in range(self.theirs.count(kind)):
                at = [ids[label] for label in self._labels(kind, number) if label in ids]
                if not at and kind in _NEEDED:
                    shown = self.theirs.describe(kind, number)
                    message = f"`{self.name}` has the {kind} `{shown}`, which belongs to no part of a union"
                    raise failure(CODE, message, "let it refer to bodies of one part, or of all models")
                found.append(at)
            self.places[kind] = found

    def check_no_more_acts(self, unused: Collection[str]) -> None:
        """Check that no element acts in the union that the model lacks, except on absent parts. Raises LoadError."""
        for kind in ACTING:
            known = {at for places in self.places[kind] for at in places}
            for number in range(self.ours.count(kind)):
                on = {self.ours.names["body"][body] for body in referring_bodies(self.union, kind, number)}
                if kind != "sensor" and number not in known and not on & set(unused):
                    shown = self.ours.describe(kind, number)
                    message = f"`{self.name}` lacks the {kind} `{shown}`, which would act in its world"
                    raise failure(CODE, message, "let it act on one part alone, or have it in all models")

    def _labels(self, kind: str, number: int) -> list[str]:
        if kind in _TREE:
            return [self._there(kind, number)]
        name = self.theirs.names[kind][number]
        if name:
            return [
                prefix + name
                for prefix in dict.fromkeys(["", *self.prefix_of.values()])
                if kind not in ACTING or self._acts_alike(kind, number, prefix + name)
            ]
        if kind in ACTING:
            return [words(self.model, kind, number, label=self._there)]
        return [self.theirs.describe(kind, number)]

    def _acts_alike(self, kind: str, number: int, name: str) -> bool:
        """Return whether the union's element with this name has the same references as the model's element."""
        at = self.ours.ids[kind].get(name)
        theirs = words(self.model, kind, number, label=self._there)
        return at is not None and words(self.union, kind, at, label=self.ours.describe) == theirs

    def _there(self, kind: str, number: int) -> str:
        if kind not in _TREE:
            at = self.places[kind][number]
            return self.ours.describe(kind, at[0]) if at else ""
        table = self.theirs
        body = number if kind == "body" else int(getattr(self.model, f"{KINDS[kind].arrays}_bodyid")[number])
        prefix = self.prefix_of.get(table.names["body"][body], "")
        name = table.names[kind][number]
        if name:
            return prefix + name
        return table.describe(kind, number).replace("of body `", f"of body `{prefix}")

    def pairs(self, array: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the flat indices of an array's numbers in the union, and in the model."""
        if array not in self._pairs:
            kind, rows = owners(self.union, array)
            _, others = owners(self.model, array)
            to, of = self._matched(kind, rows, others)
            shapes = (np.shape(getattr(each, array)) for each in (self.union, self.model))
            width, other = (int(np.prod(shape[1:], dtype=int)) for shape in shapes)
            columns = np.arange(min(width, other))
            self._pairs[array] = (to[:, None] * width + columns).ravel(), (of[:, None] * other + columns).ravel()
        return self._pairs[array]

    def put_keys(self, made: MjModel, model: MjModel) -> None:
        """Write the keys of a model into the union's keys of the same name. Raises LoadError for others."""
        for number, places in enumerate(self.places["key"]):
            for array, (kind, size) in _KEYS.items():
                mine = getattr(self.union, size)
                other = getattr(self.model, size)
                if not other:
                    continue
                rows = rows_of_size(self.union, kind, mine)
                to, of = self._matched(kind, rows, rows_of_size(self.model, kind, other))
                for key in places:
                    numbers = getattr(made, array)[key].reshape(mine, -1)
                    numbers[to] = getattr(model, array)[number].reshape(other, -1)[of]

    def _matched(self, kind: str, rows: Rows, others: Rows) -> tuple[np.ndarray, np.ndarray]:
        row_at = {(element, place): row for row, (element, place, _) in rows.items()}
        found = []
        for row, (element, place, _) in others.items():
            at = (row_at.get((there, place)) for there in self.places[kind][element])
            found += [(other, row) for other in at if other is not None]
        pairs = np.array(found, np.int64).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]


def numbers(model: MjModel) -> Iterator[str]:
    """Yield the arrays with properties of elements, as opposed to addresses and references."""
    for name in dir(model):
        array = getattr(model, name) if not name.startswith("_") else None
        if not isinstance(array, np.ndarray) or not array.ndim or name.startswith(("name", "key_", "tex_", "mesh_")):
            continue
        if about(name).treatment not in _NOT_NUMBERS:
            yield name


def derived(model: MjModel) -> Iterator[str]:
    """Yield the arrays that mj_setConst computes, except `dof_length`, which for sleeping depends on all children."""
    for name in dir(model):
        if about(name).treatment in (Treatment.SUBTREE, Treatment.DERIVED) and name != "dof_length":
            yield name


def silenced(union: MjModel, bodies: Iterable[str]) -> list[tuple[str, np.ndarray, Any]]:
    """Return the values that deactivate these bodies in a union: array, flat indices, value."""
    table = NameTable(union)
    at = np.array(sorted(table.ids["body"][name] for name in bodies), np.int64)
    if not at.size:
        return []
    joints = np.flatnonzero(np.isin(union.jnt_bodyid, at))
    dofs = np.flatnonzero(np.isin(union.dof_bodyid, at))
    geoms = np.flatnonzero(np.isin(union.geom_bodyid, at))
    tendons, acting = (
        np.array([n for n in range(count) if np.isin(list(referring_bodies(union, kind, n)), at).any()], int)
        for kind, count in (("tendon", union.ntendon), ("actuator", len(union.actuator_trntype)))
    )
    pairs = np.flatnonzero(np.isin(union.pair_geom1, geoms) | np.isin(union.pair_geom2, geoms))
    zero = {
        "body": (at, "mass inertia"),
        "dof": (dofs, "damping frictionloss dampingpoly"),
        "jnt": (joints, "stiffness stiffnesspoly"),
        "geom": (geoms, "gap"),
        "pair": (pairs, "gap"),
        "tendon": (tendons, "stiffness damping frictionloss armature dampingpoly stiffnesspoly"),
        "actuator": (acting, "gainprm biasprm"),
    }
    named = ((f"{kind}_{each}", rows) for kind, (rows, names) in zero.items() for each in names.split())
    there = [(name, rows) for name, rows in named if not name.endswith("poly") or hasattr(union, name)]
    found = [(name, places_of_rows(getattr(union, name), rows), 0.0) for name, rows in there]
    found += [("dof_armature", dofs, 1.0), ("geom_margin", geoms, APART), ("pair_margin", pairs, APART)]
    return [each for each in found if each[1].size]

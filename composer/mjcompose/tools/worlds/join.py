"""Turn separate models into worlds of the first model."""

from __future__ import annotations

import os
import shutil
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import read_regular
from mjcompose.bundle.bundle import WORLDS, Bundle
from mjcompose.bundle.listing import SIZES
from mjcompose.bundle.read import read as read_bundle
from mjcompose.bundle.staging import write_folder
from mjcompose.language.expand import Cell
from mjcompose.mujoco.addresses import numbers_of
from mjcompose.mujoco.arrays import with_trait
from mjcompose.mujoco.attributes import KINDS, ON_BODIES, NameTable, names
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.varying import Differences, arrays, flat
from mjcompose.pipeline.cache.builder import BuildResult, Maker
from mjcompose.sources.context import Context
from mjcompose.text.expression import Value
from mjcompose.tools.worlds.load import Loaded, load, load_many
from mjcompose.tools.worlds.names import failure
from mjcompose.tools.worlds.same_tree import APART_OR_UNION, CODE, check_same_tree, structure_of
from mjcompose.tools.worlds.worlds import Table, Varying, Worlds, model_sha256, read

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mjcompose.mujoco.model_types import MjModel

_HFIELD = 1
_MESH = 7
_NOT_UNITED = ("flex", "skin", "plugin")


class UnsharedBody(Struct):
    """A body with everything on it that not all models have: its parent, and its contents."""

    parent: str
    body: str
    shape: Hashable


class Tree(Struct, frozen=False):
    """A model as named bodies; `own` has the elements on each body, and `children` has its child bodies."""

    model: MjModel
    name: str
    table: NameTable = field(init=False)
    own: dict[str, Hashable] = field(init=False, default_factory=dict)
    children: dict[str, list[str]] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.table = NameTable(self.model)
        for kind in _NOT_UNITED:
            if self.table.count(kind):
                message = f"`{self.name}` has the {kind} `{self.table.describe(kind, 0)}`, which no union supports"
                raise failure(CODE, message, "build these cells separately with `--pick`")
        bodies = self.table.names["body"]
        if "" in bodies:
            help = "give it a name in its source"
            raise failure(CODE, f"`{self.name}` has a body without a name, which a union cannot tell from others", help)
        for number, name in enumerate(bodies):
            on = {kind: np.flatnonzero(getattr(self.model, of) == number).tolist() for kind, of in ON_BODIES.items()}
            self.own[name] = tuple((kind, *self._about(kind, each)) for kind, found in on.items() for each in found)
            self.children[name] = []
            if number:
                self.children[bodies[self.model.body_parentid[number]]].append(name)

    def _about(self, kind: str, each: int) -> tuple[Hashable, ...]:
        model = self.model
        name = self.table.names[kind][each]
        if kind == "joint":
            return name, int(model.jnt_type[each])
        if kind == "geom":
            mesh = int(model.geom_dataid[each])
            shape = int(model.geom_type[each])
            material = int(model.geom_matid[each])
            looks = self.table.names["material"][material] if material >= 0 else ""
            return name, shape, looks, self._surface(shape, mesh) if mesh >= 0 else ""
        if kind == "camera":
            return name, int(model.cam_mode[each]), int(model.cam_targetbodyid[each]) >= 0
        return (name,)

    def _surface(self, shape: int, asset: int) -> str:
        """Return the hash of a height field, or of a mesh that is not only fitted by another shape."""
        if shape == _HFIELD:
            numbers = numbers_of(self.model, "hfield", "hfield_data", asset)
        elif shape == _MESH:
            numbers = numbers_of(self.model, "mesh", "mesh_vert", asset)
        else:
            return ""
        return sha256(numbers.tobytes()).hexdigest()

    def shape(self, body: str) -> Hashable:
        return body, self.own[body], tuple(self.shape(each) for each in self.children[body])

    def below(self, body: str) -> Iterator[str]:
        yield body
        for each in self.children[body]:
            yield from self.below(each)


def common(trees: Sequence[Tree]) -> set[str]:
    """Return the bodies that all models have, with the same elements and the same parent, down from the world.

    Raises LoadError if only some models have a certain element, other than a body, on the world.
    """
    first, *others = trees
    for each in others:
        if each.own["world"] != first.own["world"]:
            ours = set(first.own["world"])  # type: ignore[call-overload]
            theirs = set(each.own["world"])  # type: ignore[call-overload]
            kind, name, *_ = min(ours ^ theirs, key=str)
            message = f"only one of `{each.name}` and `{first.name}` has the {kind} `{name}` on the world"
            raise failure(CODE, message, "put it into a body of its own: a union consists of whole bodies")
    found: set[str] = set()
    waiting = ["world"]
    while waiting:
        body = waiting.pop()
        found.add(body)
        for child in first.children[body]:
            if all(child in each.children[body] and each.own[child] == first.own[child] for each in others):
                waiting.append(child)
    return found


def parts(tree: Tree, shared: set[str]) -> list[UnsharedBody]:
    pairs = ((parent, child) for parent, children in tree.children.items() if parent in shared for child in children)
    return [UnsharedBody(parent, child, tree.shape(child)) for parent, child in pairs if child not in shared]


def gather(path: str | PathLike[str], where: str | None = None) -> Worlds:
    """Load the models that `mjcompose build --all` wrote to a folder as worlds of one model.

        study = worlds.gather("build/study", where="payload > 0")
        study.save("study.npz")     # worlds.load("build/study/first.zip", "study.npz") needs no other model

    `where` is as in `mjcompose.load_many`. The models must have the same elements with the same names; numbers of
    mjModel and options may differ. World `n` is the n-th of these models. Raises LoadError.
    """
    every = list(load_many(path, where))
    if not every:
        raise failure("unknown-name", f"no model in `{path}` matches", "choose others with `where`")
    joining = Joining(len(every))
    for each in every:
        cell = {"name": each.values.get("cell", each.name)}
        sample = int(str(each.values.get("sample", 0)))
        joining.add(Joined(each.load(), each.name, cell, sample=sample))
    return joining.worlds()


_SHOWN = 4


class Joined(NamedTuple):
    """One model that becomes one world, or several if it has a table; its name, its cell and its sample."""

    loaded: Loaded
    name: str
    cell: Mapping[str, Value | None]
    sample: int
    table: Table | None = None
    folder: Path | None = None
    weight: float = 1.0


class WorldGroup(Struct, frozen=False):
    """Models that differ from the `first` one only in numbers."""

    first: Joined
    differences: Differences
    worlds: list[int] = field(default_factory=list)

    def take(self, each: Joined, first: int, count: int) -> None:
        """Add a model as `count` worlds from the `first`."""
        taken = len(self.worlds)
        self.differences.extend(taken + count)
        self.differences.take(taken, each.loaded.model, count)
        if each.table is not None:
            for name, own in each.table.arrays.items():
                self.differences.take_numbers(taken, name, own.index, values=own.values)
        self.worlds += range(first, first + count)

    def varying(self) -> Iterator[tuple[str, Varying]]:
        """Yield the numbers that differ, by array."""
        for name, index, values in self.differences.found():
            # Arrays of names have positions in a text that begins with the model's name.
            if not name.startswith("name") and name not in with_trait("path"):
                yield name, Varying(index, values[: len(self.worlds)])


class Joining(Struct, frozen=False):
    """Joins models one by one, `expected` or more.

    If it `groups_cells`, models with other geoms or assets are groups of their own, and if it `unites` them, models
    with other trees too. Otherwise each model must have the elements of the first.
    """

    expected: int
    groups_cells: bool = False
    unites: bool = False
    groups: list[WorldGroup] = field(default_factory=list)
    _structures: dict[str, WorldGroup] = field(default_factory=dict)
    _cells: list[Mapping[str, Value | None]] = field(default_factory=list)
    _weights: list[float] = field(default_factory=list)
    _cell: list[int] = field(default_factory=list)
    _sample: list[int] = field(default_factory=list)

    def add(self, each: Joined) -> bool:
        """Add a model; return whether it must be kept. Raises LoadError if it is a different model."""
        structure = structure_of(each.loaded.model) if self.groups_cells else ""
        group = self._structures.get(structure)
        is_new = group is None
        if group is None:
            self._check_tree(each)
            expected = self.expected if not self.groups else 1
            group = WorldGroup(each, Differences(each.loaded.model, expected))
            self.groups.append(group)
            self._structures[structure] = group
        elif not self.groups_cells:
            self._check_elements(each)
        if each.cell not in self._cells:
            self._cells.append(each.cell)
            self._weights.append(each.weight)
        count = 1 if each.table is None else each.table.count
        group.take(each, len(self._cell), count)
        self._cell += [self._cells.index(each.cell)] * count
        self._sample += [each.sample] if each.table is None else each.table.sample.tolist()
        return is_new

    def _check_tree(self, each: Joined) -> None:
        if self.groups and not self.unites:
            first = self.groups[0].first
            check_same_tree(first.loaded.model, each.loaded.model, (first.name, each.name))

    def _check_elements(self, each: Joined) -> None:
        first = self.groups[0].first
        reasons = unlike(first.loaded.model, each.loaded.model)
        if reasons is not None:
            message = f"`{each.name}` cannot be a world of `{first.name}`: it is another model"
            raise failure(CODE, message, APART_OR_UNION, notes=reasons)

    def worlds(self) -> Worlds:
        """Return the worlds of the only group."""
        (group,) = self.groups
        loaded = group.first.loaded
        order = np.argsort(group.worlds)
        varying = {name: Varying(own.index, own.values[order]) for name, own in group.varying()}
        return Worlds(loaded.model, loaded.manifest, loaded.index, table=self.table(loaded, varying))

    def with_groups(self, groups: Sequence[WorldGroup]) -> Joining:
        """Return the same models in other groups."""
        return replace(self, groups=list(groups))

    def presence(self, present: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the geoms of a joint model that each cell has, from those of each group."""
        rows = np.zeros((len(self._cells), present.shape[1]), bool)
        for group, own in zip(self.groups, present, strict=True):
            rows[[self._cell[world] for world in group.worlds]] = own
        return rows

    def table(self, loaded: Loaded, varying: Mapping[str, Varying]) -> Table:
        """Return a table of the differences from a model."""
        first = self.groups[0].first
        seed = first.loaded.manifest.seed if first.table is None else first.table.seed
        return Table(
            varying,
            len(self._cell),
            seed,
            cells=tuple(self._cells),
            weights=np.array(self._weights),
            cell=np.array(self._cell, np.int64),
            sample=np.array(self._sample, np.int64),
            model=model_sha256(loaded.manifest),
            mujoco=loaded.manifest.mujoco,
        )


def unlike(first: MjModel, other: MjModel) -> list[str] | None:
    """Return the reason that a model is a different one, or None if only numbers differ."""
    why = []
    for kind in KINDS:
        here = names(first, kind)
        there = names(other, kind)
        if here == there:
            continue
        known = set(here)
        found = set(there)
        why += [f"it has the {kind} `{name}`" for name in there if name not in known][:_SHOWN]
        why += [f"it lacks the {kind} `{name}`" for name in here if name not in found][:_SHOWN]
        if known == found:
            why.append(f"it has {len(there)} {kind}s in another order or number")
    if why:
        return why[: 2 * _SHOWN]
    for size in SIZES:
        if getattr(first, size) != getattr(other, size):
            return [f"`{size}` is {getattr(other, size)}, not {getattr(first, size)}"]
    for name in arrays(first):
        now = flat(other, name).size
        before = flat(first, name).size
        if now != before:
            return [f"the array `{name}` has {now} numbers, not {before}"]
    return None


class Shelf(Struct):
    """A folder for built models until they are converted. Can be pickled."""

    folder: Path

    def place(self, name: str, mujoco: str | None) -> Path:
        """Return the folder of a model, for `Maker`."""
        return self.folder / name.replace("/", "_")

    def put(self, result: BuildResult, maker: Maker, context: Context, session: Session | None) -> BuildResult | None:
        """Write a model, for `CellMaker`."""
        bundle = result.bundle
        assert isinstance(bundle, Bundle)
        write_folder(bundle, self.place(result.name, result.mujoco))
        return result

    def take(self, result: BuildResult, cell: Cell) -> Joined:
        """Load a model, with its worlds if it has some. Raises LoadError."""
        folder = self.place(result.name, result.mujoco)
        loaded = load(folder)
        table = None
        if os.path.exists(folder / WORLDS):
            table = read(read_regular(folder / WORLDS))
        named = {"name": cell.cell or loaded.manifest.name}
        values = {**named, **cell.values()}
        return Joined(loaded, result.name, values, cell.sample, table=table, folder=folder, weight=cell.weight)

    def read(self, each: Joined) -> Bundle:
        """Return the bundle of a model."""
        assert each.folder is not None
        return read_bundle(each.folder)

    def clear(self, each: Joined) -> None:
        assert each.folder is not None
        shutil.rmtree(each.folder, ignore_errors=True)

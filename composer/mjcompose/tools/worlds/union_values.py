"""The numbers of a union in a world: the numbers of the world's model, and values that deactivate absent parts.

A part that a world does not have stays in the tree. Its bodies have no mass and its joints an armature of 1, so it
exerts no force on its parent, and its own motion moves nothing else; its actuators give no force. A contact margin far
below zero keeps its geoms from touching anything, because margins are summed. MuJoCo, MuJoCo Warp and MJX have margins
for each world, while the latter two share `contype`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from mjcompose.mujoco.addresses import VECTORS
from mjcompose.mujoco.arrays import Treatment, about
from mjcompose.mujoco.attributes import KINDS, Model, NameTable
from mjcompose.mujoco.references import links
from mjcompose.mujoco.varying import Rows, owners, rows_of_size
from mjcompose.tools.worlds.join import CODE
from mjcompose.tools.worlds.names import failure

Label = Callable[[str, int], str]
"""Returns an element's name by kind and number."""
References = Iterator[tuple[str, int]]
"""The kind and number of each element."""

ACTING = ("actuator", "tendon", "equality", "pair", "exclude", "sensor")
"""Kinds of elements that act on their references."""
_TRANSMISSIONS = range(6)
_ALONE = "build these cells separately with `--pick`"
_OTHER_LINKS = ("tendon_matid", "tendon_actuatorid")


def references(model: Model, kind: str, number: int) -> References:
    """Return kind and number of each element that one acts on. Raises LoadError for an unknown transmission."""
    if kind == "actuator" and (transmission := int(model.actuator_trntype[number])) not in _TRANSMISSIONS:
        message = f"an actuator with a transmission of type {transmission} cannot be in a union"
        raise failure(CODE, message, _ALONE)
    for link in links(model, kind, number) if kind in ACTING else ():
        if link.index >= 0 and link.kind != "plugin" and link.field not in _OTHER_LINKS:
            yield link.kind, link.index


def words(model: Model, kind: str, number: int, label: Label) -> str:
    """Return an element's type and references: `equality 1 body a body b`."""
    of_type = {"actuator": "actuator_trntype", "equality": "eq_type", "sensor": "sensor_type"}.get(kind)
    head = f"{kind} {int(getattr(model, of_type)[number])}" if of_type else kind
    return " ".join([head, *(f"{of} {label(of, each)}" for of, each in references(model, kind, number))])


def referring_bodies(model: Model, kind: str, number: int) -> Iterator[int]:
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
_APART = -1e4
_TREE = ("body", "joint", "geom", "site", "camera", "light")
_NEEDED = (*_TREE, *ACTING, "numeric", "tuple", "material", "key")
_NOT_NUMBERS = {Treatment.SKIPPED, Treatment.PRESENT, Treatment.LINKED, Treatment.SUBTREE, Treatment.DERIVED}


class Mapped:
    """Maps the numbers of a model to a union; `prefix_of` has the prefix of each body of its parts."""

    def __init__(self, union: Model, model: Model, name: str, prefix_of: Mapping[str, str]) -> None:
        self.union, self.model = union, model
        self.name, self.prefix_of = name, prefix_of
        self.theirs, self.ours = NameTable(model), NameTable(union)
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
        """Check that nothing acts in the union that the model lacks, except on absent parts. Raises LoadError."""
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
        if name := self.theirs.names[kind][number]:
            return [prefix + name for prefix in dict.fromkeys(["", *self.prefix_of.values()])
                    if kind not in ACTING or self._acts_alike(kind, number, prefix + name)]  # fmt: skip
        if kind in ACTING:
            return [words(self.model, kind, number, label=self._there)]
        return [self.theirs.describe(kind, number)]

    def _acts_alike(self, kind: str, number: int, name: str) -> bool:
        """Return whether the union's element with this name has the same references as the model's element."""
        at, theirs = self.ours.ids[kind].get(name), words(self.model, kind, number, label=self._there)
        return at is not None and words(self.union, kind, at, label=self.ours.describe) == theirs

    def _there(self, kind: str, number: int) -> str:
        if kind not in _TREE:
            at = self.places[kind][number]
            return self.ours.describe(kind, at[0]) if at else ""
        table = self.theirs
        body = number if kind == "body" else int(getattr(self.model, f"{KINDS[kind].arrays}_bodyid")[number])
        prefix = self.prefix_of.get(table.names["body"][body], "")
        if name := table.names[kind][number]:
            return prefix + name
        return table.describe(kind, number).replace("of body `", f"of body `{prefix}")

    def pairs(self, array: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the flat indices of an array's numbers in the union, and in the model."""
        if array not in self._pairs:
            (kind, rows), (_, others) = owners(self.union, array), owners(self.model, array)
            to, of = self._matched(kind, rows, others)
            shapes = (np.shape(getattr(each, array)) for each in (self.union, self.model))
            width, other = (int(np.prod(shape[1:], dtype=int)) for shape in shapes)
            columns = np.arange(min(width, other))
            self._pairs[array] = (to[:, None] * width + columns).ravel(), (of[:, None] * other + columns).ravel()
        return self._pairs[array]

    def put_keys(self, made: Model, model: Model) -> None:
        """Write the keys of a model into the union's keys of the same name. Raises LoadError for others."""
        for number, places in enumerate(self.places["key"]):
            for array, (kind, size) in _KEYS.items():
                mine, other = getattr(self.union, size), getattr(self.model, size)
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


def numbers(model: Model) -> Iterator[str]:
    """Yield the arrays with properties of elements, as opposed to addresses and references."""
    for name in dir(model):
        array = getattr(model, name) if not name.startswith("_") else None
        if not isinstance(array, np.ndarray) or not array.ndim or name.startswith(("name", "key_", "tex_", "mesh_")):
            continue
        if about(name).treatment not in _NOT_NUMBERS:
            yield name


def derived(model: Model) -> Iterator[str]:
    """Yield the arrays that mj_setConst computes, except `dof_length`, which for sleep depends on all children."""
    for name in dir(model):
        if about(name).treatment in (Treatment.SUBTREE, Treatment.DERIVED) and name != "dof_length":
            yield name


def silenced(union: Model, bodies: Iterable[str]) -> list[tuple[str, np.ndarray, Any]]:
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
    found: list[tuple[str, np.ndarray, Any]] = [
        ("body_mass", at, 0.0), ("body_inertia", _all(union.body_inertia, at), 0.0),
        ("dof_armature", dofs, 1.0), ("dof_damping", dofs, 0.0), ("dof_frictionloss", dofs, 0.0),
        ("jnt_stiffness", joints, 0.0), ("geom_margin", geoms, _APART), ("geom_gap", geoms, 0.0),
        ("tendon_stiffness", tendons, 0.0), ("tendon_damping", tendons, 0.0), ("tendon_frictionloss", tendons, 0.0),
        ("tendon_armature", tendons, 0.0),
    ]  # fmt: skip
    for name, rows in (("dof_dampingpoly", dofs), ("jnt_stiffnesspoly", joints), ("tendon_dampingpoly", tendons),
                       ("tendon_stiffnesspoly", tendons)):  # fmt: skip
        if hasattr(union, name):
            found.append((name, _all(getattr(union, name), rows), 0.0))
    pairs = np.flatnonzero(np.isin(union.pair_geom1, geoms) | np.isin(union.pair_geom2, geoms))
    found += [("pair_margin", pairs, _APART), ("pair_gap", pairs, 0.0)]
    found += [(name, _all(getattr(union, name), acting), 0.0) for name in ("actuator_gainprm", "actuator_biasprm")]
    return [each for each in found if each[1].size]


def _all(array: np.ndarray, rows: np.ndarray) -> np.ndarray:
    width = int(np.prod(array.shape[1:], dtype=int))
    return (rows[:, None] * width + np.arange(width)).ravel()

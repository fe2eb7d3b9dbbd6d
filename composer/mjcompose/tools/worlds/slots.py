"""The places for geoms in a joint model: in each body, all geoms of each cell in their order."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from mjcompose.base.dataclass import Struct

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

GeomKey: TypeAlias = Hashable

_SHARED = ("type", "contype", "conaffinity", "condim", "priority", "group", "plugin")
"""Properties of geoms that MuJoCo Warp has once for all worlds."""


def shared_of(model: MjModel, geom: int) -> GeomKey:
    """Return the properties of a geom that another one must have, too, to share its slot."""
    return tuple(int(getattr(model, f"geom_{name}")[geom]) for name in _SHARED)


class GeomSlot(Struct, frozen=False):
    """A geom of a joint model: `geoms` has the number of the geom that is there, by cell; it is absent in others."""

    key: GeomKey
    name: str
    geoms: dict[int, int] = field(default_factory=dict)


class OwnGeom(Struct):
    """A geom of a cell."""

    key: GeomKey
    name: str
    number: int


def slots_of_bodies(models: Sequence[MjModel], key: Callable[[MjModel, int], GeomKey]) -> list[list[GeomSlot]]:
    """Return the slots of each body, in order."""
    bodies = []
    for body in range(models[0].nbody):
        slots: list[GeomSlot] = []
        for cell, model in enumerate(models):
            first = int(model.body_geomadr[body])
            numbers = range(first, first + int(model.body_geomnum[body]))
            geoms = [OwnGeom(key(model, number), model.geom(number).name, number) for number in numbers]
            slots = with_geoms(slots, geoms, cell)
        bodies.append(slots)
    return bodies


def with_geoms(slots: list[GeomSlot], geoms: Sequence[OwnGeom], cell: int) -> list[GeomSlot]:
    """Return a shortest common supersequence of slots and the geoms of one more cell.

    So geoms keep their order, and MuJoCo finds contacts in the order of the cell: with another order, the last bits of
    its sums differ.
    """
    if [slot.key for slot in slots] == [geom.key for geom in geoms]:
        for slot, geom in zip(slots, geoms, strict=True):
            slot.geoms[cell] = geom.number
        return slots
    worth = _worth(slots, geoms)
    merged = []
    old = new = 0
    while old < len(slots) or new < len(geoms):
        gain = _gain(slots[old], geoms[new]) if old < len(slots) and new < len(geoms) else 0
        if gain and worth[old, new] == gain + worth[old + 1, new + 1]:
            slots[old].geoms[cell] = geoms[new].number
            merged.append(slots[old])
            old += 1
            new += 1
        elif old < len(slots) and (new == len(geoms) or worth[old + 1, new] >= worth[old, new + 1]):
            merged.append(slots[old])
            old += 1
        else:
            merged.append(GeomSlot(geoms[new].key, geoms[new].name, {cell: geoms[new].number}))
            new += 1
    return merged


_ALIKE = 10
"""The gain of a slot for two geoms; equal names win ties."""


def _gain(slot: GeomSlot, geom: OwnGeom) -> int:
    return 0 if slot.key != geom.key else _ALIKE + (slot.name == geom.name != "")


def _worth(slots: Sequence[GeomSlot], geoms: Sequence[OwnGeom]) -> np.ndarray:
    """Return the largest sum of gains from each pair of places on."""
    worth = np.zeros((len(slots) + 1, len(geoms) + 1), int)
    for old in reversed(range(len(slots))):
        for new in reversed(range(len(geoms))):
            gain = _gain(slots[old], geoms[new])
            both = gain + worth[old + 1, new + 1] if gain else 0
            worth[old, new] = max(worth[old + 1, new], worth[old, new + 1], both)
    return worth

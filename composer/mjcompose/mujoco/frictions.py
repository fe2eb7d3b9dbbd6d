"""Contacts of a compiled model, and the frictions that they use. Imports no MuJoCo.

MuJoCo 4.0 uses the parameters of the geom with the higher `priority`; if the priorities are equal, the larger friction
and the larger `condim`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.attributes import names

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

LEAST_CONDIM = (1, 4, 6)
"""By number of `friction`: the least `condim` of a contact that uses it."""


def thresholds(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> list[list[list[dict[str, Any]]]]:
    """Return for each geom of each entry the thresholds by partner. Runs under `mjcompose.mujoco.engine.call`.

    `asked` has the `entries`, each geom with its `place` and the `number` of its friction, and the places of all geoms
    whose friction is `drawn`.
    """
    collisions = _Collisions(mujoco, model)
    drawn = {_id(mujoco, model, place) for place in asked["drawn"]}
    return [[list(_of_geom(mujoco, model, collisions, each, drawn)) for each in entry] for entry in asked["entries"]]


def _of_geom(
    mujoco: Any, model: MjModel, collisions: _Collisions, asked: Mapping[str, Any], drawn: set[int | None]
) -> Iterator[dict[str, Any]]:
    geom = _id(mujoco, model, asked["place"])
    if geom is None:
        return
    number = asked["number"]
    called = names(model, "geom")
    for other in collisions.partners(geom):
        if other in drawn:
            continue  # the friction of both is drawn
        mine = int(model.geom_priority[geom])
        theirs = int(model.geom_priority[other])
        condim = [int(model.geom_condim[each]) for each in (geom, other)]
        used = max(condim) if mine == theirs else condim[0] if mine > theirs else condim[1]
        least = float(model.geom_friction[other, number])
        if mine != theirs:
            least = -math.inf if mine > theirs else math.inf
        needs = used < LEAST_CONDIM[number]
        yield {
            "partner": f"`{called[other]}`" if called[other] else f"a geom of `{_body(model, other)}`",
            "least": math.inf if needs else least,
            "priority": theirs,
            "needs_condim": needs,
        }


def _id(mujoco: Any, model: MjModel, place: Sequence[Any]) -> int | None:
    """Return the number of a geom by its name, or by its body and its number there; None if it cannot be found."""
    name, body, number = place
    if name:
        found = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, name))
        return found if found >= 0 else None
    holder = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body)) if body else -1
    if holder < 0 or number >= int(model.body_geomnum[holder]):
        return None
    return int(model.body_geomadr[holder]) + int(number)


def _body(model: MjModel, geom: int) -> str:
    return names(model, "body")[int(model.geom_bodyid[geom])] or "a body without a name"


class _Collisions:
    """The pairs of geoms that MuJoCo may put into contact, without explicit pairs, whose friction is their own."""

    def __init__(self, mujoco: Any, model: MjModel) -> None:
        self.model = model
        self.weld = np.asarray(model.body_weldid)[model.geom_bodyid]
        parents = np.asarray(model.body_parentid)
        self.above = np.asarray(model.body_weldid)[parents[self.weld]]
        self.filters = not int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
        self.flat = {int(mujoco.mjtGeom.mjGEOM_PLANE), int(mujoco.mjtGeom.mjGEOM_HFIELD)}
        self.excluded = {int(each) for each in model.exclude_signature}
        self.paired = set(zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True))

    def partners(self, geom: int) -> list[int]:
        model = self.model
        bits = (model.geom_contype & model.geom_conaffinity[geom]) | (model.geom_contype[geom] & model.geom_conaffinity)
        may = (bits != 0) & (self.weld != self.weld[geom])
        if self.filters:
            is_family = (self.weld == self.above[geom]) | (self.above == self.weld[geom])
            may &= ~(is_family & (self.weld != 0) & (self.weld[geom] != 0))
        return [int(each) for each in np.flatnonzero(may) if self._touches(geom, int(each))]

    def _touches(self, geom: int, other: int) -> bool:
        model = self.model
        first, second = sorted((int(model.geom_bodyid[geom]), int(model.geom_bodyid[other])))
        if (first << 16) + second in self.excluded or {(geom, other), (other, geom)} & self.paired:
            return False
        return not {int(model.geom_type[geom]), int(model.geom_type[other])} <= self.flat

"""The check `clearance`: geoms are not inside each other, or keep a distance."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.report import with_rest
from mjcompose.language.checks.clearance import Clearance
from mjcompose.verify.checks.check import SOLVED, Scope, at_keys, beside, check_globs, failed, keys_named

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData

_NAMED = ("geom", "body", "flex")
_SLACK = 1e-9

Side = tuple[str, int]
"""A geom or flex by kind and id."""
Pair = tuple[Side, Side]


def check(scope: Scope, clearance: Clearance) -> list[Fault]:
    """Report the pairs that are nearer to each other than the check allows, the nearest first."""
    least = clearance.min
    ignored = _ignored(scope, clearance.excepted)
    sides = _sides(scope, clearance.between or ())
    near: dict[tuple[str, Pair], float] = {}
    nearest: float | None = None
    for where, data in _places(scope, clearance.key):
        distances = _apart(scope, data, sides, least) if sides else _touching(scope, data, least)
        for pair, distance in distances:
            if distance >= least and nearest is not None and distance >= nearest:
                continue
            if _is_ignored(scope, pair, ignored):
                continue
            nearest = distance if nearest is None else min(nearest, distance)
            if distance < least:
                near[where, pair] = min(distance, near.get((where, pair), distance))
    if nearest is not None:
        scope.found("distance", nearest, SOLVED)
    return [_fault(scope, near, least)] if near else []


def _ignored(scope: Scope, pairs: Sequence[Sequence[str]]) -> list[list[frozenset[str]]]:
    """Return the names that the globs of each pair match. Raises CheckEnds for a glob that matches nothing."""
    for index, pair in enumerate(pairs):
        for side, glob in enumerate(pair):
            check_globs(scope, _NAMED, [glob], at=("except", index, side))
    known = {name for kind in _NAMED for name in scope.names(kind)}
    return [[scope.fitting(glob, known) for glob in pair] for pair in pairs]


def _is_ignored(scope: Scope, pair: Pair, ignored: Iterable[Sequence[frozenset[str]]]) -> bool:
    one, other = (_names(scope, side) for side in pair)
    return any((one & first and other & second) or (one & second and other & first) for first, second in ignored)


def _sides(scope: Scope, sides: Sequence[Sequence[str]]) -> list[list[int]]:
    """Return the geoms of each side. Raises CheckEnds for a glob that matches nothing."""
    geoms = []
    for index, globs in enumerate(sides):
        check_globs(scope, _NAMED[:2], globs, at=("between", index))
        geoms.append(_geoms(scope, globs))
    return geoms


def _places(scope: Scope, keys: Sequence[str]) -> Iterable[tuple[str, Any]]:
    """Return the configurations to check, each with words for its keyframe."""
    if not keys:
        return [("", scope.at_key(None))]
    return ((f" in `{name}`", data) for name, data in at_keys(scope, keys_named(scope, keys)))


def _fault(scope: Scope, near: Mapping[tuple[str, Pair], float], least: float) -> Fault:
    """Return the fault of the pairs that are nearer than `least`."""
    ranked = sorted(near.items(), key=lambda item: item[1])
    lines = [_line(scope, pair, where, distance, least) for (where, pair), distance in ranked]
    first, *more = with_rest(lines, what="more pairs")
    expected = f"at least {least:g} m" if least >= 0 else f"at most {-least:g} m inside"
    return failed(first, expected, _measure(ranked[0][1], least), "min", more=more)


def _measure(distance: float, least: float) -> str:
    return f"{beside(distance, least)} m" if distance >= 0 else f"{beside(-distance, -least)} m inside"


def _line(scope: Scope, pair: Pair, where: str, distance: float, least: float) -> str:
    """Return in words the distance between the elements of a pair."""
    one, other = (scope.called(*side) for side in pair)
    if distance < 0:
        return f"{one} is {_measure(distance, least)} of {other}{where}"
    return f"{one} and {other}{where} are {_measure(distance, least)} apart"


def _touching(scope: Scope, data: MjData, least: float) -> Iterator[tuple[Pair, float]]:
    """Yield the pairs nearer than `least`, or touching, even if options of the model disable contacts."""
    mujoco = scope.mujoco
    option = scope.model.opt
    before = int(option.disableflags), int(option.enableflags), float(option.o_margin)
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    option.disableflags = before[0] & ~off
    if least > 0:  # MuJoCo looks for contacts as far away as the margin
        option.enableflags = before[1] | int(mujoco.mjtEnableBit.mjENBL_OVERRIDE)
        option.o_margin = least + _SLACK
    try:
        mujoco.mj_fwdPosition(scope.model, data)
    finally:
        option.disableflags, option.enableflags, option.o_margin = before
    for contact in data.contact:
        pair = (_side(contact, 0), _side(contact, 1))
        if all(scope.owns(*side) for side in pair):
            yield pair, float(contact.dist)


def _side(contact: Any, side: int) -> Side:
    geom = int(contact.geom[side])
    return ("geom", geom) if geom >= 0 else ("flex", int(contact.flex[side]))


def _geoms(scope: Scope, globs: Sequence[str]) -> list[int]:
    """Return the geoms that the globs match, and the geoms of the bodies that they match."""
    geoms: dict[int, None] = {}
    for glob in globs:
        bodies = set(scope.matching("body", glob))
        of_bodies = [geom for geom in scope.own("geom") if int(scope.model.geom_bodyid[geom]) in bodies]
        geoms.update(dict.fromkeys([*scope.matching("geom", glob), *of_bodies]))
    return list(geoms)


def _apart(scope: Scope, data: MjData, sides: Sequence[Sequence[int]], least: float) -> Iterator[tuple[Pair, float]]:
    """Yield the pairs of geoms of the two sides that are on different bodies, with their distance up to `least`."""
    import numpy as np

    mujoco = scope.mujoco
    model = scope.model
    mujoco.mj_kinematics(model, data)
    reach = max(least, 0.0)
    others = np.array(sides[1], dtype=int)
    places = data.geom_xpos[others]
    radii = model.geom_rbound[others]
    bodies = model.geom_bodyid[others]
    for one in sides[0]:
        # Bounding spheres that are apart need no look by MuJoCo. A plane has none.
        apart = np.linalg.norm(places - data.geom_xpos[one], axis=1)
        own = model.geom_rbound[one]
        is_near = (apart - (own + radii) < reach) | (radii == 0) | (own == 0)
        for other in others[is_near & (bodies != model.geom_bodyid[one])].tolist():
            distance = float(mujoco.mj_geomDistance(model, data, one, other, reach + _SLACK, None))
            yield (("geom", one), ("geom", other)), distance


def _names(scope: Scope, side: Side) -> set[str]:
    """Return the names that a glob for a side can match: the geom's own name and its body's."""
    kind, index = side
    body = scope.roster.names["body"][int(scope.model.geom_bodyid[index])] if kind == "geom" else ""
    return {name.removeprefix(scope.prefix) for name in (scope.roster.names[kind][index], body) if name}

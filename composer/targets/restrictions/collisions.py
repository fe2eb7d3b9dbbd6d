"""Limit of MJX: pairs of shapes for which it cannot compute contacts."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from typing import Any

from composer.compiled.enums import words
from composer.targets.limit import Outcome
from composer.targets.restrictions.compiled import refused_elements

# From `_COLLISION_FUNC` of MJX 3.17.
_KNOWN = frozenset(
    tuple(pair.split("-"))
    for pair in (
        "plane-sphere plane-capsule plane-box plane-ellipsoid plane-cylinder plane-mesh hfield-sphere hfield-capsule"
        " hfield-box hfield-mesh sphere-sphere sphere-capsule sphere-cylinder sphere-ellipsoid sphere-box sphere-mesh"
        " capsule-capsule capsule-box capsule-ellipsoid capsule-cylinder capsule-mesh ellipsoid-ellipsoid"
        " ellipsoid-cylinder cylinder-cylinder box-box box-mesh mesh-mesh"
    ).split()
)


def _unknown_pairs(mujoco: Any, model: Any) -> Iterator[tuple[int, str]]:
    shapes = words(mujoco, "geom_type")
    told = set()
    pairs = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
    for first, second in chain(colliding(model), pairs):
        pair = sorted((first, second), key=lambda number: int(model.geom_type[number]))
        one, other = (shapes[int(model.geom_type[number])] for number in pair)
        if (one, other) not in _KNOWN and (pair[0], one, other) not in told:
            told.add((pair[0], one, other))
            yield pair[0], f"MJX cannot compute contacts of a {one} with a {other}"


def colliding(model: Any) -> Iterator[tuple[int, int]]:
    """Yield the pairs of geoms that may touch by MuJoCo's filters: bits, bodies, parents and excludes."""
    excluded = set(model.exclude_signature.tolist())
    welded, parents = model.body_weldid.tolist(), model.body_parentid.tolist()
    bodies, bits = model.geom_bodyid.tolist(), model.geom_contype.tolist()
    others = model.geom_conaffinity.tolist()
    for first in range(model.ngeom):
        for second in range(first + 1, model.ngeom):
            if not (bits[first] & others[second] or bits[second] & others[first]):
                continue
            one, other = bodies[first], bodies[second]
            roots = welded[one], welded[other]
            if roots[0] == roots[1] or (min(one, other) << 16) + max(one, other) in excluded:
                continue
            above = welded[parents[roots[0]]], welded[parents[roots[1]]]
            if all(roots) and (roots[0] == above[1] or roots[1] == above[0]):
                continue
            yield first, second


MJX_COLLISIONS = refused_elements(
    "collisions", "geom", _unknown_pairs,
    help="edit one of the two: `set: {type: capsule}`, or `set: {contype: 0, conaffinity: 0}`", outcome=Outcome.REFUSED,
)  # fmt: skip

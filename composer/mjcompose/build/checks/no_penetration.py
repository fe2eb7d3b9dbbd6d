"""The check `no_penetration`: nothing is inside of anything else."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.build.checks.check import SOLVED, Scope, beside, failed

_NAMED = ("geom", "body", "flex")
_SHOWN = 8

Side = tuple[str, int]
"""A geom or flex by kind and id."""


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report the pairs that penetrate each other, the deepest first."""
    data = scope.at_key(asked["key"])
    if isinstance(data, Fault):
        return [data]
    _collide(scope, data)
    known = {name for kind in _NAMED for name in scope.names(kind)}
    excluded = [[scope.fitting(glob, known) for glob in pair] for pair in asked["exclude"]]
    unmet = [(at, side) for at, pair in enumerate(excluded) for side, names in enumerate(pair) if not names]
    if unmet:
        at, side = unmet[0]
        glob = asked["exclude"][at][side]
        notes = (exists_note("name", sorted(known), glob),)
        message = f"`{glob}` names no geom and no body"
        place = ("exclude", at, side)
        return [Fault("unknown-name", message, place, notes=notes, help=did_you_mean(glob, known))]
    deepest: dict[tuple[Side, Side], float] = {}
    most = 0.0
    for contact in data.contact:
        pair = (_side(contact, 0), _side(contact, 1))
        depth = -float(contact.dist)
        if depth <= most and depth <= asked["max"]:
            continue
        if not all(scope.owns(*side) for side in pair) or any(
            _excluded(scope, pair, one, other=other) for one, other in excluded
        ):
            continue
        most = max(most, depth)
        if depth > asked["max"]:
            deepest[pair] = max(depth, deepest.get(pair, 0.0))
    scope.found("depth", most, SOLVED)
    if not deepest:
        return []
    ranked = sorted(deepest.items(), key=lambda item: -item[1])
    depths = [f"{beside(depth, asked['max'])} m" for _, depth in ranked]
    described = [
        f"{scope.called(*one)} and {scope.called(*other)}: {depth}"
        for ((one, other), _), depth in zip(ranked, depths, strict=True)
    ]
    more = described[1:_SHOWN] + (
        [f"and {len(described) - _SHOWN} more pairs"] if len(described) > _SHOWN else []
    )
    pair, _ = ranked[0]
    message = f"{scope.called(*pair[0])} is {depths[0]} inside of {scope.called(*pair[1])}"
    return [failed(message, f"at most {asked['max']:g} m", depths[0], more=more)]


def _collide(scope: Scope, data: Any) -> None:
    """Find contacts even if the options of the model disable them."""
    mujoco, option = scope.mujoco, scope.model.opt
    flags = int(option.disableflags)
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    option.disableflags = flags & ~off
    try:
        mujoco.mj_fwdPosition(scope.model, data)
    finally:
        option.disableflags = flags


def _side(contact: Any, side: int) -> Side:
    geom = int(contact.geom[side])
    return ("geom", geom) if geom >= 0 else ("flex", int(contact.flex[side]))


def _excluded(scope: Scope, pair: tuple[Side, Side], one: frozenset[str], other: frozenset[str]) -> bool:
    first, second = (_names(scope, side) for side in pair)
    return bool((first & one and second & other) or (first & other and second & one))


def _names(scope: Scope, side: Side) -> set[str]:
    """Return the names by which a glob matches a side: its own and that of its body."""
    kind, index = side
    names = [scope.roster.names[kind][index]]
    if kind == "geom":
        names.append(scope.roster.names["body"][int(scope.model.geom_bodyid[index])])
    return {name.removeprefix(scope.prefix) for name in names if name}

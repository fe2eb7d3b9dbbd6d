"""Pairs of bodies that touch, and pairs that need not collide, in the child process that has MuJoCo."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import product
from typing import Any

import numpy as np

from mjcompose.mujoco.addresses import Run, counted

ADJACENT, TOUCHING, NEVER = "adjacent", "touching", "never"
_CLOSE = 1e-9
_NEAR, _FAR = 0.002, 10.0
"""Two bodies that come so near can touch: limits are soft, and a search takes steps."""
_STARTS, _ROUNDS, _STEPS = 3, 3, 7
_geoms, _joints = (Run(f"body_{of}adr", counted(f"body_{of}num")).rows for of in ("geom", "jnt"))

Pair = tuple[int, int]


def touching(mujoco: Any, model: Any, prefixes: list[str]) -> list[dict[str, Any]]:
    """Return the pairs of bodies of different parts that touch or overlap; runs under `mjcompose.mujoco.engine.call`.

    This checks the reference configuration and all keys. `prefixes` are the prefixes of the parts. Freely floating
    bodies are not checked, because they may lie on the other body. Each pair has the names of its `bodies` (empty for
    unnamed ones), their names for messages, and the place where they touch.
    """
    _let_collide(mujoco, model)
    explicit = {frozenset(map(int, pair)) for pair in zip(model.pair_geom1, model.pair_geom2, strict=True)}
    found: dict[Pair, dict[str, Any]] = {}
    for where, data in _keys(mujoco, model):
        for pair in _touched(mujoco, model, data, explicit=explicit):
            parts = {_part(model, body, prefixes) for body in pair}
            if len(parts) == 2 and pair not in found and not _floats(mujoco, model, pair):
                found[pair] = _in_words(model, pair) | {"where": where}
    return list(found.values())


def _part(model: Any, body: int, prefixes: list[str]) -> str:
    name = _named(model, body)
    return max((each for each in prefixes if name.startswith(each)), key=len, default="")


def _floats(mujoco: Any, model: Any, pair: Pair) -> bool:
    """Return whether only a free joint connects the two bodies."""
    roots = {int(model.body_rootid[body]) for body in pair}
    return len(roots) == 2 and any(_is_free(mujoco, model, root) for root in roots)


def _let_collide(mujoco: Any, model: Any) -> None:
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~off


def _keys(mujoco: Any, model: Any) -> Iterator[tuple[str, Any]]:
    for key in range(-1, model.nkey):
        data = mujoco.MjData(model)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        yield "the reference configuration" if key < 0 else f"the key `{model.key(key).name}`", data


def _in_words(model: Any, pair: Pair) -> dict[str, Any]:
    names = [model.body(body).name for body in pair]
    rows = zip(names, pair, strict=True)
    called = [f"`{name}`" if name else f"a body in `{_named(model, body)}`" for name, body in rows]
    return {"bodies": names, "called": called}


def _named(model: Any, body: int) -> str:
    return str(model.body(next((each for each in _chain(model, body) if model.body(each).name), 0)).name)


def needless(mujoco: Any, model: Any, asked: dict[str, int]) -> list[dict[str, Any]]:
    """Return the pairs of bodies that MuJoCo checks unnecessarily; runs under `mjcompose.mujoco.engine.call`.

    A joint connects the two (`adjacent`), they touch in the reference configuration or in a key (`touching`), or they
    touch in none of the `samples`, which a `seed` draws (`never`): every joint is drawn from its range, and equalities
    are ignored. Bodies of the world itself are excluded, and a body that can move away from the other one without a
    limit never has the reason `never`. Nor do two bodies that actuators move on separate branches, such as the jaws of
    a gripper, or bodies that a search brings together: samples miss the pose in which they close. Jaws that touch in a
    key are also excluded, unless they touch in every sample. Each pair has the names of its `bodies`, their names for
    messages, `why` and `where`.
    """
    _let_collide(mujoco, model)
    rest = set(_checked(mujoco, model))
    hung = (pair for pair in sorted(rest) if int(model.body_parentid[pair[1]]) == pair[0])
    found: dict[Pair, tuple[str, str]] = {pair: (ADJACENT, "") for pair in hung if not _is_free(mujoco, model, pair[1])}
    for where, data in _keys(mujoco, model):
        for pair in sorted(_touched(mujoco, model, data).keys() & rest):
            if _is_tied(mujoco, model, pair, sliding=True):
                found.setdefault(pair, (TOUCHING, where))
    moved = _moved(mujoco, model)
    jaws = {pair for pair in rest if _are_jaws(model, pair, moved)}
    closing = {pair for pair, (why, _) in found.items() if why == TOUCHING and pair in jaws}
    left = {pair for pair in rest - jaws if pair not in found and _is_tied(mujoco, model, pair, sliding=False)}
    for pose in _poses(mujoco, model, asked["samples"], seed=asked["seed"]) if left or closing else ():
        touched = _touched(mujoco, model, pose).keys()
        left -= touched
        for pair in closing - touched:
            del found[pair]
        closing &= touched
        if not (left or closing):
            break
    random = np.random.Generator(np.random.PCG64(asked["seed"]))
    found |= {pair: (NEVER, "") for pair in sorted(left) if _least(mujoco, model, pair, random=random) > _NEAR}
    return [_in_words(model, pair) | {"why": why, "where": where} for pair, (why, where) in sorted(found.items())]


def _checked(mujoco: Any, model: Any) -> Iterator[Pair]:
    """The pairs of bodies, without the world, whose geoms MuJoCo checks after the filters of `mj_collision`."""
    types = {
        body: [(int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])) for geom in _geoms(model, body)]
        for body in range(1, model.nbody)
        if model.body_geomnum[body]
    }
    excluded = {int(each) for each in model.exclude_signature}
    filters = not int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    welds = [int(each) for each in model.body_weldid]
    above = [welds[int(model.body_parentid[each])] for each in welds]
    for one, first in types.items():
        for other, second in types.items():
            # The signature has the first body in its upper 16 bits.
            if other <= one or (one << 16) + other in excluded or (other << 16) + one in excluded:
                continue
            if welds[one] == welds[other]:
                continue
            # MuJoCo never filters geoms that are welded to the world.
            if filters and welds[one] and welds[other] and (above[one] == welds[other] or above[other] == welds[one]):
                continue
            if any(a & d or c & b for a, b in first for c, d in second):
                yield one, other


def _touched(mujoco: Any, model: Any, data: Any, explicit: Collection[frozenset[int]] = ()) -> dict[Pair, None]:
    """Return the pairs of bodies that touch, except by two geoms that are an `explicit` pair."""
    mujoco.mj_fwdPosition(model, data)
    found: dict[Pair, None] = {}
    for contact in data.contact:
        geoms = frozenset(int(each) for each in contact.geom)
        if contact.dist <= _CLOSE and min(geoms) >= 0 and geoms not in explicit:
            one, other = sorted(int(model.geom_bodyid[each]) for each in contact.geom)
            found[one, other] = None
    return found


def _moved(mujoco: Any, model: Any) -> set[int]:
    """Return the joints that actuators move, themselves or through equalities."""
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    moved = {int(model.dof_jntid[dof]) for dof in data.moment_colind[: int(data.moment_rownnz.sum())]}
    coupled, kinds = [], mujoco.mjtEq
    for each in range(model.neq):
        one, other, kind = int(model.eq_obj1id[each]), int(model.eq_obj2id[each]), int(model.eq_type[each])
        if kind == int(kinds.mjEQ_JOINT) and other >= 0:
            coupled.append({one, other})
        elif kind == int(kinds.mjEQ_TENDON) and other >= 0:
            has = model if hasattr(model, "ten_J_rowadr") else data  # MuJoCo 3 has them in the data
            rows = [slice(has.ten_J_rowadr[n], has.ten_J_rowadr[n] + has.ten_J_rownnz[n]) for n in (one, other)]
            coupled.append({int(model.dof_jntid[dof]) for row in rows for dof in has.ten_J_colind.ravel()[row]})
        elif kind in (int(kinds.mjEQ_CONNECT), int(kinds.mjEQ_WELD)):
            if int(model.eq_objtype[each]) == int(mujoco.mjtObj.mjOBJ_SITE):
                one, other = (int(model.site_bodyid[site]) for site in (one, other))
            coupled.append(set(_between(model, (one, other))))
    for _ in coupled:
        for group in coupled:
            if group & moved:
                moved |= group
    return moved


def _are_jaws(model: Any, pair: Pair, moved: set[int]) -> bool:
    """Return whether neither body carries the other, and actuators move both relative to their parents."""
    one, other = (set(_chain(model, body)) for body in pair)
    return all(any(moved.intersection(_joints(model, body)) for body in side) for side in (one - other, other - one))


def _between(model: Any, pair: Pair) -> Iterator[int]:
    """Yield the joints that move one of two bodies against the other."""
    one, other = (set(_chain(model, body)) for body in pair)
    return (joint for body in sorted(one ^ other) for joint in _joints(model, body))


def _least(mujoco: Any, model: Any, pair: Pair, random: np.random.Generator) -> float:
    """Return the smallest distance of two bodies that a search finds, moving one joint at a time."""
    geoms = [_geoms(model, body) for body in pair]
    types, affinities = model.geom_contype, model.geom_conaffinity
    meant = [(a, b) for a, b in product(*geoms) if types[a] & affinities[b] or types[b] & affinities[a]]
    joints = [
        (int(model.jnt_qposadr[joint]), *_ends(model, joint))
        for joint in _between(model, pair)
        if int(model.jnt_type[joint]) >= int(mujoco.mjtJoint.mjJNT_SLIDE)
    ]
    data = mujoco.MjData(model)

    def apart() -> float:
        mujoco.mj_kinematics(model, data)
        return float(min(mujoco.mj_geomDistance(model, data, one, other, _FAR, None) for one, other in meant))

    best = _FAR
    for start in range(_STARTS):
        for at, low, high in joints if start else ():
            data.qpos[at] = low + random.random() * (high - low)
        now = apart()
        for _ in range(_ROUNDS):
            before = now
            for at, low, high in joints:
                stays = data.qpos[at]
                for value in np.linspace(low, high, _STEPS):
                    data.qpos[at] = value
                    there = apart()
                    if there < now:
                        now, stays = there, value
                data.qpos[at] = stays
            if now <= _NEAR or now >= before:
                break
        best = min(best, now)
        if best <= _NEAR:
            break
    return best


def _ends(model: Any, joint: int) -> tuple[float, float]:
    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-np.pi, np.pi)
    return float(low), float(high)


def _is_free(mujoco: Any, model: Any, body: int) -> bool:
    return any(int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_FREE) for joint in _joints(model, body))


def _is_tied(mujoco: Any, model: Any, pair: Pair, *, sliding: bool) -> bool:
    """Whether the two bodies cannot move apart freely; `sliding` says that slides without a range do not count."""
    one, other = (set(_chain(model, body)) for body in pair)
    free, slide = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_SLIDE)
    for body in one ^ other:
        for joint in _joints(model, body):
            type = int(model.jnt_type[joint])
            if type == free or (type == slide and not model.jnt_limited[joint] and not sliding):
                return False
    return all(int(model.body_mocapid[body]) < 0 for body in one ^ other)


def _chain(model: Any, body: int) -> Iterator[int]:
    while body:
        yield body
        body = int(model.body_parentid[body])


def _poses(mujoco: Any, model: Any, count: int, seed: int) -> Iterator[Any]:
    random, data, kinds = np.random.Generator(np.random.PCG64(seed)), mujoco.MjData(model), mujoco.mjtJoint
    for _ in range(count):
        for joint in range(model.njnt):
            type, at = int(model.jnt_type[joint]), int(model.jnt_qposadr[joint])
            if type == int(kinds.mjJNT_BALL):
                turn = random.standard_normal(4)
                data.qpos[at : at + 4] = turn / np.linalg.norm(turn)
            elif type == int(kinds.mjJNT_HINGE) or (type == int(kinds.mjJNT_SLIDE) and model.jnt_limited[joint]):
                low, high = _ends(model, joint)
                data.qpos[at] = low + random.random() * (high - low)
        yield data

"""Pairs of bodies that need not collide, in the child process that has MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

ADJACENT, TOUCHING, NEVER = "adjacent", "touching", "never"
_CLOSE = 1e-9


def needless(mujoco: Any, model: Any, asked: dict[str, int]) -> list[dict[str, Any]]:
    """For `composer.engine.call`: the pairs of bodies that MuJoCo checks and need not.

    A joint connects the two (`adjacent`), they touch in the reference configuration or in a key (`touching`), or they
    touch in none of so many `samples`, which a `seed` draws (`never`): every joint anywhere in its range, whatever
    equalities say. What stands in the world itself is left out, and what can move away from the other without a limit
    is no claim about `never`. Gives for each pair the names of its `bodies`, what to call them, `why` and `where`.
    """
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~off
    rest = set(_checked(mujoco, model))
    found: dict[tuple[int, int], tuple[str, str]] = {}
    for pair in sorted(rest):
        if int(model.body_parentid[pair[1]]) == pair[0] and not _is_free(mujoco, model, pair[1]):
            found[pair] = ADJACENT, ""
    for key in range(-1, model.nkey):
        data = mujoco.MjData(model)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        where = "the reference configuration" if key < 0 else f"the key `{model.key(key).name}`"
        for pair in sorted(_touched(mujoco, model, data) & rest):
            if _is_tied(mujoco, model, pair, sliding=True):
                found.setdefault(pair, (TOUCHING, where))
    left = {pair for pair in rest if pair not in found and _is_tied(mujoco, model, pair, sliding=False)}
    for pose in _poses(mujoco, model, asked["samples"], asked["seed"]) if left else ():
        left -= _touched(mujoco, model, pose)
        if not left:
            break
    found |= dict.fromkeys(left, (NEVER, ""))
    return [
        {
            "bodies": [model.body(body).name for body in pair],
            "called": [_called(model, body) for body in pair],
            "why": why,
            "where": where,
        }
        for pair, (why, where) in sorted(found.items())
    ]


def _checked(mujoco: Any, model: Any) -> Iterator[tuple[int, int]]:
    """The pairs of bodies, without the world, whose geoms MuJoCo checks: as `mj_collision` filters them."""
    types = {
        body: [
            (int(model.geom_contype[geom]), int(model.geom_conaffinity[geom]))
            for geom in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body])
        ]
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
            # MuJoCo never filters what is welded to the world.
            if (
                filters
                and welds[one]
                and welds[other]
                and (above[one] == welds[other] or above[other] == welds[one])
            ):
                continue
            if any(a & d or c & b for a, b in first for c, d in second):
                yield one, other


def _touched(mujoco: Any, model: Any, data: Any) -> set[tuple[int, int]]:
    mujoco.mj_fwdPosition(model, data)
    found = set()
    for contact in data.contact:
        geoms = [int(each) for each in contact.geom]
        if contact.dist <= _CLOSE and min(geoms) >= 0:
            one, other = sorted(int(model.geom_bodyid[each]) for each in geoms)
            found.add((one, other))
    return found


def _is_free(mujoco: Any, model: Any, body: int) -> bool:
    return any(
        int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_FREE) for joint in _joints(model, body)
    )


def _joints(model: Any, body: int) -> range:
    start = int(model.body_jntadr[body])
    return range(start, start + int(model.body_jntnum[body]))


def _is_tied(mujoco: Any, model: Any, pair: tuple[int, int], *, sliding: bool) -> bool:
    """Whether the two cannot go apart as far as they like; `sliding` says that slides without a range do not count."""
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
    import numpy

    random = numpy.random.Generator(numpy.random.PCG64(seed))
    data = mujoco.MjData(model)
    kinds = mujoco.mjtJoint
    for _ in range(count):
        for joint in range(model.njnt):
            type, at = int(model.jnt_type[joint]), int(model.jnt_qposadr[joint])
            if type == int(kinds.mjJNT_BALL):
                turn = random.standard_normal(4)
                data.qpos[at : at + 4] = turn / numpy.linalg.norm(turn)
            elif type == int(kinds.mjJNT_HINGE) or (
                type == int(kinds.mjJNT_SLIDE) and model.jnt_limited[joint]
            ):
                low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-numpy.pi, numpy.pi)
                data.qpos[at] = low + random.random() * (high - low)
        yield data


def _called(model: Any, body: int) -> str:
    if name := model.body(body).name:
        return f"`{name}`"
    above = next((each for each in _chain(model, body) if model.body(each).name), 0)
    return f"a body in `{model.body(above).name}`"

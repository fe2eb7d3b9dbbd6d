"""Find touching bodies, in MuJoCo's child process."""

from __future__ import annotations

from typing import Any

_CLOSE = 1e-9


def touching(mujoco: Any, model: Any, prefixes: list[str]) -> list[dict[str, Any]]:
    """Return the pairs of bodies of different parts that touch or overlap; runs under `composer.engine.call`.

    This checks the reference configuration and all keys. `prefixes` are those of the parts. Freely floating bodies
    are left out, because they may lie on the other one. Each pair has the names of its `bodies` (empty for unnamed
    ones), their names for messages, and where they touch.
    """
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~off
    explicit = {
        frozenset((int(one), int(other)))
        for one, other in zip(model.pair_geom1, model.pair_geom2, strict=True)
    }
    found: dict[tuple[int, int], dict[str, Any]] = {}
    for key in range(-1, model.nkey):
        data = mujoco.MjData(model)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_fwdPosition(model, data)
        for contact in data.contact:
            geoms = [int(each) for each in contact.geom]
            if contact.dist > _CLOSE or min(geoms) < 0 or frozenset(geoms) in explicit:
                continue
            one, other = sorted(int(model.geom_bodyid[each]) for each in geoms)
            parts = [_part(model, body, prefixes) for body in (one, other)]
            if parts[0] == parts[1] or (one, other) in found or _floats(mujoco, model, one, other=other):
                continue
            names = [model.body(body).name for body in (one, other)]
            called = [
                f"`{name}`" if name else f"a body in `{_named(model, body)}`"
                for name, body in zip(names, (one, other), strict=True)
            ]
            where = "the reference configuration" if key < 0 else f"the key `{model.key(key).name}`"
            found[one, other] = {"bodies": names, "called": called, "where": where}
    return list(found.values())


def _named(model: Any, body: int) -> str:
    while body and not model.body(body).name:
        body = int(model.body_parentid[body])
    return str(model.body(body).name)


def _part(model: Any, body: int, prefixes: list[str]) -> str:
    name = _named(model, body)
    return max((each for each in prefixes if name.startswith(each)), key=len, default="")


def _floats(mujoco: Any, model: Any, one: int, other: int) -> bool:
    """Return whether only a free joint connects the two."""
    roots = [int(model.body_rootid[body]) for body in (one, other)]
    if roots[0] == roots[1]:
        return False
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    return any(
        int(model.jnt_type[model.body_jntadr[root] + joint]) == free
        for root in roots
        for joint in range(int(model.body_jntnum[root]))
    )

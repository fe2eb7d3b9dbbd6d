"""The numbers of keys by name, from MuJoCo's own names and addresses; runs in its child process."""

from __future__ import annotations

from typing import Any

from composer.compiled.addresses import span
from composer.compiled.kinds import Model, NameTable

_MOCAP = {"mpos": 3, "mquat": 4}


def key_rows(mujoco: Any, whole: Model, asked: dict[str, Any]) -> dict[str, Any]:
    """Compile bare models, and describe them and the keys of the whole model.

    `asked` has the texts of the bare models, the last of them that of the whole one, the first letter of names that
    they give to what has none, and the questions to `hold`. The
    answer has a description of each bare model, None if MuJoCo refuses it, that of the whole one, with its reference
    configuration as another key, and the answers of `hold`. It has `unlike` if the last is not like the whole one.
    """
    bare: list[dict[str, Any] | None] = []
    refused = ""
    for text in asked["texts"]:
        try:
            bare.append(_described(mujoco.MjModel.from_xml_string(text)))
        except ValueError as error:
            bare.append(None)
            refused = " ".join(str(error).split())
    described = _described(whole)
    unlike = refused if bare[-1] is None else _unlike(bare[-1], described, asked["mark"])
    if unlike:
        return {"unlike": unlike}
    reference = {
        "qpos": whole.qpos0.tolist(),
        "qvel": [0.0] * whole.nv,
        "act": [0.0] * whole.na,
        "ctrl": [0.0] * whole.nu,
        "mpos": [each for at in _mocaps(whole) for each in whole.body_pos[at].tolist()],
        "mquat": [each for at in _mocaps(whole) for each in whole.body_quat[at].tolist()],
    }
    held = []
    if asked["held"]:
        from composer.compiled.holding import hold  # few keys hold a pose

        held = [hold(mujoco, whole, question) for question in asked["held"]]
    return {"bare": bare, "keys": described["keys"], "reference": reference, "held": held}


def _described(model: Model) -> dict[str, Any]:
    """Return the holders of numbers by vector, as name, name of the body, number on the body and rows; and the keys."""
    names = NameTable(model).names
    joints = [
        (names["joint"][at], names["body"][body], at - int(model.body_jntadr[body]))
        for at, body in enumerate(model.jnt_bodyid.tolist())
    ]
    actuators = [(name, "", 0) for name in names["actuator"]]
    mocaps = [(names["body"][at], "", 0) for at in _mocaps(model)]
    holders = {
        vector: [[*each, *_ends(span(model, vector, at))] for at, each in enumerate(named)]
        for named, vectors in ((joints, ("qpos", "qvel")), (actuators, ("act", "ctrl")))
        for vector in vectors
    }
    for vector, width in _MOCAP.items():
        holders[vector] = [[*each, at * width, (at + 1) * width] for at, each in enumerate(mocaps)]
    keys = [
        {vector: getattr(model, f"key_{vector}")[at].tolist() for vector in holders}
        for at in range(model.nkey)
    ]
    return {"holders": holders, "keys": keys}


def _ends(rows: range) -> tuple[int, int]:
    return (rows.start, rows.stop) if rows else (0, 0)


def _mocaps(model: Model) -> list[int]:
    bodies = [at for at in range(model.nbody) if model.body_mocapid[at] >= 0]
    return sorted(bodies, key=lambda at: int(model.body_mocapid[at]))


def _unlike(bare: dict[str, Any], whole: dict[str, Any], mark: str) -> str:
    for vector, holders in whole["holders"].items():
        found = bare["holders"][vector]
        if len(found) != len(holders):
            return f"{len(holders)} elements have `{vector}`, not {len(found)}"
        for ours, theirs in zip(found, holders, strict=True):
            if ours[3:] != theirs[3:] or (not ours[0].startswith(mark) and ours[0] != theirs[0]):
                return f"`{vector}` of `{theirs[0] or theirs[1]}` is elsewhere"
    return ""

"""Simulates a model in several trials. Runs by itself, in any Python with numpy and a MuJoCo since 3.0.

Its arguments are the path of a model, the path of the file to write, and a request as JSON: the `seconds`, the names of
the `trials`, and the `key` to start from, if any. It prints JSON: the keys, trials, joints and bodies. The file has
the positions of all joints and bodies at equal times, as `qpos-N` and `xpos-N` for trial N.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from typing import Any

_FRAMES = 50
_STEP, _LIFT = 0.1, 0.05
"""The step of a control, as a share of its range or in its own unit, and the height of a drop in meters."""
_MOST_STEPS = 1_000_000


def main() -> None:
    import mujoco
    import numpy

    said: dict[str, Any] = {"version": mujoco.__version__}
    asked = json.loads(sys.argv[3])
    try:
        model = mujoco.MjModel.from_xml_path(sys.argv[1])
    except Exception as error:
        said["error"] = str(error)
    else:
        said["keys"] = [_name(mujoco, model, "KEY", number=n) for n in range(model.nkey)]
        if asked["key"] is not None and asked["key"] not in said["keys"]:
            json.dump(said, sys.stdout)
            return
        arrays: dict[str, Any] = {}
        said["trials"], said["diverged"] = [], []
        for name, data in _trials(mujoco, model, asked):
            rows = [
                [data.qpos.copy(), data.xpos.copy()] for _ in _frames(mujoco, model, data, seconds=asked["seconds"])
            ]
            flags = ("mjWARN_BADQPOS", "mjWARN_BADQVEL", "mjWARN_BADQACC")
            if any(data.warning[int(getattr(mujoco.mjtWarning, flag))].number for flag in flags):
                said["diverged"].append(name)
            for kind, each in zip(("qpos", "xpos"), zip(*rows, strict=True), strict=True):
                arrays[f"{kind}-{len(said['trials'])}"] = numpy.array(each)
            said["trials"].append(name)
        said["joints"] = [[_name(mujoco, model, "JOINT", number=n), int(model.jnt_type[n]), int(model.jnt_qposadr[n])]
                          for n in range(model.njnt)]  # fmt: skip
        said["bodies"] = [_name(mujoco, model, "BODY", number=n) for n in range(model.nbody)]
        with open(sys.argv[2], "wb") as out:
            numpy.savez(out, **arrays)
    json.dump(said, sys.stdout)


def _name(mujoco: Any, model: Any, kind: str, number: int) -> str:
    return str(mujoco.mj_id2name(model, getattr(mujoco.mjtObj, "mjOBJ_" + kind).value, number) or f"#{number}")


def _trials(mujoco: Any, model: Any, asked: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield each trial with its start: settle from the reference, hold a key, a step of all controls, or a drop."""
    keys = [_name(mujoco, model, "KEY", number=n) for n in range(model.nkey)]
    start = keys.index(asked["key"]) if asked["key"] in keys else 0
    flags = int(model.opt.disableflags)
    for trial in asked["trials"]:
        data = mujoco.MjData(model)
        if trial != "settle" and keys:
            mujoco.mj_resetDataKeyframe(model, data, start)
        elif trial == "hold":
            continue
        if trial == "step":
            if not len(data.ctrl):
                continue
            limited, ends = model.actuator_ctrllimited, model.actuator_ctrlrange
            width = [high - low if on else 1.0 for on, (low, high) in zip(limited, ends, strict=True)]
            data.ctrl[: len(width)] += [_STEP * each for each in width]
        if trial == "drop":
            model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
            for joint in range(model.njnt):
                if not model.jnt_type[joint]:
                    data.qpos[model.jnt_qposadr[joint] + 2] += _LIFT
        yield f"{trial} {keys[start]}" if trial != "settle" and keys else trial, data
        model.opt.disableflags = flags


def _frames(mujoco: Any, model: Any, data: Any, seconds: float) -> Iterator[int]:
    steps = min(max(1, round(seconds / model.opt.timestep)), _MOST_STEPS)
    mujoco.mj_kinematics(model, data)
    for frame in range(_FRAMES):
        for _ in range(steps * frame // _FRAMES, steps * (frame + 1) // _FRAMES):
            mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)
        yield frame


if __name__ == "__main__":
    main()

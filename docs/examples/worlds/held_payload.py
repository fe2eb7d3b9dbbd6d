"""Which commands hold the arm of `recipes/held_payload.yaml` up, whatever it carries? Learnt in 10,000 worlds.

mjcompose build recipes/held_payload.yaml --as worlds -o build/held/
python docs/examples/worlds/held_payload.py build/held/

Payloads pull the arm down, in each world by another angle. Learnt are commands that are right for the average of the
worlds, and a gain on the error so far that takes care of the rest: by evolution, in `mujoco.batch`, on a part of the
worlds. What was learnt is then tried in all of them, in `mujoco.batch` and, where it is installed, in MuJoCo Warp.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from mjcompose import LoadError, worlds

STEPS = 40
CYCLES = 8  # steps of physics for one of the controller, and of these in a trial
ROUNDS = 6
TRIED = 12
KEPT = 4


def command(parameters: np.ndarray, home: np.ndarray, qpos: np.ndarray, total: np.ndarray) -> np.ndarray:
    """What the servos are told: home, something more, and a part of the error so far. `(worlds, joints)`"""
    return home + parameters[:-1] + parameters[-1] * total


def in_batch(study: worlds.Worlds):
    """A trial in MuJoCo's own batch: gives how far each world is from home, `(worlds,)`, in radians."""
    batch = worlds.mujoco(study)
    home = study.nominal.key_qpos[0]

    def trial(parameters: np.ndarray) -> np.ndarray:
        batch.reset()
        batch.qpos[:] = home
        total = np.zeros_like(batch.qpos)
        for _ in range(CYCLES):
            batch.ctrl[:] = command(parameters, home, batch.qpos, total)
            batch.step(nstep=STEPS)
            total += home - batch.qpos
        return np.linalg.norm(batch.qpos - home, axis=1)

    return trial


def in_warp(study: worlds.Worlds):
    """The same trial in MuJoCo Warp."""
    model = worlds.warp(study)
    home = study.nominal.key_qpos[0]
    import mujoco_warp

    def trial(parameters: np.ndarray) -> np.ndarray:
        data = worlds.warp_data(study)
        data.qpos.assign(np.tile(home, (study.count, 1)).astype(np.float32))
        total = np.zeros((study.count, study.nominal.nq))
        for _ in range(CYCLES):
            data.ctrl.assign(command(parameters, home, data.qpos.numpy(), total).astype(np.float32))
            for _ in range(STEPS):
                mujoco_warp.step(model, data)
            total += home - data.qpos.numpy()
        return np.linalg.norm(data.qpos.numpy() - home, axis=1)

    return trial


def learn(trial, joints: int) -> np.ndarray:
    """The parameters that leave the worlds nearest to home, by the cross-entropy method."""
    random = np.random.default_rng(1)
    mean = np.zeros(joints + 1)
    spread = np.append(np.full(joints, 0.02), 0.3)
    for _ in range(ROUNDS):
        tried = mean + spread * random.standard_normal((TRIED, mean.size))
        tried[:, -1] = np.clip(tried[:, -1], 0, 1)
        best = tried[np.argsort([np.mean(trial(each)) for each in tried])[:KEPT]]
        mean = best.mean(axis=0)
        spread = best.std(axis=0) + 1e-4
    return mean


def timed(name: str, trial, parameters: np.ndarray) -> np.ndarray:
    start = time.perf_counter()
    error = trial(parameters)
    print(
        f"{name}: {np.rad2deg(np.mean(error)):.3f} degrees, at worst {np.rad2deg(error.max()):.3f},"
        f" in {len(error)} worlds, {time.perf_counter() - start:.1f} s"
    )
    return error


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bundle")
    parser.add_argument("--learn-in", type=int, default=200, metavar="WORLDS")
    arguments = parser.parse_args()
    study = worlds.load(arguments.bundle)
    whole = in_batch(study)
    timed("before", whole, np.zeros(study.nominal.nu + 1))
    start = time.perf_counter()
    parameters = learn(in_batch(study.take(range(min(arguments.learn_in, study.count)))), study.nominal.nu)
    print(f"learnt in {time.perf_counter() - start:.1f} s")
    error = timed("mujoco.batch", whole, parameters)
    try:
        other = timed("mujoco_warp", in_warp(study), parameters)
    except LoadError as missing:
        print(missing)
    else:
        print(f"both agree to {np.rad2deg(np.abs(error - other).max()):.1e} degrees")


if __name__ == "__main__":
    main()

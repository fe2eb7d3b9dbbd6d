"""A small robot with known numbers, and recordings of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import mujoco
import numpy as np

MODEL = """<mujoco model="arm">
  <compiler angle="radian"/>
  <option timestep="0.004" integrator="implicitfast"/>
  <worldbody>
    <body name="base"><geom size=".05"/>
      <body name="upper" pos="0 0 .1"><joint name="shoulder" axis="0 1 0" damping="{shoulder}" range="-3 3"/>
        <geom type="capsule" size=".03" fromto="0 0 0 .3 0 0" mass="1" contype="0" conaffinity="0"/>
        <body name="fore" pos=".3 0 0"><joint name="elbow" axis="0 1 0" damping="{damping}" armature="{armature}" frictionloss="{friction}" range="-2 2"/>
          <geom type="capsule" size=".03" fromto="0 0 0 .2 0 0" mass="{mass}" contype="0" conaffinity="0"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder" joint="shoulder" kp="80" kv="8" ctrlrange="-3 3"/>
    <position name="elbow" joint="elbow" kp="{kp}" kv="2" ctrlrange="-2 2"/>
  </actuator>
</mujoco>"""
RECIPE = {"shoulder": 1.0, "damping": 0.5, "armature": 0.05, "friction": 0.0, "mass": 0.5, "kp": 20.0}


def model(**numbers: float) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(MODEL.format(**{**RECIPE, **numbers}))


def recorded(
    robot: mujoco.MjModel, seconds: float = 2.0, noise: float = 2e-4, seed: int = 1, size: float = 0.4
) -> dict[str, np.ndarray]:
    """Return the columns of a recording: the robot follows sines, and each sample has noise."""
    random = np.random.default_rng(seed)
    data = mujoco.MjData(robot)
    rates = random.uniform(0.4, 1.5, robot.nu)
    rows = []
    for step in range(int(seconds / robot.opt.timestep)):
        time = step * robot.opt.timestep
        data.ctrl[:] = size * np.sin(2 * np.pi * rates * time) * min(1.0, 4 * time)
        rows.append([time, *data.qpos, *data.ctrl])
        mujoco.mj_step(robot, data)
    table = np.array(rows)
    table[:, 1 : 1 + robot.nq] += random.normal(0, noise, (len(table), robot.nq))
    joints = [f"qpos {robot.joint(index).name}" for index in range(robot.njnt)]
    actuators = [f"ctrl {robot.actuator(index).name}" for index in range(robot.nu)]
    return dict(zip(["time", *joints, *actuators], table.T.copy(), strict=True))


def write_csv(path: Path, columns: Mapping[str, np.ndarray]) -> Path:
    with path.open("w", encoding="utf-8") as file:
        file.write(",".join(columns) + "\n")
        for row in zip(*columns.values(), strict=True):
            file.write(",".join("" if np.isnan(value) else f"{value:.9g}" for value in row) + "\n")
    return path


def write_npz(path: Path, columns: Mapping[str, np.ndarray]) -> Path:
    np.savez(path, **columns)  # type: ignore[arg-type]
    return path

"""A small robot with known numbers, and recordings of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

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


def write_parquet(path: Path, columns: Mapping[str, Any], **options: Any) -> Path:
    import pyarrow
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.table(dict(columns)), path, **options)
    return path


def of_kind(columns: Mapping[str, np.ndarray], kind: str) -> dict[str, np.ndarray]:
    """Return the columns of a kind, by the names of the joints."""
    return {name.removeprefix(f"{kind} "): values for name, values in columns.items() if name.startswith(f"{kind} ")}


SPLIT = "=" * 80
TIME = "int32 sec\nuint32 nanosec"
HEADER = f"builtin_interfaces/Time stamp\nstring frame_id\n{SPLIT}\nMSG: builtin_interfaces/Time\n{TIME}"
JOINT_STATE = (
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
    f"{SPLIT}\nMSG: std_msgs/Header\n{HEADER}"
)
ARRAY = f"""std_msgs/MultiArrayLayout layout
float64[] data
{SPLIT}
MSG: std_msgs/MultiArrayLayout
MultiArrayDimension[] dim
uint32 data_offset
{SPLIT}
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride"""
BEGIN = 1_700_000_000_000_000_000
"""The time of the first message, in nanoseconds since 1970."""


class Log:
    """A log of ROS 2 in MCAP, written with the library of the format."""

    def __init__(self, path: Path, **options: Any) -> None:
        from mcap_ros2.writer import Writer

        self.path = path
        self._file = path.open("wb")
        self.writer = Writer(self._file, **options)
        self.state = self.writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
        self.array = self.writer.register_msgdef("std_msgs/msg/Float64MultiArray", ARRAY)

    def add_state(
        self,
        seconds: float,
        names: list[str],
        positions: list[float],
        *,
        stamp: int | None = BEGIN,
        delay: int = 0,
        topic: str = "/joint_states",
        velocity: list[float] | None = None,
    ) -> None:
        at = round(seconds * 1e9)
        stamped = 0 if stamp is None else stamp + at
        message = {
            "header": {"stamp": {"sec": stamped // 10**9, "nanosec": stamped % 10**9}, "frame_id": ""},
            "name": names,
            "position": positions,
            "velocity": velocity or [],
            "effort": [],
        }
        logged = BEGIN + at + delay
        self.writer.write_message(topic, self.state, message, log_time=logged, publish_time=logged)

    def add_command(self, seconds: float, values: list[float], topic: str = "/commands") -> None:
        at = BEGIN + round(seconds * 1e9)
        message = {"layout": {"dim": [], "data_offset": 0}, "data": values}
        self.writer.write_message(topic, self.array, message, log_time=at, publish_time=at)

    def close(self) -> Path:
        self.writer.finish()
        self._file.close()
        return self.path


def write_mcap(path: Path, columns: Mapping[str, np.ndarray], **options: Any) -> Path:
    """Write states whose joints change their order, and commands without names."""
    log = Log(path, **options)
    states = of_kind(columns, "qpos")
    commands = of_kind(columns, "ctrl")
    for row, time in enumerate(columns["time"]):
        log.add_command(time, [float(values[row]) for values in commands.values()])
        order = sorted(states, reverse=row % 2 == 0)
        log.add_state(time, order, [float(states[name][row]) for name in order])
    return log.close()


def info(columns: Mapping[str, np.ndarray], **changes: Any) -> dict[str, Any]:
    """Return the contents of `meta/info.json` as LeRobot 0.4 writes it."""
    features = {
        feature: {"dtype": "float32", "shape": [len(names)], "names": [f"{name}.pos" for name in names]}
        for feature, names in (
            ("observation.state", of_kind(columns, "qpos")),
            ("action", of_kind(columns, "ctrl")),
        )
    }
    single = {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in SINGLE.items()}
    return {
        "codebase_version": "v3.0",
        "robot_type": "so_follower",
        "total_episodes": 2,
        "total_frames": 2 * len(columns["time"]),
        "chunks_size": 1000,
        "fps": 250,
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "features": {**features, **single},
        **changes,
    }


SINGLE = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}


def write_lerobot(folder: Path, columns: Mapping[str, np.ndarray], **changes: Any) -> Path:
    """Write a data set with two episodes, of which the second is the recording and the first stays at 0."""
    import pyarrow

    (folder / "meta").mkdir(parents=True)
    (folder / "data/chunk-000").mkdir(parents=True)
    (folder / "meta/info.json").write_text(json.dumps(info(columns, **changes)), encoding="utf-8")
    count = len(columns["time"])
    states, actions = (np.array([*of_kind(columns, kind).values()]).T for kind in ("qpos", "ctrl"))
    both = [np.vstack([np.zeros_like(values), values]) for values in (states, actions)]
    state, action = (
        pyarrow.FixedSizeListArray.from_arrays(pyarrow.array(values.ravel(), pyarrow.float32()), values.shape[1])
        for values in both
    )
    table = {
        "observation.state": state,
        "action": action,
        "timestamp": pyarrow.array(np.tile(columns["time"], 2), pyarrow.float32()),
        "frame_index": np.tile(np.arange(count), 2),
        "episode_index": np.repeat([0, 1], count),
        "index": np.arange(2 * count),
        "task_index": np.zeros(2 * count, int),
    }
    write_parquet(folder / "data/chunk-000/file-000.parquet", table)
    return folder

"""How often the intervals of `mjcompose identify` hold, on robots with known numbers.

    python -m bench.identify arm --seeds 1-20         # 18 numbers of recipes/models/arm6, 3 s at 250 Hz, 0.2 mrad
    python -m bench.identify pendulum --seeds 1-30    # 3 numbers of a pendulum that turns over
    python -m bench.identify slow                     # a motion that says nothing of damping
    python -m bench.identify delay                    # a delay, found within half a time step
    python -m bench.identify late                     # the same delay, which no field describes: errors are not noise

Each seed has its own robot and its own motion. A line for each seed is printed, then the share of 95 % intervals that
hold. docs/contributing/identify.md has the results.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from mjcompose.language.measured import DELAY
from mjcompose.tools.identify.fit import choose_window, with_window
from mjcompose.tools.identify.intervals import fit_and_know, verdicts
from mjcompose.tools.identify.problem import FitSettings, Problem
from mjcompose.tools.identify.recording import Command, Recording, Signal
from mjcompose.tools.identify.unknowns import ModelPool, UnknownNumber, unknowns_of

ROOT = Path(__file__).resolve().parents[1]
PENDULUM = """<mujoco model="pendulum">
  <option timestep="0.01"/>
  <worldbody>
    <body name="pole" pos="0 0 .6"><joint name="hinge" axis="0 1 0" damping="0.1"/>
      <geom type="capsule" fromto="0 0 0 0 0 .5" size=".045" mass="0.2" contype="0" conaffinity="0"/>
      <geom type="sphere" pos="0 0 .5" size=".05" mass="1" contype="0" conaffinity="0"/>
    </body>
  </worldbody>
  <actuator><motor name="torque" joint="hinge" ctrlrange="-1 1" ctrllimited="true"/></actuator>
</mujoco>"""


@dataclass
class Motion:
    """How a recording is made."""

    seconds: float = 3.0
    rate: int = 250
    control_rate: int = 250
    noise: float = 2e-4
    size: float = 0.35
    slow: float = 1.0
    square: float = 0.14
    fine: int = 1


@dataclass
class Case:
    """A model, the numbers that are fitted, and the motion."""

    model: mujoco.MjModel
    numbers: list[tuple[str, str, list[float]]]
    motion: Motion = field(default_factory=Motion)
    delay: float | None = None

    def fields(self) -> list[dict[str, Any]]:
        found = []
        for kind, attribute, bounds in self.numbers:
            count = self.model.njnt if kind == "joint" else self.model.nu
            names = [getattr(self.model, kind)(index).name for index in range(count)]
            groups = [[{"name": name, "tag": kind, "family": kind}] for name in names]
            if attribute == DELAY:
                groups = [[element for group in groups for element in group]]
            about = {"name": attribute, "kind": kind, "attribute": attribute}
            found.append({**about, "groups": groups, "bounds": ["range", *bounds]})
        return found


def cases(name: str) -> Case:
    friction = [("joint", "frictionloss", [0, 5]), ("joint", "damping", [0, 20]), ("joint", "armature", [0, 1])]
    if name == "pendulum":
        motion = Motion(seconds=3.0, rate=100, control_rate=100, noise=1e-3, size=1.0)
        numbers = [("joint", "damping", [0, 1]), ("joint", "frictionloss", [0, 0.5]), ("joint", "armature", [0, 0.2])]
        return Case(mujoco.MjModel.from_xml_string(PENDULUM), numbers, motion)
    arm = mujoco.MjModel.from_xml_path(str(ROOT / "recipes/models/arm6/arm6.xml"))
    if name == "slow":
        return Case(arm, friction, Motion(slow=12.0, size=0.05, noise=5e-4, rate=100, control_rate=100, square=0))
    if name == "delay":
        numbers = [("joint", "damping", [0, 20]), ("actuator", DELAY, [0, 0.06])]
        return Case(arm, numbers, Motion(control_rate=50), delay=0.0237)
    if name == "late":
        return Case(arm, friction, Motion(control_rate=50), delay=0.0237)
    return Case(arm, friction)


def true_numbers(unknowns: list[UnknownNumber], seed: int, delay: float | None) -> np.ndarray:
    """Return numbers in the ranges, away from those of the model."""
    found = []
    for unknown in unknowns:
        random = np.random.default_rng([11, seed, zlib.crc32(unknown.word.encode())])
        if unknown.attribute == DELAY:
            found.append(delay or 0.0)
        elif unknown.low == 0:
            found.append(unknown.high * 10 ** random.uniform(-1.7, -0.5))
        else:
            found.append(random.uniform(unknown.low, unknown.high))
    return np.array(found)


def record(case: Case, unknowns: list[UnknownNumber], truth: np.ndarray, seed: int) -> Recording:
    """Simulate the robot with the true numbers, and return its recording."""
    motion = case.motion
    random = np.random.default_rng([5, seed])
    robot = ModelPool(mujoco, case.model, unknowns).write(truth, 0)
    robot.opt.timestep = case.model.opt.timestep / motion.fine
    data = mujoco.MjData(robot)
    if robot.nkey:
        mujoco.mj_resetDataKeyframe(robot, data, 0)
    at = np.arange(int(motion.seconds * motion.control_rate) + 1) / motion.control_rate
    commands = np.tile(data.ctrl, (len(at), 1))
    for actuator in range(robot.nu):
        rates = (random.uniform(0.15, 0.5), random.uniform(0.6, 1.1), random.uniform(1.5, 2.6))
        phases = random.uniform(0, 6.28, 3)
        wave = sum(
            share * (np.sin(2 * np.pi * rate * at / motion.slow + phase) - np.sin(phase))
            for share, rate, phase in zip((0.6, 0.25, 0.15), rates, phases, strict=True)
        )
        square = motion.square * np.sign(np.sin(2 * np.pi * random.uniform(0.3, 0.8) * at))
        commands[:, actuator] += motion.size * (wave + square)
        if robot.actuator_ctrllimited[actuator]:
            commands[:, actuator] = np.clip(commands[:, actuator], *robot.actuator_ctrlrange[actuator])
    late = case.delay or 0.0
    steps = round(motion.seconds / robot.opt.timestep)
    positions = np.empty((steps + 1, robot.nq))
    for step in range(steps + 1):
        now = step * robot.opt.timestep - late
        data.ctrl[:] = commands[max(0, int(np.floor(now * motion.control_rate + 1e-6)))]
        positions[step] = data.qpos
        mujoco.mj_step(robot, data)
    grid = np.arange(steps + 1) * robot.opt.timestep
    times = np.arange(int(motion.seconds * motion.rate)) / motion.rate
    signals = {}
    for joint in range(robot.njnt):
        values = np.interp(times, grid, positions[:, robot.jnt_qposadr[joint]])
        signals[Signal("qpos", robot.joint(joint).name)] = values + random.normal(0, motion.noise, len(times))
    held = {robot.actuator(index).name: Command(at, commands[:, index]) for index in range(robot.nu)}
    return Recording(f"seed {seed}", "0" * 64, times, signals, held)


def run(case: Case, seed: int) -> dict[str, Any]:
    """Fit one robot, and compare with its true numbers."""
    begin = time.perf_counter()
    unknowns = unknowns_of(mujoco, case.model, case.fields())
    truth = true_numbers(unknowns, seed, case.delay)
    recording = record(case, unknowns, truth, seed)
    problem = Problem(mujoco, case.model, unknowns, [recording], FitSettings())
    problem = with_window(problem, choose_window(problem))
    found, solution, knowledge = fit_and_know(problem)
    said = verdicts(found, solution, knowledge)
    off = (solution.values - truth) / knowledge.std
    return {
        "seed": seed,
        "numbers": len(unknowns),
        "hold": int((np.abs(off) <= 1.96).sum()),
        "measured": sum(not each.word for each in said),
        "off": [round(float(each), 2) for each in off],
        "said": {unknown.word: each.word for unknown, each in zip(unknowns, said, strict=True) if each.word},
        "median_error": round(float(np.median(np.abs(solution.values / truth - 1))), 4),
        "correlated": round(max(knowledge.times.values()), 1),
        "values": {} if unknowns[-1].attribute != DELAY else {unknowns[-1].word: round(float(solution.values[-1]), 5)},
        "steps": found.simulator.steps,
        "seconds": round(time.perf_counter() - begin, 1),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", choices=("arm", "pendulum", "slow", "delay", "late"))
    parser.add_argument("--seeds", default="1-1", help="the first and the last seed")
    options = parser.parse_args()
    first, _, last = options.seeds.partition("-")
    rows = []
    for seed in range(int(first), int(last or first) + 1):
        rows.append(run(cases(options.case), seed))
        sys.stdout.write(json.dumps(rows[-1]) + "\n")
        sys.stdout.flush()
    hold = sum(row["hold"] for row in rows)
    numbers = sum(row["numbers"] for row in rows)
    far = sum(abs(each) > 4 for row in rows for each in row["off"])
    share = f"{hold} of {numbers} intervals hold ({hold / numbers:.1%})"
    sys.stdout.write(f"{options.case}: {share}, {far} numbers are off by more than 4 standard deviations\n")


if __name__ == "__main__":
    main()

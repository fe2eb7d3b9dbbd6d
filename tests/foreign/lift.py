"""The recipe of the page on moving from robosuite, and robosuite's own model of the same robot, gripper, table and cube."""

from __future__ import annotations

import importlib
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from foreign import merging
from foreign.by_name import LeftOut
from foreign.strings import Verdict

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "how-to" / "from_mjspec.md"
# robosuite's classes by the words of the recipe.
ROBOTS = {"panda": "Panda", "sawyer": "Sawyer", "ur5e": "UR5e"}
GRIPPERS = {
    "panda_gripper": "PandaGripper",
    "rethink_gripper": "RethinkGripper",
    "robotiq_gripper_85": "Robotiq85Gripper",
}
# The page says that these are not in the recipe.
LEFT_OUT = LeftOut(r"(left|right)_eef_target.*|cube_g0_vis|cube_default_site", merging.NAMED_BY_ROBOSUITE)


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell of the recipe's matrix, and the folders that hold the package and what was built."""

    robot: str
    gripper: str
    package: Path
    built: Path

    @property
    def id(self) -> str:
        return f"robosuite/lift-{self.robot}-{self.gripper}"


def recipe() -> str:
    """The page's recipe, word for word."""
    found = re.search(
        r'^```yaml title="lift.yaml"\n(.*?)^```', PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )
    assert found is not None
    return found[1]


def build_all(package: Path, place: Path) -> Sequence[Cell]:
    """Build the page's recipe with the files of robosuite, as the page does, for every cell."""
    (place / "lift.yaml").write_text(recipe(), encoding="utf-8")
    command = [sys.executable, "-m", "mjcompose", "build", "lift.yaml", "--all", "-o", "built/{name}/"]
    environment = {**os.environ, "PYTHONPATH": str(package)}
    ran = subprocess.run(command, cwd=place, env=environment, capture_output=True, text=True, timeout=600, check=False)
    assert ran.returncode == 0, ran.stderr
    return [Cell(robot, gripper, package, place / "built") for robot in ROBOTS for gripper in GRIPPERS]


def judge(cell: Cell) -> Verdict:
    """Compare robosuite's model and the built one by name, at rest and in motion."""
    merged, start = _made_by_robosuite(cell)
    composed = mujoco.MjModel.from_xml_path(str(cell.built / f"lift-{cell.robot}-{cell.gripper}" / "model.xml"))
    pose = _home(composed)
    wrong = [name for name, number in start.items() if not np.allclose(pose[name], number, atol=1e-12)]
    if wrong:
        return Verdict(cell.id, True, f"the key `home` and init_qpos differ in {', '.join(wrong)}")
    return Verdict(cell.id, True, merging.said(merged, composed, pose, LEFT_OUT))


def failed(cell: Cell, error: str) -> Verdict:
    return Verdict(cell.id, True, f"failed: {error}")


def _made_by_robosuite(cell: Cell) -> tuple[mujoco.MjModel, dict[str, float]]:
    """The model of robosuite's `Lift`, with a cube of one size, and the robot's first pose."""
    merging.import_models(cell.package)
    robots, bases, grippers, arenas, objects, tasks = (
        importlib.import_module(f"robosuite.models.{name}")
        for name in ("robots", "bases", "grippers", "arenas", "objects", "tasks")
    )
    robot = robots.create_robot(ROBOTS[cell.robot], idn=0)
    robot.add_base(bases.robot_base_factory("RethinkMount", idn=0))
    start = dict(zip(robot.joints, map(float, robot.init_qpos), strict=True))
    robot.add_gripper(grippers.gripper_factory(GRIPPERS[cell.gripper], idn="0_right"), robot.eef_name["right"])
    arena = arenas.TableArena()
    robot.set_base_xpos(robot.base_xpos_offset["table"](arena.table_full_size[0]))
    cube = objects.BoxObject(name="cube", size=[0.021, 0.021, 0.021], rgba=[1, 0, 0, 1])
    return tasks.ManipulationTask(arena, [robot], cube).get_model(), start


def _home(model: mujoco.MjModel) -> dict[str, list[float]]:
    """The key `home` by joint."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    return {model.joint(index).name: data.joint(index).qpos.tolist() for index in range(model.njnt)}

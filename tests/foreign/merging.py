"""robosuite's own compositions as an oracle: a robot, its mount and its grippers, merged by its code and composed from the same parts.

Of robosuite only what reads and merges MJCF is imported: modules that show or simulate stand empty in their places.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import types
import warnings
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import yaml
from fidelity.building import build
from foreign.strings import Verdict
from mjcompose.mujoco.arrays import ROUNDING
from mjcompose.mujoco.compare import Keys
from mjcompose.mujoco.unchanged import compare

# The robots that stand on a mount. Mobile bases take a robot's bodies apart, which no composition does.
ROBOTS = (
    "Sawyer",
    "Baxter",
    "Panda",
    "Jaco",
    "Kinova3",
    "IIWA",
    "UR5e",
    "SpotArm",
    "XArm7",
    "PandaDexRH",
    "PandaDexLH",
)


@dataclass(frozen=True, slots=True)
class Merging:
    """A robot of robosuite by the name of its class, and the folder that holds the package."""

    robot: str
    folder: Path

    @property
    def id(self) -> str:
        return f"robosuite/{self.robot}"


def judge(merging: Merging) -> Verdict:
    """The model that robosuite merges and the one that mjcompose composes of its parts, compared by name."""
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as place:
        warnings.simplefilter("ignore")
        merged, recipe = _merged(merging, Path(place))
        built = build(recipe)
        if built.model is None:
            return Verdict(merging.id, True, "refused: " + " ".join(built.diagnostics.split()))
        composed = built.load()
    told = compare(merged, composed, keys=Keys.PREFIX, tolerance=ROUNDING, others=[])
    return Verdict(merging.id, True, ", ".join(map(str, told)))


def failed(merging: Merging, error: str) -> Verdict:
    return Verdict(merging.id, True, f"failed: {error}")


def _merged(merging: Merging, place: Path) -> tuple[mujoco.MjModel, Path]:
    """What robosuite makes of a robot, and a recipe of the parts, as it has them before it merges them."""
    _stand_in(merging.folder)
    robots, grippers, bases = (
        importlib.import_module(f"robosuite.models.{name}") for name in ("robots", "grippers", "bases")
    )
    robot = robots.create_robot(merging.robot)
    recipe: dict[str, Any] = {"recipe": 1, "base": "./robot.xml", "attach": {}}
    robot.save_model(str(place / "robot.xml"))

    def hang(name: str, part: Any, body: str) -> None:
        _write(part, robot, place / f"{name}.xml")
        recipe["attach"][name] = {"model": f"./{name}.xml", "body": body, "prefix": ""}

    mount = bases.robot_base_factory(robot.default_base)
    robot.add_base(mount)
    hang("mount", mount, robot.root_body)
    for arm, kind in robot.default_gripper.items():
        gripper = grippers.gripper_factory(kind, idn=f"0_{arm}")
        body = robot.eef_name[arm]
        _place(gripper, robot, arm)
        robot.add_gripper(gripper, body)
        hang(f"{arm}_gripper", gripper, body)
    recipe["trust"] = {"files": [str(merging.folder)]}
    path = place / "recipe.yaml"
    path.write_text(yaml.safe_dump(recipe, sort_keys=False), encoding="utf-8")
    return robot.get_model(), path


def _write(part: Any, robot: Any, path: Path) -> None:
    """A part as robosuite merges it: by the compiler's settings of the robot, and of assets of one name the first."""
    root = deepcopy(part.root)
    for compiler in root.findall("compiler"):
        root.remove(compiler)
    root.extend(deepcopy(robot.root.findall("compiler")))
    seen: set[tuple[str, str | None]] = set()
    assets = root.find("asset")
    for asset in list(assets):
        key = (asset.tag, asset.get("name"))
        if key in seen:
            assets.remove(asset)
        seen.add(key)
    path.write_bytes(ElementTree.tostring(root))


def _place(gripper: Any, robot: Any, arm: str) -> None:
    """Where the gripper stands on the hand, which robosuite's simulated robot says to its first body."""
    body = gripper.worldbody.find("body")
    for key, places in (("pos", robot.gripper_mount_pos_offset), ("quat", robot.gripper_mount_quat_offset)):
        if arm in places:
            body.set(key, " ".join(map(repr, places[arm])))


def _stand_in(folder: Path) -> None:
    """The modules of robosuite that import what is not needed here."""
    if "robosuite" in sys.modules:
        return
    top = folder / "robosuite"

    def module(name: str, **members: Any) -> types.ModuleType:
        made = types.ModuleType(name)
        vars(made).update(members)
        sys.modules[name] = made
        return made

    macros = module("robosuite.macros", USING_INSTANCE_RANDOMIZATION=False)
    models = module("robosuite.models", __path__=[str(top / "models")], assets_root=str(top / "models" / "assets"))
    module("robosuite", __path__=[str(top)], macros=macros, models=models)
    module("robosuite.utils.numba", jit_decorator=lambda function: function)
    module("robosuite.models.grippers.gripper_tester", GripperTester=None)

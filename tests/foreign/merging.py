"""robosuite's own compositions as an oracle: a robot, its mount and its grippers, merged by its code and composed from the same files.

The recipe names the files of robosuite as they are. What robosuite's classes write into a model after they read it is an
edit in the recipe. Of robosuite only what reads and merges MJCF is imported: modules that show or simulate stand empty in
their places.
"""

from __future__ import annotations

import importlib
import sys
import tempfile
import types
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import yaml
from fidelity.building import build
from foreign.by_name import LeftOut, differences, driven_apart
from foreign.strings import Verdict

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
# robosuite names the geoms that have no name.
NAMED_BY_ROBOSUITE = r".*_g\d+_(vis|col)"
# How far two bodies may be from each other after one second, in meters.
CLOSE = 1e-9
_JOINT_SETTINGS = ("armature", "damping", "frictionloss")
_SHOWN = 3


@dataclass(frozen=True, slots=True)
class Merging:
    """A robot of robosuite by the name of its class, and the folder that holds the package."""

    robot: str
    folder: Path

    @property
    def id(self) -> str:
        return f"robosuite/{self.robot}"


def judge(merging: Merging) -> Verdict:
    """The model that robosuite merges and the one that mjcompose composes of the same files, compared by name."""
    with warnings.catch_warnings(), tempfile.TemporaryDirectory() as place:
        warnings.simplefilter("ignore")
        merged, recipe, pose = _merged(merging, Path(place))
        built = build(recipe)
        if built.model is None:
            return Verdict(merging.id, True, "refused: " + " ".join(built.diagnostics.split()))
        try:
            composed = built.load()
        except ValueError as error:
            return Verdict(merging.id, True, "refused: " + " ".join(str(error).split()))
    return Verdict(merging.id, True, said(merged, composed, pose, LeftOut(names=NAMED_BY_ROBOSUITE)))


def said(merged: mujoco.MjModel, composed: mujoco.MjModel, pose: dict[str, list[float]], left_out: LeftOut) -> str:
    """How the composed model differs from robosuite's, in its parts and after a motion of one second."""
    lines = list(differences(merged, composed, left_out))
    if not lines:
        apart = driven_apart(merged, composed, pose)
        if apart > CLOSE:
            lines.append(f"{apart} m apart after one second")
    more = [f"and {len(lines) - _SHOWN} more"] if len(lines) > _SHOWN else []
    return ", ".join([*lines[:_SHOWN], *more])


def failed(merging: Merging, error: str) -> Verdict:
    return Verdict(merging.id, True, f"failed: {error}")


def _merged(merging: Merging, place: Path) -> tuple[mujoco.MjModel, Path, dict[str, list[float]]]:
    """What robosuite makes of a robot, a recipe of the same files, and the pose in which robosuite starts."""
    import_models(merging.folder)
    robots, grippers, bases = (
        importlib.import_module(f"robosuite.models.{name}") for name in ("robots", "grippers", "bases")
    )
    robot = robots.create_robot(merging.robot)
    # robosuite reads each part by the settings of the robot.
    compiler = _settings(robot)
    parts = {_key(robot): {"model": robot.file, "compiler": compiler, "edit": _joint_edits(robot)}}
    pose = dict(zip(robot.joints, ([number] for number in robot.init_qpos), strict=True))
    mount = bases.robot_base_factory(robot.default_base)
    parts[_key(mount)] = {
        "model": mount.file,
        "compiler": compiler,
        "drop": _options(mount),
        "edit": _materials(mount),
        "body": robot.root_body,
        "mate": mount._root_body,
        "pos": [float(number) for number in robot.base_offset - mount.top_offset],
    }
    robot.add_base(mount)
    for arm, kind in robot.default_gripper.items():
        gripper = grippers.gripper_factory(kind, idn=f"0_{arm}")
        body = robot.eef_name[arm]
        edits = [*_repeated_assets(gripper), *_place(gripper, robot, arm)]
        robot.add_gripper(gripper, body)
        parts[_key(gripper)] = {
            "model": gripper.file,
            "compiler": compiler,
            "drop": _options(gripper),
            "body": body,
            "edit": edits,
        }
    recipe = {
        "recipe": 1,
        "name": "robot",
        "angle": "radian",
        "separator": "_",
        "attach": {key: {name: value for name, value in part.items() if value} for key, part in parts.items()},
        "trust": {"files": [str(merging.folder)]},
    }
    path = place / "recipe.yaml"
    path.write_text(yaml.safe_dump(recipe, sort_keys=False), encoding="utf-8")
    return robot.get_model(), path, pose


def _key(part: Any) -> str:
    """The key of a part in the recipe, which gives robosuite's prefix."""
    return str(part.naming_prefix).removesuffix("_")


def _settings(robot: Any) -> dict[str, Any]:
    """The compiler's settings of the robot, as a recipe has them; robosuite finds meshes by the folder of each file."""
    compiler = robot.root.find("compiler")
    attributes = {} if compiler is None else compiler.attrib
    return {name: yaml.safe_load(value) for name, value in attributes.items() if name != "meshdir"}


def _options(part: Any) -> list[str]:
    """What to leave out of a part that has options: robosuite keeps those of the robot."""
    return ["option"] if ElementTree.parse(part.file).getroot().find("option") is not None else []


def _joint_edits(robot: Any) -> list[dict[str, Any]]:
    """What the classes of robosuite write into the joints of a robot."""
    edits = []
    for joint, name in zip(robot._elements["joints"], robot._joints, strict=True):
        values = {each: float(joint.get(each)) for each in _JOINT_SETTINGS if joint.get(each) is not None}
        edits.append({"select": {"joint": name}, "set": values})
    return edits


def _materials(part: Any) -> list[dict[str, Any]]:
    """Edits that take the material from the geoms that robosuite colors: a mount names one that is nowhere."""
    colored = {geom.get("name") for geom in part.worldbody.iter("geom") if geom.get("material") is None}
    geoms = ElementTree.parse(part.file).getroot().iter("geom")
    names = [geom.get("name") for geom in geoms if geom.get("material") is not None]
    return [
        {"select": {"geom": name}, "set": {"material": None}}
        for name in names
        if f"{part.naming_prefix}{name}" in colored
    ]


def _repeated_assets(part: Any) -> list[dict[str, Any]]:
    """Edits that remove assets of a name that an asset before them has: robosuite keeps the first."""
    assets = ElementTree.parse(part.file).getroot().iterfind("asset/*")
    named = [asset for asset in assets if asset.get("name")]
    counts: Counter[tuple[str, str | None]] = Counter()
    edits = []
    for asset in named:
        key = (asset.tag, asset.get("name"))
        if counts[key]:
            edits.append({"select": {asset.tag: key[1], "where": {"file": asset.get("file")}}, "remove": True})
        counts[key] += 1
    return edits


def _place(gripper: Any, robot: Any, arm: str) -> list[dict[str, Any]]:
    """The place of the gripper on the hand, which robosuite's simulated robot writes to its first body."""
    body = gripper.worldbody.find("body")
    name = body.get("name").removeprefix(gripper.naming_prefix)
    edits = []
    for key, places in (("pos", robot.gripper_mount_pos_offset), ("quat", robot.gripper_mount_quat_offset)):
        if arm in places:
            numbers = [float(number) for number in places[arm]]
            body.set(key, " ".join(map(repr, numbers)))
            edits.append({"select": {"body": name}, "set": {key: numbers}})
    return edits


def import_models(folder: Path) -> None:
    """Make robosuite's models importable, with nothing in the modules that they do not need."""
    if "robosuite" in sys.modules:
        return
    top = folder / "robosuite"

    def module(name: str, **members: Any) -> types.ModuleType:
        made = types.ModuleType(name)
        vars(made).update(members)
        sys.modules[name] = made
        return made

    macros = module("robosuite.macros", USING_INSTANCE_RANDOMIZATION=False, SIMULATION_TIMESTEP=0.002)
    models = module("robosuite.models", __path__=[str(top / "models")], assets_root=str(top / "models" / "assets"))
    module("robosuite", __path__=[str(top)], macros=macros, models=models)
    module("robosuite.utils.numba", jit_decorator=lambda function: function)
    module("robosuite.models.grippers.gripper_tester", GripperTester=None)

"""All targets, the programs that `build --target` writes models for, and their features, with tables for the docs."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

from mjcompose.base.extensions import ExtensionTable, check_rows
from mjcompose.language.target_names import MUJOCO, NAMES
from mjcompose.targets import restrictions as limits, ros2, simulators
from mjcompose.targets.target import Draft, FeatureOutcome, Limit, Target, write_mjcf
from mjcompose.targets.urdf import write_urdf

# The plainest MJCF, for programs that have no target of their own.
PLAIN = Target(
    "plain",
    "MJCF without frames, classes, replicates and flexcomps, with inertias and OBJ meshes",
    (),
    write=write_mjcf,
    package="mujoco",
)

# Drake. Its parser of MJCF reads bodies, joints, geoms, motors, position servos and `connect`.
# Drake 1.51 uses the control range of a position servo, which is in radians, as the range of its torque. With
# `ctrllimited` alone, the torque is limited to zero, which it refuses.
_NO_CONTROL_RANGE = limits.without_attribute(
    "control ranges",
    "actuator/position",
    "ctrlrange",
    what="`ctrlrange`",
    why="the program would take it for the range of the force",
    also=("ctrllimited",),
)

DRAKE = Target(
    "drake",
    "Drake, through its MJCF parser",
    (
        limits.NO_REFERENCES,
        limits.SINGLE_JOINTS,
        limits.NO_EMPTY_INERTIA,
        limits.NO_KEYS,
        limits.NO_SENSORS,
        limits.NO_CAMERAS,
        limits.NO_LIGHTS,
        limits.NO_SITES,
        limits.NO_TENDONS,
        limits.NO_PAIRS,
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_CUSTOM,
        limits.NO_POLYNOMIALS,
        limits.NO_SPRINGS,
        limits.NO_FRICTION,
        limits.NO_JOINT_EFFORT,
        *limits.unread_in("free", "damping"),
        limits.no_shapes("hfield"),
        limits.NO_HIDDEN_SHAPES,
        limits.NO_TEXTURES,
        limits.servos("motor", "position"),
        _NO_CONTROL_RANGE,
        limits.AT_JOINTS,
        limits.SYMMETRIC_FORCES,
        limits.NO_SERVO_DAMPING,
        limits.NO_DELAY,
        limits.NO_ACTUATOR_ARMATURE,
        limits.NO_ACTUATOR_DAMPING,
        limits.REFLECTED_ARMATURE,
        limits.left_out("equality", "equality/*", but=("connect",), why="what they couple moves freely"),
        limits.COMPUTING,
        limits.GRAVCOMP,
        limits.BITS,
        limits.SOFTNESS,
        limits.unread_contacts("torsional", "rolling"),
    ),
    write=write_mjcf,
    package="drake",
)

# Pinocchio. It reads one body in the world, and one joint in each body.
PINOCCHIO = Target(
    "pinocchio",
    "Pinocchio, through its MJCF parser",
    (
        limits.one_root(with_free=True),
        limits.NO_REFERENCES,
        limits.SINGLE_JOINTS,
        limits.NO_KEYS,
        limits.NO_SENSORS,
        limits.NO_CAMERAS,
        limits.NO_LIGHTS,
        limits.NO_TENDONS,
        limits.NO_EQUALITY,
        limits.NO_PAIRS,
        limits.NO_EXCLUDES,
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_CUSTOM,
        limits.NO_POLYNOMIALS,
        limits.NO_SPRINGS,
        *limits.unread_in("free", "damping", "frictionloss"),
        *limits.unread_in("ball", "damping", "frictionloss"),
        limits.no_shapes("hfield"),
        limits.CARRIED_FORCES,
        limits.servos(),
        limits.COMPUTING,
        limits.GRAVITY,
        limits.GRAVCOMP,
        limits.BITS,
        limits.SOFTNESS,
        limits.unread_contacts("sliding", "torsional", "rolling"),
    ),
    write=write_mjcf,
    package="pin",
)

# PyBullet. It reads bodies, joints and geoms, and places a body in the world by its center of mass.
PYBULLET = Target(
    "pybullet",
    "PyBullet, through its MJCF parser",
    (
        limits.refused(
            "ball", ".//joint[@type='ball']", "PyBullet has no ball joints in MJCF", help="convert it to three hinges"
        ),
        limits.one_root(with_free=False),
        limits.NO_REFERENCES,
        limits.SINGLE_JOINTS,
        limits.NO_KEYS,
        limits.NO_SENSORS,
        limits.NO_CAMERAS,
        limits.NO_LIGHTS,
        limits.NO_SITES,
        limits.NO_TENDONS,
        limits.NO_EQUALITY,
        limits.NO_PAIRS,
        limits.NO_EXCLUDES,
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_CUSTOM,
        limits.NO_DAMPING,
        limits.NO_FRICTION,
        limits.NO_ARMATURE,
        limits.NO_EFFORT,
        limits.NO_SPRINGS,
        limits.no_shapes("ellipsoid", "hfield"),
        limits.servos(),
        limits.COMPUTING,
        limits.GRAVITY,
        limits.GRAVCOMP,
        limits.SOFTNESS,
        limits.unread_contacts(but=("condim",)),
    ),
    write=write_mjcf,
    package="pybullet",
)

# Newton. It merges several joints of a body into one, and does not read flexes.
_MASS = "1e-10"
"""Newton's MuJoCo solver needs moving bodies to have mass."""

NEWTON = Target(
    "newton",
    "Newton, through its MJCF parser",
    (
        limits.NO_REFERENCES,
        limits.single_joints(_MASS),
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_POLYNOMIALS,
        limits.NO_YIELD,
        *limits.unread_in("free", "damping", "armature", "frictionloss"),
        limits.CARRIED_FORCES,
        limits.GEARS,
        limits.GRAVITY,
    ),
    write=write_mjcf,
    package="newton",
)


# Genesis. It reads MJCF with MuJoCo.
def _without_armature(draft: Draft) -> None:
    """Report the joints to which Genesis 1.4 gives an armature of 0.1 by default."""
    for joint in draft.root.iterfind(".//joint"):
        if joint.get("type") != "free" and float(joint.get("armature") or 0) == 0:
            why = "it adds an armature of 0.1 unless you load it with `default_armature=None`"
            draft.lose("no armature", joint, why, outcome=FeatureOutcome.WRITTEN)


def _springs(draft: Draft) -> None:
    """Leave out springs that do not rest at zero: Genesis 1.4 ignores `springref`."""
    for number, joint in draft.of("joint"):
        rests = draft.model.qpos_spring[draft.model.jnt_qposadr[number]]
        if draft.model.jnt_stiffness[number] and joint.get("type") in ("hinge", "slide") and rests:
            joint.attrib.pop("stiffness", "")
            draft.lose("springs", joint, "it has springs that rest at zero", what="stiffness")


GENESIS = Target(
    "genesis",
    "Genesis, which reads MJCF with MuJoCo",
    (
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_CUSTOM,
        limits.NO_KEYS,
        limits.NO_SENSORS,
        limits.NO_CAMERAS,
        limits.NO_LIGHTS,
        limits.NO_PAIRS,
        limits.NO_POLYNOMIALS,
        limits.NO_YIELD,
        Limit("springs", FeatureOutcome.PARTLY, _springs),
        limits.no_shapes("hfield"),
        limits.CARRIED_FORCES,
        limits.AT_JOINTS,
        limits.ONE_FOR_EACH_JOINT,
        limits.left_out("equality", "equality/tendon"),
        limits.NO_TENDONS,
        Limit("no armature", FeatureOutcome.WRITTEN, _without_armature),
        limits.GRAVCOMP,
    ),
    write=write_mjcf,
    package="genesis-world",
)

# MJX, MuJoCo in JAX. It refuses to load a model with a feature that it does not support.
MJX = Target(
    "mjx",
    "MJX, MuJoCo in JAX",
    (
        simulators.MJX_SOFT,
        limits.NO_PLUGINS,
        limits.NO_POLYNOMIALS,
        limits.NO_YIELD,
        limits.NO_ACTUATOR_ARMATURE,
        limits.NO_ACTUATOR_DAMPING,
        limits.NO_DELAY,
        simulators.MJX_COLLISIONS,
        simulators.MJX_MARGINS,
        simulators.MJX_PAIR_MARGINS,
        simulators.MJX_ACTUATORS,
        simulators.MJX_EQUALITY,
        simulators.MJX_SENSORS,
        simulators.MJX_CONTACT_SENSORS,
        simulators.MJX_OPTIONS,
    ),
    write=write_mjcf,
    package="mujoco-mjx",
)

# MuJoCo Warp, MuJoCo on NVIDIA GPUs. It refuses to load a model with a feature that it does not support.
WARP = Target(
    "warp",
    "MuJoCo Warp, MuJoCo on GPUs of NVIDIA",
    (
        limits.NO_YIELD,
        simulators.WARP_ACTUATORS,
        simulators.WARP_EQUALITY,
        simulators.WARP_SENSORS,
        simulators.WARP_OPTIONS,
        simulators.WARP_PLUGINS,
        simulators.WARP_FLEXES,
        simulators.WARP_BESIDE_FLEXES,
        simulators.WARP_VELOCITIES,
        simulators.WARP_ACTUATOR_PLUGINS,
        simulators.WARP_SLEEP,
    ),
    write=write_mjcf,
    package="mujoco-warp",
)

# Isaac Sim, through its MJCF importer.
ISAAC = Target(
    "isaac",
    "Isaac Sim, through its MJCF importer",
    (limits.NO_KEYS, limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_CUSTOM),
    write=write_mjcf,
)


# A ROS package with URDF, `ros2_control` and SRDF. Its writer records these losses, so no function looks for them.
_IN_WRITING = tuple(
    Limit(feature, outcome, lambda _draft: None)
    for feature, outcome in (
        ("roots", FeatureOutcome.WRITTEN),
        ("shapes", FeatureOutcome.LEFT_OUT),
        ("armature", FeatureOutcome.LEFT_OUT),
        ("equality", FeatureOutcome.PARTLY),
        ("keys", FeatureOutcome.PARTLY),
    )
)

URDF = Target(
    "urdf",
    "URDF, in a ROS package with `ros2_control` and SRDF",
    (
        limits.refused("ball", ".//joint[@type='ball']", "URDF has no ball joints", help="convert it to three hinges"),
        *_IN_WRITING,
        limits.servos("motor", "position", "velocity"),
        limits.ONE_FOR_EACH_JOINT,
        limits.AT_JOINTS,
        limits.SYMMETRIC_EFFORTS,
        limits.NO_DELAY,
        limits.NO_ACTUATOR_ARMATURE,
        limits.NO_ACTUATOR_DAMPING,
        limits.NO_POLYNOMIALS,
        limits.NO_SENSORS,
        limits.NO_CAMERAS,
        limits.NO_LIGHTS,
        limits.NO_TENDONS,
        limits.NO_PAIRS,
        limits.NO_SOFT,
        limits.NO_PLUGINS,
        limits.NO_CUSTOM,
        limits.NO_SPRINGS,
        limits.COMPUTING,
        limits.GRAVITY,
        limits.GRAVCOMP,
        limits.BITS,
        limits.SOFTNESS,
        limits.unread_contacts("sliding", "torsional", "rolling"),
    ),
    write=write_urdf,
    package="pin",
)

# A ROS package that simulates the MJCF. Its writer records the losses of its URDF.
ROS2 = Target(
    "ros2",
    "ROS 2, a package for `mujoco_ros2_control` with MJCF, URDF, controllers and a launch file",
    (
        limits.refused("ball", ".//joint[@type='ball']", "URDF has no ball joints", help="convert it to three hinges"),
        Limit("names", FeatureOutcome.WRITTEN, ros2.name_joints),
        Limit("actuators", FeatureOutcome.PARTLY, ros2.refuse_actuators),
        Limit("gears", FeatureOutcome.WRITTEN, ros2.move_controls_to_joints),
        *(
            Limit(feature, outcome, lambda _draft: None)
            for feature, outcome in (
                ("roots", FeatureOutcome.WRITTEN),
                ("shapes", FeatureOutcome.PARTLY),
                ("equality", FeatureOutcome.PARTLY),
                ("sensors", FeatureOutcome.PARTLY),
                ("cameras", FeatureOutcome.LEFT_OUT),
            )
        ),
    ),
    write=ros2.write_ros2,
)

ALL = (PLAIN, DRAKE, PINOCCHIO, PYBULLET, NEWTON, GENESIS, MJX, WARP, ISAAC, URDF, ROS2)


FEATURES: Mapping[str, str] = {
    "names": "joints without a name",
    "roots": "several bodies in the world",
    "joints": "several joints of one body",
    "ball": "ball joints",
    "references": "joints that are not at zero in the model as it is written",
    "massless": "bodies without mass",
    "damping": "damping of joints",
    "polynomials": "damping and stiffness that are not linear",
    "springs": "stiffness of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "no armature": "joints without armature",
    "effort": "limits of forces: `forcerange`, `actuatorfrcrange`",
    "shapes": "planes, ellipsoids, height fields",
    "textures": "textures",
    "sites": "sites",
    "cameras": "cameras",
    "lights": "lights",
    "collisions": "contacts between shapes of all kinds",
    "margins": "margins of contacts with meshes and height fields",
    "pairs": "contact pairs",
    "excludes": "excluded contacts",
    "equality": "equality constraints",
    "tendons": "tendons",
    "actuators": "actuators",
    "gears": "gears of actuators",
    "gains": "damping of position servos: `kv`",
    "control ranges": "ranges of the controls of position servos",
    "sensors": "sensors",
    "contact sensors": "contact sensors of all kinds",
    "keys": "keyframes",
    "soft": "flexes and skins",
    "sleep": "`sleep` of bodies",
    "plugins": "plugins",
    "gravity": "gravity that is not 0 0 -9.81",
    "gravcomp": "gravity compensation of bodies",
    "contacts": "softness, margins and friction of contacts",
    "bits": "collision filters: `contype` and `conaffinity`",
    "softness": "softness and margins of joint limits",
    "computing": "time step, integrator, friction cone, medium, flags",
    "options": "all integrators and solvers",
    "custom": "custom numbers, texts and tuples",
}
"""Descriptions by name."""

COMPARED: Mapping[str, str] = {
    "inertia": "masses, centers of mass, inertias",
    "poses": "poses of all bodies in 50 configurations",
    "limits": "limits of joints",
    "damping": "damping of joints",
    "friction": "dry friction of joints",
    "armature": "armature of joints",
    "springs": "stiffness of joints",
    "effort": "greatest forces of joints and actuators",
    "actuators": "joint of each actuator",
    "gains": "gains of servos",
    "shapes": "number of geoms of each type",
    "motion": "0.2 s of motion from the key `home`",
    "control ranges": "ranges of controls at the joints",
    "forces": "forces of the joints under full control",
    "driven": "0.2 s of motion under control",
}
"""The words for quantities that are compared when a model is read back, by name."""


TARGETS: ExtensionTable[Target] = ExtensionTable("targets", {each.name: each for each in ALL}, "TARGET", kind=Target)

check_rows("the targets of composer/mjcompose/targets/table.py", [MUJOCO, *TARGETS.own], NAMES)
_used = dict.fromkeys(limit.feature for target in TARGETS.values() for limit in target.limits)
check_rows("the features of composer/mjcompose/targets/table.py", FEATURES, _used)


_ROOT = Path(__file__).resolve().parents[3]
PAGE = _ROOT / "docs" / "how-to" / "simulators.md"
READ_BACK = _ROOT / "tests" / "targets" / "read_back.json"
"""The features that the programs have read, by `tests/targets/read_back.py`."""


_CELLS: Mapping[FeatureOutcome, str] = {
    FeatureOutcome.KEPT: "",
    FeatureOutcome.WRITTEN: "rewritten",
    FeatureOutcome.PARTLY: "partly",
    FeatureOutcome.LEFT_OUT: "no",
    FeatureOutcome.SOME_REFUSED: "some",
    FeatureOutcome.REFUSED: "error",
}


def features() -> str:
    """Return the table with a row for each feature that some target does not support. Other cells are empty."""
    lines = [f"| feature | {' | '.join(TARGETS)} |", f"|---|{'---|' * len(TARGETS)}"]
    outcomes = {name: outcomes_of(target) for name, target in TARGETS.items()}
    for feature, words in FEATURES.items():
        cells = [outcomes[name].get(feature, FeatureOutcome.KEPT) for name in TARGETS]
        if set(cells) != {FeatureOutcome.KEPT}:
            lines.append(f"| {words} | {' | '.join(_CELLS[each] for each in cells)} |")
    return "\n".join(lines) + "\n"


def outcomes_of(target: Target) -> Mapping[str, FeatureOutcome]:
    """Return the outcome of each feature: the worst one, if several limits are about it."""
    found: dict[str, FeatureOutcome] = {}
    for limit in target.limits:
        found[limit.feature] = max(
            limit.outcome, found.get(limit.feature, FeatureOutcome.KEPT), key=list(FeatureOutcome).index
        )
    return found


def read_back() -> str:
    found = json.loads(READ_BACK.read_text(encoding="utf-8"))
    lines = [f"| compared | {' | '.join(found)} |", f"|---|{'---|' * len(found)}"]
    lines.append(f"| version | {' | '.join(each['version'] for each in found.values())} |")
    for feature, words in COMPARED.items():
        lines.append(f"| {words} | {' | '.join(each.get(feature, '') for each in found.values())} |")
    return "\n".join(lines) + "\n"


def with_tables(page: str) -> str:
    for name, table in (("features", features()), ("read back", read_back())):
        inside = re.compile(rf"(?<=<!-- {name} -->\n).*?(?=<!-- end of {name} -->)", re.DOTALL)
        page = inside.sub(table.replace("\\", r"\\"), page)
    return page


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")

"""Target: Genesis. It reads MJCF with MuJoCo."""

from __future__ import annotations

from mjcompose.targets.restrictions import (
    AT_JOINTS,
    CARRIED_FORCES,
    NO_CAMERAS,
    NO_CUSTOM,
    NO_KEYS,
    NO_LIGHTS,
    NO_PAIRS,
    NO_PLUGINS,
    NO_POLYNOMIALS,
    NO_SENSORS,
    NO_SOFT,
    NO_TENDONS,
    NO_YIELD,
    ONE_FOR_EACH_JOINT,
    left_out,
    no_shapes,
)
from mjcompose.targets.solver import GRAVCOMP
from mjcompose.targets.target import Draft, Limit, Outcome, Target, write_mjcf


def _without_armature(draft: Draft) -> None:
    """Report the joints to which Genesis 1.4 gives an armature of 0.1 by default."""
    for joint in draft.root.iterfind(".//joint"):
        if joint.get("type") != "free" and float(joint.get("armature") or 0) == 0:
            why = "it adds an armature of 0.1 unless you load it with `default_armature=None`"
            draft.lose("no armature", joint, why, outcome=Outcome.WRITTEN)


def _springs(draft: Draft) -> None:
    """Leave out springs that do not rest at zero: Genesis 1.4 ignores `springref`."""
    for number, joint in draft.of("joint"):
        rests = draft.model.qpos_spring[draft.model.jnt_qposadr[number]]
        if draft.model.jnt_stiffness[number] and joint.get("type") in ("hinge", "slide") and rests:
            joint.attrib.pop("stiffness", "")
            draft.lose("springs", joint, "it has springs that rest at zero", what="stiffness")


TARGET = Target(
    "genesis",
    "Genesis, which reads MJCF with MuJoCo",
    (
        NO_SOFT, NO_PLUGINS, NO_CUSTOM, NO_KEYS, NO_SENSORS, NO_CAMERAS, NO_LIGHTS, NO_PAIRS, NO_POLYNOMIALS, NO_YIELD,
        Limit("springs", Outcome.PARTLY, _springs), no_shapes("hfield"), CARRIED_FORCES, AT_JOINTS, ONE_FOR_EACH_JOINT,
        left_out("equality", "equality/tendon"), NO_TENDONS, Limit("no armature", Outcome.WRITTEN, _without_armature),
        GRAVCOMP,
    ),
    write=write_mjcf,
    package="genesis-world",
)  # fmt: skip

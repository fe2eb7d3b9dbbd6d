"""Target: Genesis. It reads MJCF with MuJoCo."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
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
    "genesis", "Genesis, which reads MJCF with MuJoCo", (
        limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_CUSTOM, limits.NO_KEYS, limits.NO_SENSORS, limits.NO_CAMERAS,
        limits.NO_LIGHTS, limits.NO_PAIRS, limits.NO_POLYNOMIALS, limits.NO_YIELD,
        Limit("springs", Outcome.PARTLY, _springs), limits.no_shapes("hfield"), limits.CARRIED_FORCES, limits.AT_JOINTS,
        limits.ONE_FOR_EACH_JOINT, limits.left_out("equality", "equality/tendon"), limits.NO_TENDONS,
        Limit("no armature", Outcome.WRITTEN, _without_armature), GRAVCOMP,
    ), write=write_mjcf, package="genesis-world",
)  # fmt: skip

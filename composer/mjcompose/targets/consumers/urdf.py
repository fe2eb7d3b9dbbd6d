"""Target: a ROS package with URDF, `ros2_control` and SRDF."""

from __future__ import annotations

from mjcompose.targets import restrictions as limits
from mjcompose.targets.solver import BITS, COMPUTING, GRAVCOMP, GRAVITY, SOFTNESS, unread_contacts
from mjcompose.targets.target import Draft, Limit, Outcome, Target
from mjcompose.targets.urdf import write_urdf


def _found_in_writing(_draft: Draft) -> None:
    """Do nothing: the writer records each loss."""


_IN_WRITING = tuple(
    Limit(feature, outcome, _found_in_writing)
    for feature, outcome in (
        ("roots", Outcome.WRITTEN), ("shapes", Outcome.LEFT_OUT), ("armature", Outcome.LEFT_OUT),
        ("effort", Outcome.PARTLY), ("equality", Outcome.PARTLY), ("actuators", Outcome.PARTLY),
    )
)  # fmt: skip

TARGET = Target(
    "urdf", "URDF, in a ROS package with `ros2_control` and SRDF", (
        limits.refused("ball", ".//joint[@type='ball']", "URDF has no ball joints", help="convert it to three hinges"),
        *_IN_WRITING, limits.NO_POLYNOMIALS, limits.NO_SENSORS, limits.NO_CAMERAS, limits.NO_LIGHTS, limits.NO_TENDONS,
        limits.NO_PAIRS, limits.NO_SOFT, limits.NO_PLUGINS, limits.NO_CUSTOM, limits.NO_SPRINGS, COMPUTING, GRAVITY,
        GRAVCOMP, BITS, SOFTNESS, unread_contacts("sliding", "torsional", "rolling"),
    ), write=write_urdf, package="pin",
)  # fmt: skip

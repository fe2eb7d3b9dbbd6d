"""The form of the kinematics calibration of a Universal Robots arm, as `ur_calibration` writes it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.language.forms.model import Model

_Length = Annotated[float, Field(ge=-5, le=5)]
_Turn = Annotated[float, Field(ge=-2 * math.pi, le=2 * math.pi)]


class CalibratedPose(Model):
    """The pose of a link in the link before it, at the zero of its joint."""

    example: ClassVar = "{x: 0, y: 0, z: 0.1625, roll: 0, pitch: 0, yaw: 0}"

    x: _Length
    """meters along x"""
    y: _Length
    """meters along y"""
    z: _Length
    """meters along z"""
    roll: _Turn
    """the first rotation, about x, in radians"""
    pitch: _Turn
    """the second rotation, about y, in radians"""
    yaw: _Turn
    """the third rotation, about z, in radians"""


class CalibratedKinematics(Model):
    """The poses of the six links."""

    example: ClassVar = f"{{shoulder: {CalibratedPose.example}}}"

    shoulder: CalibratedPose
    """the pose of the shoulder in the base"""
    upper_arm: CalibratedPose
    """the pose of the upper arm in the shoulder"""
    forearm: CalibratedPose
    """the pose of the forearm in the upper arm"""
    wrist_1: CalibratedPose
    """the pose of the first wrist in the forearm"""
    wrist_2: CalibratedPose
    """the pose of the second wrist in the first one"""
    wrist_3: CalibratedPose
    """the pose of the third wrist, whose origin is the flange, in the second one"""
    hash: Any = None
    """the identity of the calibration, which the controller has, too"""

    @property
    def poses(self) -> Iterator[tuple[str, CalibratedPose]]:
        """Yield the name of each link in ROS, and its pose."""
        for name, pose in self:
            if isinstance(pose, CalibratedPose):
                yield f"{name}_link", pose


class UrCalibration(Model):
    """The kinematics calibration of a Universal Robots arm."""

    owned: ClassVar = "a calibration"

    kinematics: CalibratedKinematics
    """the poses of the six links"""

    @classmethod
    def subject(cls, at: tuple[str | int, ...]) -> str:
        return super().subject(at) if at else "the calibration"

"""The form of the check `tracks`: the model moves as a recording of the robot."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.model import AnyOf
from mjcompose.language.forms.scalars import LENGTHS, Scaled, Text

_ANGLES = {"mrad": 1e-3, "rad": 1.0, "deg": 0.017453292519943295}


class TrackedErrors(CheckPart):
    """The largest root mean square errors."""

    rules: ClassVar = (
        AnyOf(
            "qpos",
            "qvel",
            "sensor",
            lacks="names no signal",
            advice="write for instance `within: {qpos: 2mrad}`",
        ),
    )
    example: ClassVar = "{qpos: 2mrad}"

    qpos: Annotated[float, Scaled({**_ANGLES, **LENGTHS}, gt=0)] | None = None
    """the largest error of a position, in rad or m"""
    qvel: Annotated[float, Field(gt=0)] | None = None
    """the largest error of a speed, in rad/s or m/s"""
    sensor: Annotated[float, Field(gt=0)] | None = None
    """the largest error of a number of a sensor, in its unit"""


class Tracks(Check):
    """The model follows a recording of the robot, from the start that fits best."""

    word: ClassVar = "tracks"
    is_in_mujoco: ClassVar = False
    example: ClassVar = "{recording: run3.csv, within: {qpos: 2mrad}}"

    recording: Text = Field(examples=["run3.csv"])
    """the recording, relative to the recipe; `identify: {recording: …}` says how to read it"""
    within: TrackedErrors = Field(examples=["{qpos: 2mrad}"])
    """the largest root mean square errors, by kind of signal"""
    worse_than_recipe: Literal["error", "accept"] = "accept"
    """`error` also compares with the model without `measured`: no signal may have an error that is 5 % larger"""

    @property
    def files(self) -> tuple[str, ...]:
        return (self.recording,)


KIND = Tracks

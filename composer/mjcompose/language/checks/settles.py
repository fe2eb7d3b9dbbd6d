"""The form of the check `settles`: a simulation from a keyframe comes to rest."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from mjcompose.language.check import Check, CheckPart
from mjcompose.language.forms.scalars import Name, NumberUnit, Positive


class Near(CheckPart):
    """The expected final positions of all joints."""

    example: ClassVar = "{key: …, within: 0.05}"

    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """a keyframe; by default the start keyframe"""
    within: Positive = Field(examples=["0.05"])
    """the greatest distance of a joint from its position in that keyframe, in m or rad"""


class Settles(Check):
    """The simulation from a keyframe does not diverge, and the model is at rest at the end."""

    word: ClassVar = "settles"
    example: ClassVar = "{key: home}"

    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe to start from; by default the reference configuration"""
    seconds: Annotated[Positive, NumberUnit("s")] = 1.0
    """the length of the simulation"""
    max_speed: Positive = 0.05
    """the greatest speed of a joint in the last tenth of that time, in m/s or rad/s"""
    near: Near | None = None
    """every joint must also end near its position in a keyframe"""


KIND = Settles

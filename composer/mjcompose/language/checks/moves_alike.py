"""The form of the check `moves_alike`: the model moves in another program as it does here."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.check import Check
from mjcompose.language.forms.model import IT
from mjcompose.language.forms.scalars import Checked, Name, NumberUnit, Positive
from mjcompose.language.target_names import READ_IN
from mjcompose.tree.history import RELEASED, release

MUJOCO = "mujoco=="


def _program_fault(text: str) -> Fault | None:
    if text in READ_IN or (text.startswith(MUJOCO) and release(text.removeprefix(MUJOCO))):
        return None
    programs = ", ".join(f"`{each}`" for each in READ_IN)
    help = f"write `mujoco==VERSION`, from {RELEASED[0]} to {RELEASED[-1]}, or one of {programs}"
    return Fault("wrong-keyword", f"{IT} cannot be `{text}`", help=help)


class MovesAlike(Check):
    """The model moves as in another version of MuJoCo, or as in another program."""

    word: ClassVar = "moves_alike"
    is_in_mujoco: ClassVar = False
    short: ClassVar = "as"
    example: ClassVar = "{as: mujoco==3.12}"

    program: Annotated[str, Checked(_program_fault)] = Field(alias="as", examples=["mujoco==3.12"])
    """a version of MuJoCo that `mjcompose install` has installed, such as `mujoco==3.12`, or a target"""
    signal: Literal["qpos", "xpos"] = "qpos"
    """the compared positions: of joints, or of bodies (only for MuJoCo)"""
    seconds: Annotated[float, Field(gt=0, le=60), NumberUnit("s")] = 1.0
    """the length of each simulation, at most 60"""
    tol: Positive = 1e-3
    """the allowed distance, in m or rad"""
    key: Annotated[str, Name("key", what="the name of a keyframe")] | None = None
    """the keyframe from which MuJoCo holds, steps and drops the model; without it, the first one"""


KIND = MovesAlike

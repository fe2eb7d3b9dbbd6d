"""The form of the check `targets`: other programs support everything in the model, and read it correctly."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, TypeAlias

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.check import Check
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import OWNER
from mjcompose.language.forms.scalars import Items
from mjcompose.language.target_names import NAMES, READ_IN

if TYPE_CHECKING:
    Lacking: TypeAlias = str
else:
    Lacking = Literal[NAMES[2:]]  # the targets that lack something of MuJoCo


class Targets(Check):
    """Other programs read the whole model, with the same numbers, poses and motion."""

    word: ClassVar = "targets"
    is_in_mujoco: ClassVar = False
    short: ClassVar = "in"
    short_type: ClassVar = (str, list)
    example: ClassVar = "[mjx, drake]"

    targets: Annotated[tuple[Lacking, ...], Items(1, single=True, unique=True)] = Field(
        alias="in", examples=["[mjx, drake]"]
    )
    """the targets"""
    read: bool = True
    """false only looks for losses; the programs need not be installed"""
    losses: Literal["error", "warning"] = "error"
    """`warning` reports losses as warnings"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        for index, name in enumerate(self.targets if self.read else ()):
            if name not in READ_IN:
                message = f"{OWNER} cannot use `{name}`: no check reads models in it"
                help = f"write `targets: {{in: [{name}], read: false}}`, which checks that nothing is lost"
                yield Fault("wrong-keyword", message, ("in", index), help=help)


KIND = Targets

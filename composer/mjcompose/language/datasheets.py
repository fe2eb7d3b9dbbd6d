"""The section `datasheets`: motors as in their data sheets, and the data sheets that come with mjcompose."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path as File
from typing import Annotated, ClassVar

from pydantic import Field, ValidationError

from mjcompose.base.extensions import ExtensionTable
from mjcompose.language.forms.context import validated
from mjcompose.language.forms.model import Belongs, Exclusive, Model
from mjcompose.language.forms.scalars import Expects, NotNegative, NumberUnit, Positive, Text
from mjcompose.language.forms.translate import faults

_LIBRARY = File(__file__).with_name("datasheets.yaml")


class Sheet(Model):
    """A motor with its gears and controller. Everything but `rotor_inertia` is at the output. None means unknown."""

    rules: ClassVar = (
        Exclusive(
            "armature",
            "rotor_inertia",
            help="leave one out: `armature` is the rotor's inertia times the square of `gear`",
        ),
        Belongs("rotor_inertia", "gear", help="write `gear: 1` where there is none"),
    )
    example: ClassVar = "{effort: 4.1, source: …}"
    called: ClassVar = "data sheet `{}`"

    maker: Text | None = None
    """who makes it"""
    source: Text = Field(examples=["the data sheet"])
    """the origin of these numbers: a data sheet, with its address"""
    effort: Annotated[Positive, NumberUnit("N·m")] = Field(examples=[4.1])
    """the greatest torque at the output, in N·m"""
    rated: Annotated[Positive, NumberUnit("N·m")] | None = None
    """the torque that it can hold, in N·m"""
    speed: Annotated[Positive, NumberUnit("rad/s")] | None = None
    """the speed of the output without load, in rad/s"""
    gear: Positive | None = None
    """the reduction: turns of the rotor for one turn of the output"""
    rotor_inertia: Annotated[Positive, NumberUnit("kg·m²")] | None = None
    """the inertia of the rotor before the reduction, in kg·m²"""
    armature: Annotated[Positive, NumberUnit("kg·m²")] | None = None
    """the inertia of rotor and gears at the output, in kg·m²"""
    friction: Annotated[NotNegative, NumberUnit("N·m")] | None = None
    """the dry friction at the output, in N·m"""
    damping: Annotated[NotNegative, NumberUnit("N·m·s/rad")] | None = None
    """the viscous friction at the output, in N·m·s/rad"""
    delay: Annotated[NotNegative, NumberUnit("s")] | None = None
    """the time from a command to the torque, in seconds"""

    @property
    def reflected(self) -> float | None:
        """The inertia at the output, in kg·m². The rotor's inertia counts with the square of the reduction.

        >>> Sheet(effort=12.0, source="?", gear=10, rotor_inertia=0.25).reflected
        25.0
        """
        if self.armature is not None or self.rotor_inertia is None:
            return self.armature
        return self.rotor_inertia * (self.gear or 1.0) ** 2


Datasheets = Annotated[
    dict[str, Sheet], Expects("a mapping from names to data sheets", "{NAME: {effort: 4.1, source: …}}")
]

SHEETS: ExtensionTable[Sheet] = ExtensionTable("datasheets", {}, "", kind=Sheet)
"""The data sheets of other packages that recipes have named."""


@cache
def library() -> Mapping[str, Sheet]:
    """Return the data sheets that come with mjcompose."""
    from mjcompose.base.sink import Sink  # few recipes name a motor
    from mjcompose.text.load import load
    from mjcompose.text.node import to_python

    sink = Sink()
    node = load(_LIBRARY.read_bytes(), _LIBRARY.name, sink)
    data = {} if node is None else to_python(node)
    try:
        sheets: dict[str, Sheet] = validated(Datasheets, data)
    except ValidationError as error:
        told = [each.message for each in faults(error, Datasheets, data)]
    else:
        told = [each.message for each in sink.diagnostics]
    if told:
        raise ValueError(f"{_LIBRARY}: {told[0]}")
    return sheets

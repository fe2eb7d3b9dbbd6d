"""The form of the verb `datasheet`: the values of a data sheet, as attributes of an actuator and its joint."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from mjcompose.language.assign import Changed
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.forms.model import Exclusive
from mjcompose.language.forms.scalars import Name, NotNegative, NumberUnit, Positive

_CHANGED = (
    *(("actuator", name) for name in "kp kv dampratio forcerange forcelimited delay nsample".split()),
    *(("joint", name) for name in ("armature", "frictionloss", "damping")),
)


class Datasheet(Verb):
    """the torque, gains and armature of a motor, from its data sheet"""

    rules: ClassVar = (
        For(
            "actuator/",
            what="for actuators, and `{tag}` is not an actuator",
            help="select the actuator of the joint: `select: {actuator: NAME}`",
        ),
        Exclusive("bandwidth", "error"),
    )
    example: ClassVar = "{model: NAME, bandwidth: 5}"

    model: Annotated[str, Name("datasheet", what="the name of a data sheet")] = Field(examples=["NAME"])
    """a data sheet of the section `datasheets`, or one that comes with mjcompose"""
    bandwidth: Annotated[Positive, NumberUnit("Hz")] | None = None
    """the bandwidth, in Hz: `kp` and `kv` follow from this and from the inertia at the output"""
    error: Annotated[Positive, NumberUnit("rad")] | None = None
    """the error in rad at which the motor gives its greatest torque, instead of `bandwidth`"""
    damping_ratio: NotNegative | None = None
    """the damping ratio, with `bandwidth`; by default 1"""
    inertia: Annotated[NotNegative, NumberUnit("kg·m²")] | None = None
    """the inertia of the load, without the armature, in kg·m², with `bandwidth`"""
    effort: Literal["peak", "rated"] = "peak"
    """its peak or its rated torque"""

    def words(self) -> str:
        written = {name: getattr(self, name) for name in self.key_names() if name in self.model_fields_set}
        return f"datasheet {self.model}{listed({name: each for name, each in written.items() if name != 'model'})}"

    def changes(self, tag: str | None) -> Changed:
        return _CHANGED


VERB = Datasheet

"""The form of the verb `calibrate`: how one robot differs from its model in ways that no attribute of MJCF says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.language.assign import Changed
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import AnyOf
from mjcompose.language.forms.scalars import Expects, Items, Measure, Scaled
from mjcompose.language.select import kinds_of
from mjcompose.text.expression import Angle

_TIMES = {"ms": 1e-3, "s": 1.0}


class Calibrate(Verb):
    """the zero of a joint, the delay of an actuator, or the inertia of a body, of one robot"""

    rules: ClassVar = (
        For("joint", "actuator/", "body", what="for joints, actuators and bodies, and `{tag}` is none of them"),
        AnyOf(
            "zero",
            "delay",
            "com",
            "shape",
            lacks="says nothing",
            help="write an entry of `edit` for each",
            advice="write `zero: -1.3deg`, or `delay: 20ms`",
        ),
    )
    example: ClassVar = "{zero: -1.3deg}"

    zero: Annotated[float | Angle, Measure()] | None = None
    """the reading of the joint at the place where the model has its zero: an angle, or meters for a slide"""
    delay: Annotated[float, Scaled(_TIMES, ge=0)] | None = None
    """the time from a command to its effect, in seconds"""

    com: Annotated[tuple[float, ...], Items(3, 3), Expects("a list of 3 numbers", "[0.01, 0, 0]")] | None = None
    """the distance of the center of mass from its place in the model, along the axes of the body, in meters"""
    shape: Annotated[tuple[float, ...], Items(6, 6), Expects("a list of 6 numbers", "[0.1, 0, 0, 0, 0, 0]")] | None = (
        None
    )
    """the logarithms of the stretches of the body's mass along its axes, and the shears of x by y, y by z and x by z"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if context.selected is None:
            return
        families = {kind.family for kind in kinds_of(context.selected.tag)}
        for key, family in (("zero", "joint"), ("delay", "actuator"), ("com", "body"), ("shape", "body")):
            if getattr(self, key) is not None and families and family not in families:
                message = f"`{key}` is for a {family}, and `{context.selected.tag}` is none"
                yield Fault("wrong-type", message, (key,), key=True, help=f"select it: `select: {{{family}: NAME}}`")

    def words(self) -> str:
        return f"calibrate{listed({name: getattr(self, name) for name in ('zero', 'delay', 'com', 'shape')})}"

    def changes(self, tag: str | None) -> Changed:
        of_joint = [("joint", name) for name in ("ref", "springref", "range")]
        of_body = [("inertial", name) for name in ("mass", "pos", "quat", "diaginertia", "fullinertia")]
        return [*of_joint, *of_body, ("actuator", "delay"), ("actuator", "nsample")]


VERB = Calibrate

"""The form of the verb `calibrate`: how one robot differs from its model in ways that no attribute of MJCF says."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.language.assign import Changed
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import OneOf
from mjcompose.language.forms.scalars import Measure, Scaled
from mjcompose.language.select import kinds_of
from mjcompose.text.expression import Angle

_TIMES = {"ms": 1e-3, "s": 1.0}


class Calibrate(Verb):
    """the zero of a joint, or the delay of an actuator, of one robot"""

    rules: ClassVar = (
        For("joint", "actuator/", what="for joints and actuators, and `{tag}` is neither"),
        OneOf(
            "zero",
            "delay",
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

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if context.selected is None:
            return
        families = {kind.family for kind in kinds_of(context.selected.tag)}
        for key, family in (("zero", "joint"), ("delay", "actuator")):
            if getattr(self, key) is not None and families and family not in families:
                message = f"`{key}` is for a {family}, and `{context.selected.tag}` is none"
                yield Fault("wrong-type", message, (key,), key=True, help=f"select it: `select: {{{family}: NAME}}`")

    def words(self) -> str:
        return f"calibrate{listed({'zero': self.zero, 'delay': self.delay})}"

    def changes(self, tag: str | None) -> Changed:
        of_joint = [("joint", name) for name in ("ref", "springref", "range")]
        return [*of_joint, ("actuator", "delay"), ("actuator", "nsample")]


VERB = Calibrate

"""Step: a key."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.plan.steps.step import Step, StepInput
from composer.recipe.keyframe import Keyframe


@dataclass(frozen=True, slots=True)
class WriteKeyframe(Step):
    """Write a key by the names of joints, actuators and mocap bodies, replacing an existing key of that name."""

    sections: ClassVar[tuple[str, ...]] = ("keyframe",)
    key: Keyframe
    span: Span

    @classmethod
    def of(cls, given: StepInput) -> Iterator[Step]:
        for key in given.recipe.keyframe:
            yield cls(key, given.span(key.at, key=True))

    @property
    def words(self) -> str:
        return f"write the keyframe {self.key.name}"

    @property
    def reason(self) -> str:
        return self.words

"""All types of steps in the order in which they are carried out: settings, classes, and the steps that may use them."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

from mjcompose.base.extensions import check_rows
from mjcompose.build.plan.steps import (
    AddElement,
    AppendElement,
    DrawValues,
    EditElements,
    OrderElements,
    SetCollisions,
    SetDefault,
    SetSingleton,
    Step,
    StepInput,
    WriteKeyframe,
)
from mjcompose.language.recipe import SETTLED, Recipe

STEPS: tuple[type[Step], ...] = (
    AddElement,
    SetSingleton,
    SetDefault,
    AppendElement,
    EditElements,
    DrawValues,
    WriteKeyframe,
    SetCollisions,
    OrderElements,
)
# Keys that the planner reads itself: settings of the whole recipe, its sources and its checks.
_PLANNED = "recipe name description angle eulerseq separator conflict allow base attach check datasheets".split()

for _each in STEPS:
    if inspect.isabstract(_each):
        raise TypeError(f"the step {_each.__name__} lacks {', '.join(sorted(_each.__abstractmethods__))}")
check_rows(
    "the keys of a recipe in composer/mjcompose/build/plan/step_table.py",
    [*_PLANNED, *(section for each in STEPS for section in each.sections)],
    [key for key in Recipe.model_fields if key not in SETTLED],
)


def steps_of(given: StepInput) -> Iterator[Step]:
    """Yield the steps of a recipe, in the order in which they are carried out."""
    for each in STEPS:
        yield from each.of(given)

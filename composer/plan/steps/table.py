"""All types of steps in the order in which they are carried out: settings, classes, and what may use them."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

from composer.plan.steps.add_element import AddElement
from composer.plan.steps.append_element import AppendElement
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.plan.steps.set_collisions import SetCollisions
from composer.plan.steps.set_default import SetDefault
from composer.plan.steps.set_singleton import SetSingleton
from composer.plan.steps.step import Step, StepInput
from composer.plan.steps.write_keyframe import WriteKeyframe
from composer.recipe.recipe import Recipe
from composer.recipe.rows import check_rows

STEPS: tuple[type[Step], ...] = (
    AddElement,
    SetSingleton,
    SetDefault,
    AppendElement,
    EditElements,
    DrawValues,
    WriteKeyframe,
    SetCollisions,
)
# Keys that the planner reads itself: settings of the whole recipe, and what is composed and verified.
_PLANNED = "recipe name description angle eulerseq separator conflict allow base attach check motors".split()

for _each in STEPS:
    if inspect.isabstract(_each):
        raise TypeError(f"the step {_each.__name__} lacks {', '.join(sorted(_each.__abstractmethods__))}")
check_rows(
    "the keys of a recipe in composer/plan/steps/table.py",
    [*_PLANNED, *(section for each in STEPS for section in each.sections)],
    Recipe.model_fields,
)


def steps_of(given: StepInput) -> Iterator[Step]:
    """Yield the steps of a recipe, in the order in which they are carried out."""
    for each in STEPS:
        yield from each.of(given)

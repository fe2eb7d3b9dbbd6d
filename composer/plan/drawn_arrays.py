"""The arrays of `mjModel` that may differ between the samples of a recipe."""

from __future__ import annotations

from collections.abc import Set as AbstractSet

from composer.compiled.affected_arrays import arrays_of
from composer.plan.steps.draw_values import DrawValues
from composer.recipe.subscript import attribute_and_index


def arrays_of_draw(step: DrawValues) -> AbstractSet[str]:
    """Return the arrays that a draw affects."""
    name, _ = attribute_and_index(step.field.attr)
    tag = step.field.select.tag if step.field.select is not None else None
    # Actuators with `inheritrange` copy the range of their joint.
    following = {"actuator_ctrlrange"} if name == "range" else set()
    return following.union(arrays_of(name, tag))

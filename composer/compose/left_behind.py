"""What the subtrees of a plan leave behind, found without composing more than they are taken of."""

from __future__ import annotations

from collections.abc import Mapping

from composer.compose.compose import Composer
from composer.context import Context
from composer.link.measure import measure_with
from composer.link.subtree import Subtree
from composer.plan.plan import Plan
from composer.recipe.fault import Path


def left_behind(plan: Plan, context: Context) -> Mapping[tuple[str, Path], Subtree]:
    """Every subtree by its recipe and the path to its model there; faults go to the context's sink."""
    composer = Composer(context, measure_with(context))
    composer.look(plan)
    return composer.subtrees

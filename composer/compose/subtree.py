"""Step: take only one body of a base or a part. The list of what is left behind is kept for later questions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import locate
from composer.link.linking import Measure
from composer.link.request import KeyPolicy
from composer.plan.plan import BASE, Plan, part_name, stands_in_world
from composer.recipe.drop import Drop
from composer.recipe.edit import Edit
from composer.recipe.fault import Path
from composer.sources.source import Source
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from composer.link.subtree import Subtree


@dataclass(frozen=True, slots=True)
class PartRequest:
    """A model of a plan, base or part, and the name of the body to take; None for the whole model.

    `at` is the path to the model's mapping in the recipe, `span` the place of `subtree`. `stands` is set if the
    model is fixed in the world of the final model.
    """

    model: Source | Plan | None
    body: str | None
    at: Path
    keyframes: KeyPolicy
    span: Span
    stands: bool
    drop: tuple[Drop, ...] = ()
    edit: tuple[Edit, ...] = ()

    def take(self, unit: Unit, sink: Sink, measure: Measure | None) -> Subtree | None:
        """Reduce the unit to the body. Return None after a reported error if that is impossible."""
        from composer.link.subtree import take_subtree  # few recipes need it

        assert self.body is not None
        found = take_subtree(unit, self.body, sink, span=self.span, keyframes=self.keyframes, measure=measure)
        if found is not None and found.cut:
            _report_cut(unit, found, sink, span=self.span)
        return found


def part_requests(plan: Plan, stands: bool) -> Iterator[PartRequest]:
    """Yield the requests for the base of a plan and for its parts, in their order.

    `stands` says whether the model of the plan is fixed in the world.
    """
    base, document = plan.base, plan.document
    span = locate(document, ("base", "subtree"))
    key_sources = plan.key_sources
    keyframes: KeyPolicy = "merge" if BASE in key_sources else base.keyframes
    yield PartRequest(
        base.model,
        base.subtree,
        (BASE,),
        keyframes=keyframes,
        span=span,
        stands=stands,
        drop=base.drop,
        edit=base.edit,
    )
    for step in plan.parts:
        part = step.attachment
        span = locate(document, (*step.at, "subtree"))
        keyframes = "merge" if part_name(step, plan.separator) in key_sources else part.keyframes
        inside = stands and stands_in_world(part)
        yield PartRequest(
            step.model,
            part.subtree,
            step.at,
            keyframes=keyframes,
            span=span,
            stands=inside,
            drop=part.drop,
            edit=part.edit,
        )


def _report_cut(unit: Unit, found: Subtree, sink: Sink, span: Span) -> None:
    """What concerns the subtree and something else is left; nobody should miss that."""
    alone = len(found.cut) == 1
    what = f"the {found.cut[0].called}" if alone else f"{len(found.cut)} elements"
    sink.warning(
        "subtree-cut",
        f"the subtree `{found.body}` of `{unit.label}` comes without {what}, which {'reaches' if alone else 'reach'}"
        " out of it",
        span,
        notes=tuple(Note(f"the {each.called} needs {each.lacks}", each.span) for each in found.cut),
    )

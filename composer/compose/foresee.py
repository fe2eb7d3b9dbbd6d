"""Find out what a plan will do to the elements of its models, without compiling them unless bodies may touch."""

from __future__ import annotations

from dataclasses import replace

from composer import engine
from composer.compose.adopted import adopted_settings
from composer.compose.compose import Composed, Composer
from composer.compose.load import Library
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.link.measure import measure_with
from composer.plan.allowed import acknowledge
from composer.plan.foreseen import Foreseen
from composer.plan.plan import Plan
from composer.plan.steps.set_collisions import SetCollisions
from composer.tree.adopted import Adopted


def foresee(plan: Plan, context: Context) -> Foreseen:
    """Return what the plan will remove, what edits select, and on what the parts agree. Errors go to the sink.

    The model is composed once, if edits or contacts need it. Otherwise only the sources that matter are read.
    """
    library: Library = {}
    composer = Composer(context, measure_with(context), library=library)
    composed: Composed | None = None
    if plan.edits_elements:
        composed = composer.compose(plan)
        acknowledge(plan, context.sink, context.shown, whole=False)
    else:
        if plan.takes_subtrees:
            composer.read_subtrees(plan)
        if _excludes_touching(plan):
            composed = _composed_aside(plan, context, library)
    adopted = _adopted(plan, composed, context, library)
    excluded = () if composed is None else composed.excluded
    return Foreseen(composer.subtrees, composer.edits, adopted, _touching(plan, composed), excluded)


def _composed_aside(plan: Plan, context: Context, library: Library) -> Composed | None:
    """Return the composed model for the bodies that touch. Its errors are not reported here."""
    aside = replace(context, sink=Sink())
    with engine.Session() as session:
        measure = measure_with(aside, session=session)
        return Composer(aside, measure, session, library=library).compose(plan)


def _adopted(
    plan: Plan, composed: Composed | None, context: Context, library: Library
) -> tuple[Adopted, ...]:
    if composed is None:
        return adopted_settings(plan, context, library)
    return composed.model.adopted if plan.parts else ()


def _excludes_touching(plan: Plan) -> bool:
    return any(each.excludes_touching for each in plan.plans())


def _touching(plan: Plan, composed: Composed | None) -> tuple[tuple[str, str], ...]:
    """Return the body names of each pair that the plan excludes from collision because the bodies touch."""
    if composed is None or not _excludes_touching(plan):
        return ()
    spans = {
        step.span
        for each in plan.plans()
        for step in each.steps
        if isinstance(step, SetCollisions) and not step.collisions.sides and step.collisions.samples is None
    }
    origins, file = composed.model.origins, composed.model.file
    return tuple(
        (str(pair.get("body1")), str(pair.get("body2")))
        for pair in composed.model.root.iterfind("contact/exclude")
        if origins.owner(pair, file) in spans
    )

"""Find out what a plan will do to the elements of its models, without compiling them unless bodies may touch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from composer import engine
from composer.compose.actuator_model import models_in
from composer.compose.adopted import adopted_settings
from composer.compose.compose import Composed, Composer
from composer.compose.load import Library
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.grammar import GRAMMAR
from composer.link.linking import Measure
from composer.link.measure import measure_with
from composer.plan.allowed import acknowledge
from composer.plan.foreseen import EditOutcome, Foreseen, Gains
from composer.plan.plan import Plan
from composer.tree.adopted import Adopted


def foresee(plan: Plan, context: Context) -> Foreseen:
    """Return what the plan will remove, what edits select, and on what the parts agree. Errors go to the sink.

    The model is composed once, if edits or contacts need it. Otherwise only the sources that matter are read.
    """
    library: Library = {}
    measure = measure_with(context)
    composer = Composer(context, measure, library=library)
    composed: Composed | None = None
    if plan.edits_elements:
        composed = composer.compose(plan)
        acknowledge(plan, context.sink, context.shown, whole=False)
    else:
        if plan.takes_subtrees:
            composer.read_subtrees(plan)
        if _excludes_touching(plan):
            composed = _composed_aside(plan, context, library)
    adopted = _adopted(plan, composed, context, library=library)
    excluded = () if composed is None else composed.excluded
    gains = tuple(_gains(composed, composer.edits.values(), measure))
    return Foreseen(composer.subtrees, composer.edits, adopted, excluded=excluded, gains=gains)


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


def _gains(composed: Composed | None, edits: Iterable[EditOutcome], measure: Measure) -> Iterator[Gains]:
    """Yield what the servos do to their joints, if an edit is about actuators."""
    actuators = GRAMMAR.section("actuator").children
    if composed is None or not any(
        kind in ("actuator", *actuators) for each in edits for kind in each.selected
    ):
        return
    found = composed.model.root.findall("actuator/*")
    for node, model in (models_in(composed.model, measure, found) or {}).items():
        if model.gear and (model.kp or model.kv):
            name = node.get("name") or f"the {node.tag} of {node.get('joint') or node.get('tendon')}"
            yield Gains(
                str(name),
                model.kp * model.gear**2,
                model.kv * model.gear**2,
                gear=model.gear,
                unit=model.unit,
            )

"""The effects and needs of a plan, determined without building."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from mjcompose.base.sink import Sink
from mjcompose.compose.actuators import models_in
from mjcompose.compose.compose import Composed, Composer, adopted_settings
from mjcompose.compose.load import Library
from mjcompose.link.linking import ModelMeasure
from mjcompose.link.measure import measure_with
from mjcompose.mujoco import engine
from mjcompose.plan.describe import acknowledge
from mjcompose.plan.plan import EditOutcome, Gains, Plan, PlanPreview
from mjcompose.plan.steps import SetCollisions
from mjcompose.sources.context import Context
from mjcompose.tree.grammar import GRAMMAR


def preview_plan(plan: Plan, context: Context) -> PlanPreview:
    """Return the removed and selected elements of a plan, and its settings, composed at most once. Report errors."""
    library: Library = {}
    measure = measure_with(context)
    composer = Composer(context, measure, library=library)
    composed: Composed | None = None
    if plan.all_edits:
        composed = composer.compose(plan)
        acknowledge(plan, context.sink, context.shown, whole=False)
    else:
        composer.expect(plan)
        composer.read_subtrees(plan)
        steps = (step for each in plan.plans() for step in each.steps)
        if any(isinstance(step, SetCollisions) and not step.collisions.sides for step in steps):
            # Errors of composing are not reported here.
            aside = replace(context, sink=Sink())
            with engine.Session() as session:
                composed = Composer(aside, measure_with(aside, session=session), session, library=library).compose(plan)
    excluded = () if composed is None else composed.excluded
    unsearched = 0 if composed is None else composed.unsearched
    if composed is None:
        adopted = adopted_settings(plan, context, library)
    else:
        adopted = composed.model.adopted if plan.parts else ()
    gains = tuple(_gains(composed, composer.edits.values(), measure))
    return PlanPreview(
        composer.subtrees, composer.edits, adopted, excluded=excluded, unsearched=unsearched, gains=gains
    )


def _gains(composed: Composed | None, edits: Iterable[EditOutcome], measure: ModelMeasure) -> Iterator[Gains]:
    """Yield the gains of the servos at their joints if an edit is about actuators."""
    actuators = GRAMMAR.section("actuator").children
    if composed is None or not any(kind in ("actuator", *actuators) for each in edits for kind in each.selected):
        return
    models = models_in(composed.model, measure, composed.model.root.findall("actuator/*")) or {}
    for node, model in models.items():
        if model.gear and (model.kp or model.kv):
            name = node.get("name") or f"the {node.tag} of {node.get('joint') or node.get('tendon')}"
            yield Gains(str(name), model.kp * model.gear**2, model.kv * model.gear**2, gear=model.gear, unit=model.unit)


def shapes_for_plans(plans: Iterable[Plan], context: Context) -> dict[str, bytes]:
    """Return the results that plans need, by key; compute missing results. Report errors."""
    results: dict[str, bytes] = {}
    library: Library = {}
    if not (working := [plan for plan in plans if plan.works_on_meshes]):
        return results
    assert context.fetching is not None
    context.fetching.remakes_shapes = True
    try:
        with engine.Session() as session:
            for plan in working:
                composer = Composer(context, measure_with(context, session=session), session, library=library)
                composer.compose(plan)
                acknowledge(plan, context.sink, context.shown, whole=False)
                if composer.workshop is not None:
                    results |= composer.workshop.store.used
    finally:
        context.fetching.remakes_shapes = False
    return results

"""The check `tracks`: the model moves as a recording of the robot."""

from __future__ import annotations

import operator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.compose.compose import ComposeOptions, Composer
from mjcompose.language.checks.tracks import Tracks
from mjcompose.language.identify import Identify
from mjcompose.link.measure import measure_with
from mjcompose.mujoco import engine
from mjcompose.plan.plan import AttachPart, Plan
from mjcompose.plan.read import folder_of
from mjcompose.plan.steps import EditElements
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tools.identify.files import files_of
from mjcompose.tools.identify.identify import question_of
from mjcompose.tools.identify.model import compile_without_checks
from mjcompose.tools.identify.work import follow_recording
from mjcompose.verify.checks.check import beside, failed
from mjcompose.verify.compile import WHOLE

if TYPE_CHECKING:
    from mjcompose.verify.run_checks import Checks, NestedRecipe

_DESIGNED = "designed"
"""The name under which a session keeps the model without measured numbers."""
_WORSE = 1.05
"""How many times the error of that model a signal may have."""


def run(checks: Checks, check: Tracks, recipe: NestedRecipe, context: Context) -> dict[str, Any]:
    """Simulate the commands of the recording; report signals with larger errors to the context."""
    from mjcompose.verify.run_checks import report

    found, values = _followed(checks, check, recipe, context)
    for finding in found:
        report(finding, check, recipe, context=context)
    return values


def _followed(
    checks: Checks, check: Tracks, recipe: NestedRecipe, context: Context
) -> tuple[list[Fault], dict[str, Any]]:
    folder = folder_of(locate(recipe.plan.document, (*check.at, "recording")), context)
    path = folder / check.recording
    door = context.door_of_text(folder)
    if not all(door.sees(each) for each in (path, *files_of(path))):
        message = f"the recording `{check.recording}` is outside of the files that this recipe may read"
        return [Fault("source-outside", message, ("recording",))], {}
    settings = recipe.plan.identify or Identify.model_construct()
    question = question_of(settings, [], [path], [], context)
    question["prefix"] = recipe.prefix
    question["splits"] = False
    if recipe.prefix:
        question["start"] = None  # the keyframes of a nested recipe have other names
    answer = _ask(checks.session, WHOLE, question)
    if not answer.ok:
        return [Fault("check-failed", answer.error or str(answer.crash), ("recording",))], {}
    if "fault" in answer.value:
        fault = answer.value["fault"]
        line = f", line {fault['line']}" if fault["line"] is not None else ""
        message = f"`{fault['file'] or check.recording}`{line}: {fault['message']}"
        return [Fault(fault["code"], message, ("recording",), help=fault["help"])], {}
    errors: dict[str, float] = answer.value["errors"]
    faults = _judged(check, errors)
    if check.worse_than_recipe == "error":
        faults += _worse_than_recipe(checks, question, errors, context)
    return faults, {signal: float(f"{error:.4g}") for signal, error in errors.items()}


def _ask(session: engine.Session, kept: str, question: dict[str, Any]) -> engine.Called:
    """Ask how a model that the session keeps follows the recording."""
    with scratch("tracks") as temporary:
        argument = {**question, "progress": str(temporary / "progress")}
        return engine.call(session, follow_recording, [kept], argument=argument)


def _worse_than_recipe(
    checks: Checks, question: dict[str, Any], errors: dict[str, float], context: Context
) -> list[Fault]:
    """Return the fault of the signal that the model follows worst compared with the model without measured numbers."""
    at = ("worse_than_recipe",)
    plan = _without_measured(checks.plan)
    if plan is checks.plan:
        message = "the recipe has no `measured`, so there is nothing to compare"
        return [Fault("missing-key", message, at, help="remove `worse_than_recipe`, or name a file of measurements")]
    if not _keep_designed(plan, checks.session, context):
        return [Fault("check-failed", "the model without measured numbers cannot be built", at)]
    answer = _ask(checks.session, _DESIGNED, question)
    if not answer.ok:
        return [Fault("check-failed", answer.error or str(answer.crash), at)]
    before: dict[str, float] = answer.value["errors"]
    worst = max(errors, key=lambda signal: errors[signal] / max(before[signal], 1e-12))
    if errors[worst] <= _WORSE * before[worst]:
        return []
    message = (
        f"the measured model follows `{worst}` worse than the recipe without `measured`:"
        f" {errors[worst]:.3g}, before {before[worst]:.3g}"
    )
    help = "fit the recordings again, or do without the file of measurements"
    return [Fault("worse-than-recipe", message, at, help=help)]


def _without_measured(plan: Plan) -> Plan:
    """Return the plan and its nested recipes without the edits of files of measurements; itself if it has none."""
    parts = tuple(_part_without_measured(part) for part in plan.parts)
    base = None if plan.base is None else _part_without_measured(plan.base)
    steps = plan.steps
    if plan.measured is not None:
        file = plan.measured.shown
        steps = tuple(step for step in steps if not (isinstance(step, EditElements) and step.span.file == file))
    is_same = len(steps) == len(plan.steps) and base is plan.base and all(map(operator.is_, parts, plan.parts))
    return plan if is_same else replace(plan, steps=steps, parts=parts, base=base, measured=None)


def _part_without_measured(part: AttachPart) -> AttachPart:
    model = _without_measured(part.model) if isinstance(part.model, Plan) else part.model
    inner = tuple(map(_without_measured, part.inner))
    is_same = model is part.model and all(map(operator.is_, inner, part.inner))
    return part if is_same else replace(part, model=model, inner=inner)


def _keep_designed(plan: Plan, session: engine.Session, context: Context) -> bool:
    """Build a plan without its checks, and have the session keep the model. Return whether it succeeded."""
    own = replace(context, sink=Sink(), timings=[])
    composer = Composer(own, measure_with(own, session=session), session, options=ComposeOptions())
    return compile_without_checks(plan, composer, own, session, keep=_DESIGNED) is not None


def _judged(check: Tracks, errors: dict[str, float]) -> list[Fault]:
    found = []
    for signal, error in errors.items():
        bound = getattr(check.within, signal.partition(" ")[0])
        if bound is not None and error > bound:
            message = f"`{signal}` has a root mean square error of {beside(error, bound)}"
            found.append(failed(message, f"at most {bound:g}", beside(error, bound), "within"))
    return found

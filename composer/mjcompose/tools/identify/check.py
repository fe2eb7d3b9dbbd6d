"""The check `tracks`: the model moves as a recording of the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import Fault
from mjcompose.base.scratch import scratch
from mjcompose.language.checks.tracks import Tracks
from mjcompose.language.identify import Identify
from mjcompose.mujoco import engine
from mjcompose.plan.read import folder_of
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tools.identify.files import files_of
from mjcompose.tools.identify.identify import question_of
from mjcompose.tools.identify.work import follow_recording
from mjcompose.verify.checks.check import beside, failed
from mjcompose.verify.compile import WHOLE

if TYPE_CHECKING:
    from mjcompose.verify.run_checks import Checks, NestedRecipe


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
    with scratch("tracks") as temporary:
        question["progress"] = str(temporary / "progress")
        answer = engine.call(checks.session, follow_recording, [WHOLE], argument=question)
    if not answer.ok:
        return [Fault("check-failed", answer.error or str(answer.crash), ("recording",))], {}
    if "fault" in answer.value:
        fault = answer.value["fault"]
        line = f", line {fault['line']}" if fault["line"] is not None else ""
        message = f"`{fault['file'] or check.recording}`{line}: {fault['message']}"
        return [Fault(fault["code"], message, ("recording",), help=fault["help"])], {}
    errors: dict[str, float] = answer.value["errors"]
    return list(_judged(check, errors)), {signal: float(f"{error:.4g}") for signal, error in errors.items()}


def _judged(check: Tracks, errors: dict[str, float]) -> list[Fault]:
    found = []
    for signal, error in errors.items():
        bound = getattr(check.within, signal.partition(" ")[0])
        if bound is not None and error > bound:
            message = f"`{signal}` has a root mean square error of {beside(error, bound)}"
            found.append(failed(message, f"at most {bound:g}", beside(error, bound), "within"))
    return found

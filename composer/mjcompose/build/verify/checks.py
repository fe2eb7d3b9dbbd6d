"""The checks of a recipe and of its nested recipes are run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, field, replace
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Fault, Note, Severity, Span
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN
from mjcompose.base.sink import Sink
from mjcompose.build.bundle.assemble import Renamed
from mjcompose.build.checks.ask import CHECKS, ask
from mjcompose.build.checks.check import from_json
from mjcompose.build.plan.plan import BASE, MadeShapes, PartRecord, Plan, arrays_of_draw, of_part
from mjcompose.build.verify.compile import WHOLE
from mjcompose.build.verify.outcome import Outcome
from mjcompose.build.verify.parts import (
    PartComparer,
    PartComparison,
    causes,
    change_sentence,
    difference_notes,
)
from mjcompose.language.checks.collision import Collision
from mjcompose.language.checks.form import Check
from mjcompose.language.checks.unchanged import Unchanged, attributes
from mjcompose.language.form import check_rows
from mjcompose.language.recipe import KINDS, SEVERITY
from mjcompose.link.files import Merged
from mjcompose.mujoco import engine
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.mujoco.match import EXTRA, MISSING, Difference
from mjcompose.mujoco.messages import CRASHES
from mjcompose.sources.context import Context
from mjcompose.text.node import Scalar, find, locate


@dataclass(frozen=True, slots=True)
class NestedRecipe:
    """A recipe within another one.

    `part` is its name there with a separator behind it, empty for the outermost recipe. `prefix` starts all its
    names, `others` are longer prefixes that do not belong to it, and `keys` starts the names of its keyframes; None
    if they were left out.
    """

    plan: Plan
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""

    @property
    def whole(self) -> bool:
        """Whether the whole model belongs to the recipe."""
        return not self.prefix and not self.others

    def scope(self) -> dict[str, object]:
        """Return the fields of a `kinds.scope.Scope` as JSON data."""
        return {
            "prefix": self.prefix,
            "others": list(self.others),
            "separator": self.plan.separator,
            "keys": self.keys,
            "whole": self.whole,
        }

    def frame(self, members: Sequence[PartRecord]) -> dict[str, object] | None:
        """Return the body and pose of its world in the model, or None if the pose is unknown.

        The base of a recipe is placed at the origin of the recipe's world, so the place of the base is that
        of the recipe.
        """
        if not self.part:
            return {"body": None, "pos": ORIGIN, "quat": IDENTITY_QUAT}
        end, name, plan = self.plan.separator, f"{self.part}{BASE}", self.plan
        while plan.base is not None and isinstance(plan.base.model, Plan):
            plan, name = plan.base.model, f"{name}{end}{BASE}"
        for member in members:
            if member.part == name and member.pose is not None:
                return {"body": member.body, "pos": member.pose.pos, "quat": member.pose.quat}
        return None


def checks_in(plan: Plan) -> Iterator[tuple[NestedRecipe, Check]]:
    """Yield the checks of a plan, then those of its nested recipes."""
    for place in plan.walk():
        if isinstance(inner := place.model, Plan):
            part = f"{place.part}{inner.separator}" if place.part else ""
            recipe = NestedRecipe(inner, part, place.prefix, others=place.others, keys=place.keys)
            yield from ((recipe, check) for check in inner.checks)


# The codes of failed checks; all other codes are errors in the check itself.
_NOT_HELD = ("check-failed", "part-changed")

check_rows(
    "the checks that composer/mjcompose/build/checks/ask.py runs",
    [*CHECKS.own, Unchanged.word],
    [word for word in KINDS.own if not KINDS[word].of_target],
)
_LOSS = "target-loss"  # a warning: the check holds
Elsewhere = Callable[[dict[str, Any]], tuple[Sequence[Fault], dict[str, Any]]]
"""A check that is carried out elsewhere: of what it asks for, the findings and what was found."""


@dataclass(frozen=True, slots=True)
class Checks:
    """The checks of a model that the session keeps; `run` reports those that fail to the sink of `context`.

    `size` is that of the files of the model, in bytes; `elsewhere` carries out the checks that are about targets;
    `shapes` is what was made of meshes.
    """

    plan: Plan
    members: Sequence[PartRecord]
    session: engine.Session
    context: Context
    merged: Merged
    renamed: Renamed
    size: int = 0
    elsewhere: Mapping[str, Elsewhere] = field(default_factory=dict)
    shapes: Sequence[MadeShapes] = ()

    def run(self, outcomes: list[Outcome]) -> None:
        """Run every check in the order of the recipe, and append what came of each."""
        judge, kept = PartComparer(self.session, self.merged, self.renamed), True
        drawn = sorted({array for step in self.plan.draws if step.sample for array in arrays_of_draw(step)})
        for recipe, check in checks_in(self.plan):
            own = replace(self.context, sink=Sink())
            if isinstance(check, Unchanged):
                values = self._unchanged(check, recipe, judge, context=own, drawn=drawn)
            elif KINDS[check.word].of_target:
                values = _ask_elsewhere(check, recipe, self.elsewhere, context=own)
            else:
                kept, values = self._ask(check, recipe, own)
            reported = tuple(_as_severe(each, check, recipe) for each in own.sink.diagnostics)
            for diagnostic in reported:
                self.context.sink.add(diagnostic)
            name = recipe.part + check.name
            outcomes.append(
                Outcome(name, check.word, _place(check, recipe), diagnostics=reported, values=values)
            )
            if not kept:
                break

    def _ask(
        self,
        check: Check,
        recipe: NestedRecipe,
        context: Context,
    ) -> tuple[bool, dict[str, Any]]:
        """Run a check on the compiled model, in the process that keeps it.

        Return whether that process still keeps the model, and the values that the check found.
        """
        angle = recipe.plan.angle_context.at((*check.at, check.word, "value")).angle
        asked = {**asdict(check), "angle": angle, "frame": recipe.frame(self.members), "bytes": self.size}  # type: ignore[call-overload]
        if isinstance(check, Collision):
            asked["made"] = [
                {"mesh": each.mesh, "of": each.of, "shapes": each.shapes, **each.error}
                for each in self.shapes
            ]
        about = f"check `{recipe.part}{check.name}`"
        if KINDS[check.word].needs_world and asked["frame"] is None:
            message = f"{about}: it is not known where the world of this recipe stands in the model, for it has no base"
            help = "move the check to the recipe around it"
            context.sink.error("check-failed", message, _place(check, recipe), help=help)
            return True, {}
        question = {"kind": check.word, "asked": asked, "scope": recipe.scope()}
        answer = engine.call(self.session, ask, [WHOLE], argument=question)
        if not answer.ok:
            code = CRASHES.get(answer.crash or "", "mujoco-crash")
            notes = [Note("no check behind it was run")] if answer.crash else []
            message = f"{about}: {answer.error or answer.crash}"
            context.sink.error(code, message, _place(check, recipe), notes=notes)
            return not answer.crash, {}
        for finding in map(from_json, answer.value["findings"]):
            _report_finding(finding, check, recipe, context=context)
        return True, answer.value["values"]

    def _unchanged(
        self,
        check: Unchanged,
        recipe: NestedRecipe,
        judge: PartComparer,
        context: Context,
        *,
        drawn: Sequence[str],
    ) -> dict[str, Any]:
        """Compare each source of the part with the source alone, and return how many there are.

        The part goes by the name that the outermost recipe gives it.
        """
        separator = self.plan.separator
        part = recipe.part + check.part if check.part else recipe.part.removesuffix(separator) or None
        excused = [*drawn, *(array for name in check.excepted for array in arrays_of(name))]
        found = of_part(self.members, part, separator)
        for member in found:
            compared = judge.compare(member, excused)
            if not compared.ok:
                _report(compared, recipe, check, context=context)
        return {"parts": len(found)}


def check_spans(plan: Plan) -> dict[str, Span]:
    """Return where each check is written, by the name in its outcome."""
    return {recipe.part + check.name: _place(check, recipe) for recipe, check in checks_in(plan)}


def _place(check: Check, recipe: NestedRecipe) -> Span:
    return locate(recipe.plan.document, (*check.at, check.word), key=True)


def _as_severe(found: Diagnostic, check: Check, recipe: NestedRecipe) -> Diagnostic:
    """Return the diagnostic with the severity that the check sets; errors in the check itself stay errors."""
    severity = find(recipe.plan.document, (*check.at, SEVERITY))
    warns = isinstance(severity, Scalar) and severity.value == Severity.WARNING
    return replace(found, severity=Severity.WARNING) if warns and found.code in _NOT_HELD else found


def _ask_elsewhere(
    check: Check, recipe: NestedRecipe, elsewhere: Mapping[str, Elsewhere], context: Context
) -> dict[str, Any]:
    findings, values = elsewhere[check.word](asdict(check))  # type: ignore[call-overload]
    for finding in findings:
        _report_finding(finding, check, recipe, context=context)
    return values


def _report_finding(finding: Fault, check: Check, recipe: NestedRecipe, context: Context) -> None:
    span = locate(recipe.plan.document, (*check.at, check.word, *finding.at), key=not finding.at)
    message = f"check `{recipe.part}{check.name}`: {finding.message}"
    add = context.sink.warning if finding.code == _LOSS else context.sink.error
    add(finding.code, message, span, notes=finding.notes, help=finding.help)


def _report(compared: PartComparison, recipe: NestedRecipe, check: Unchanged, context: Context) -> None:
    path = (*check.at, "unchanged")
    span = locate(recipe.plan.document, (*path, "part") if check.part else path, key=check.part is None)
    about = f"check `{recipe.part}{check.name}`"
    if compared.obscure is not None:
        message = (
            f"{about}: `{compared.member.called}` cannot be compared with its source: {compared.obscure}"
        )
        context.sink.error("part-not-compared", message, span)
        return
    message = f"{about}: {change_sentence(compared)}"
    context.sink.error(
        "part-changed",
        message,
        span,
        notes=difference_notes(compared.differences),
        help=_excepting(compared, check),
    )


def _excepting(compared: PartComparison, check: Unchanged) -> str | None:
    """Return the line that accepts all differences, or None if one of them belongs to no attribute."""
    names = list(check.excepted)
    for each in causes(compared.differences):
        if each.field in (MISSING, EXTRA):
            return None
        if (name := _attribute(each)) is None:
            return None
        names.append(name)
    listed = ", ".join(dict.fromkeys(names))
    return f"if that is meant, write `except: [{listed}]`"


def _attribute(difference: Difference) -> str | None:
    """Return an MJCF attribute that determines the array."""
    end = difference.array.partition("_")[2]
    known = attributes()
    if end in known:
        return end
    return next(
        (name for name in known if end in arrays_of(name) or difference.array in arrays_of(name)), None
    )

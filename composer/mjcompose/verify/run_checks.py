"""Run the checks of a recipe and of its nested recipes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import cached_property
from typing import Any

from mjcompose import homes
from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Fault, Note, Severity, Span
from mjcompose.base.extensions import ExtensionTable, check_rows
from mjcompose.base.rotation import IDENTITY_QUAT, ORIGIN
from mjcompose.base.sink import Sink
from mjcompose.bundle.assemble import Renamed
from mjcompose.bundle.bundle import Bundle, CheckOutcome
from mjcompose.language.check import KINDS, SEVERITY, Check
from mjcompose.link.files import Merged
from mjcompose.mujoco import engine
from mjcompose.mujoco.messages import CRASHES
from mjcompose.plan.plan import BASE, GeneratedShapes, PartRecord, Plan, arrays_of_draw
from mjcompose.sources.context import Context
from mjcompose.text.node import Mapping, Scalar, find, locate
from mjcompose.verify.checks.check import RecipeFacts, ShapeErrors, WorldPlace, ask, from_json
from mjcompose.verify.compile import WHOLE
from mjcompose.verify.parts import PartComparer


class NestedRecipe(Struct):
    """A nested recipe: its name with a separator, its prefix, longer prefixes in `others`, and its prefix of keys."""

    plan: Plan
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""

    def scope(self) -> dict[str, object]:
        whole = not self.prefix and not self.others
        separator = self.plan.separator
        fields = {"prefix": self.prefix, "others": list(self.others), "separator": separator}
        return {**fields, "keys": self.keys, "whole": whole}

    def world(self, members: Sequence[PartRecord]) -> WorldPlace | None:
        """Return the place of its world in the model, taken from its base; None if the pose is unknown."""
        if not self.part:
            return WorldPlace(None, ORIGIN, IDENTITY_QUAT)
        name = f"{self.part}{BASE}"
        plan = self.plan
        while plan.base is not None and isinstance(plan.base.model, Plan):
            name = f"{name}{plan.separator}{BASE}"
            plan = plan.base.model
        for member in members:
            if member.part == name and member.pose is not None:
                return WorldPlace(member.body, member.pose.pos, member.pose.quat)
        return None


def checks_in(plan: Plan) -> Iterator[tuple[NestedRecipe, Check]]:
    """Yield the checks of a plan, then the checks of its nested recipes."""
    for place in plan.walk():
        inner = place.model
        if isinstance(inner, Plan):
            recipe = NestedRecipe(inner, place.above, place.prefix, others=place.others, keys=place.keys)
            yield from ((recipe, check) for check in inner.checks)


# The codes of failed checks; all other codes are errors in the check itself.
_NOT_HELD = ("check-failed", "part-changed")
_LOSS = "target-loss"  # a warning: the check holds
_RUNS: ExtensionTable[Callable[..., dict[str, Any]]] = ExtensionTable("checks", {}, "run", modules=homes.CHECKS)
"""How to carry out the checks that need more than the compiled model."""
check_rows("the effects of checks in composer/mjcompose/homes.py", _RUNS.own, KINDS.own)


@dataclass(frozen=True)
class Checks:
    """The checks of a model with its files; `run` reports failed checks to `context`. `shapes` are made of meshes."""

    plan: Plan
    members: Sequence[PartRecord]
    session: engine.Session
    context: Context
    merged: Merged
    renamed: Renamed
    bundle: Bundle
    shapes: Sequence[GeneratedShapes] = ()

    @cached_property
    def comparer(self) -> PartComparer:
        return PartComparer(self.session, self.merged, self.renamed)

    @cached_property
    def drawn(self) -> list[str]:
        return sorted({array for step in self.plan.draws if step.sample for array in arrays_of_draw(step)})

    def run(self, outcomes: list[CheckOutcome]) -> None:
        """Run every check in the order of the recipe, and append each outcome."""
        kept = True
        for recipe, check in checks_in(self.plan):
            own = replace(self.context, sink=Sink())
            if check.is_in_mujoco:
                kept, values = self._ask(check, recipe, own)
            else:
                values = _RUNS[check.word](self, check, recipe, own)
            reported = tuple(own.sink.diagnostics)
            severity = find(recipe.plan.document, (*check.at[:-1], SEVERITY))
            if isinstance(severity, Scalar) and severity.value == Severity.WARNING:  # errors in the check stay errors
                reported = tuple(
                    replace(each, severity=Severity.WARNING) if each.code in _NOT_HELD else each for each in reported
                )
            self.context.sink.extend(reported)
            name = recipe.part + check.name
            outcomes.append(CheckOutcome(name, check.word, _place(check, recipe), diagnostics=reported, values=values))
            if not kept:
                break

    def _ask(self, check: Check, recipe: NestedRecipe, context: Context) -> tuple[bool, dict[str, Any]]:
        """Run a check on the compiled model in its process. Return whether it still has the model, and the values."""
        facts = self._facts(check, recipe)
        about = f"check `{recipe.part}{check.name}`"
        if check.needs_world and facts.world is None:
            message = f"{about}: the world of this recipe has no known place in the model, because it has no base"
            help = "move the check to the recipe around it"
            context.sink.error("check-failed", message, _place(check, recipe), help=help)
            return True, {}
        question = {
            "word": check.word,
            "written": check.written,
            "scope": recipe.scope(),
            "facts": asdict(facts),
        }
        answer = engine.call(self.session, ask, [WHOLE], argument=question)
        if not answer.ok:
            code = CRASHES.get(answer.crash or "", "mujoco-crash")
            notes = [Note("no check behind it was run")] if answer.crash else []
            context.sink.error(code, f"{about}: {answer.error or answer.crash}", _place(check, recipe), notes=notes)
            return not answer.crash, {}
        for finding in map(from_json, answer.value["findings"]):
            report(finding, check, recipe, context=context)
        return True, answer.value["values"]

    def _facts(self, check: Check, recipe: NestedRecipe) -> RecipeFacts:
        written = next((key for key in ("equals", "range") if find(recipe.plan.document, (*check.at, key))), "select")
        return RecipeFacts(
            recipe.plan.angle_context.at((*check.at, written)).angle,
            recipe.world(self.members),
            sum(map(len, self.bundle.files.values())),
            shapes=[ShapeErrors.of(made.mesh, made.error) for made in self.shapes],
            text=self.bundle.files[self.bundle.model].decode() if check.reads_text else "",
        )


def check_spans(plan: Plan) -> dict[str, Span]:
    """Return where each check is written, by the name in its outcome."""
    return {recipe.part + check.name: _place(check, recipe) for recipe, check in checks_in(plan)}


def _place(check: Check, recipe: NestedRecipe) -> Span:
    return locate(recipe.plan.document, check.at, key=True)


def report(finding: Fault, check: Check, recipe: NestedRecipe, context: Context) -> None:
    """Report a finding of a check at its value, or else at the word of the check."""
    path = (*check.at, *finding.at)
    value = find(recipe.plan.document, path) if finding.at else None
    span = locate(recipe.plan.document, path, key=value is None or isinstance(value, Mapping))
    message = f"check `{recipe.part}{check.name}`: {finding.message}"
    add = context.sink.warning if finding.code == _LOSS else context.sink.error
    add(finding.code, message, span, notes=finding.notes, help=finding.help)

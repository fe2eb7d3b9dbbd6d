"""What a build will do, in order: data that can be printed, compared and carried out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from composer.diagnostics.span import Span
from composer.document.node import Mapping as Located
from composer.document.node import locate
from composer.expr.value import Value
from composer.plan.angle_context import Readings
from composer.plan.drawn import Drawn
from composer.plan.steps.add_element import AddElement
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.plan.steps.step import Step
from composer.plan.steps.write_keyframe import WriteKeyframe
from composer.recipe.attach import Attachment
from composer.recipe.checks.kind import Check
from composer.recipe.drop import Drop
from composer.recipe.edit import Edit
from composer.recipe.randomize import Randomize
from composer.sources.source import Source

KeyPolicy = Literal["merge", "prefix", "none"]


@dataclass(frozen=True, slots=True)
class LoadBase:
    """Start from a model, or (None) from an empty one."""

    model: Source | Plan | None
    keyframes: KeyPolicy
    span: Span | None
    subtree: str | None = None
    drop: tuple[Drop, ...] = ()
    edit: tuple[Edit, ...] = ()


@dataclass(frozen=True, slots=True)
class AttachPart:
    """Hang a model on a place, its names under `prefix` (separator included).

    `copy` has its number on each axis of `replicate`, from 0.
    """

    prefix: str
    model: Source | Plan
    attachment: Attachment
    at: tuple[str | int, ...]
    span: Span
    copy: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class DropElements:
    """Leave out of a part, or of the base, what is not wanted of it."""

    drop: tuple[Drop, ...]
    span: Span

    @property
    def words(self) -> str:
        """What it does, on one line."""
        return f"drop {', '.join(map(str, self.drop))}"


@dataclass(frozen=True, slots=True)
class Plan:
    """One model: the recipe it is made from, what holds for the whole recipe, and the steps in order."""

    name: str
    description: str | None
    path: Path
    file: str
    document: Located
    separator: str
    conflict: Literal["error", "warning", "merge"]
    readings: Readings
    base: LoadBase
    parts: tuple[AttachPart, ...]
    steps: tuple[Step, ...]
    settled: frozenset[str]
    checks: tuple[Check, ...] = ()
    scope: Mapping[str, Value] = field(default_factory=dict)
    """The parameters of the recipe and the chosen variants, by name."""
    randomize: Randomize | None = None
    sample: int = 0
    """Which sample it is; 0 is the nominal model."""
    drawn: tuple[Drawn, ...] = ()
    """The parameters that were drawn for it."""
    variants: Mapping[str, str] = field(default_factory=dict)
    """The chosen variants alone."""
    source: Source | None = None
    """The recipe as it was resolved, where it is nested in another."""
    extended: tuple[tuple[Source, Span], ...] = ()
    """The recipes that it extends, each with the place that names it."""

    @property
    def keyframes(self) -> tuple[WriteKeyframe, ...]:
        return tuple(step for step in self.steps if isinstance(step, WriteKeyframe))

    @property
    def asked(self) -> frozenset[str]:
        """The parts, by path, of whose keys keys are made."""
        return frozenset(part for step in self.keyframes for part in step.key.sources)

    @property
    def edits(self) -> tuple[EditElements, ...]:
        """The steps that edit the whole model."""
        return tuple(step for step in self.steps if isinstance(step, EditElements))

    @property
    def added_places(self) -> Mapping[tuple[str, str], Span]:
        """Where bodies, frames and sites that are added have their names, by kind and name."""
        found: dict[tuple[str, str], Span] = {}
        waiting = [step.element for step in reversed(self.steps) if isinstance(step, AddElement)]
        while waiting:
            element = waiting.pop()
            name = element.attributes.get("name")
            if name is not None and element.tag in ("body", "frame", "site"):
                found.setdefault((element.tag, str(name)), locate(self.document, (*element.at, "name")))
            waiting.extend(reversed(element.children))
        return found

    @property
    def draws(self) -> tuple[DrawValues, ...]:
        """The steps that draw attributes of the whole model."""
        return tuple(step for step in self.steps if isinstance(step, DrawValues))

    def of_sample(self, sample: int) -> Plan:
        """The same with the draws of another sample; parameters are not drawn anew."""
        steps = tuple(
            replace(step, sample=sample) if isinstance(step, DrawValues) else step for step in self.steps
        )
        return replace(self, steps=steps, sample=sample)

    @property
    def takes_subtrees(self) -> bool:
        """Whether of some model, here or in a nested recipe, not all is wanted."""
        wanted: list[LoadBase | Attachment] = [self.base, *(part.attachment for part in self.parts)]
        if any(each.subtree is not None or each.drop for each in wanted):
            return True
        models = (self.base.model, *(part.model for part in self.parts))
        return any(isinstance(model, Plan) and model.takes_subtrees for model in models)

    @property
    def selects_parts(self) -> bool:
        """Whether some edit, here or in a nested recipe, asks from which part an element came."""
        selectors = [step.edit.select for step in self.edits]
        selectors += [step.field.select for step in self.draws if step.field.select is not None]
        if any(each.part is not None for selector in selectors for each in selector.all()):
            return True
        models = (self.base.model, *(part.model for part in self.parts))
        return any(isinstance(model, Plan) and model.selects_parts for model in models)

    @property
    def prefixes(self) -> frozenset[str]:
        """The prefixes of all parts, those of nested recipes with what stands before them; `""` is the base."""
        found = {"", *(part.prefix for part in self.parts)}
        for prefix, model in [("", self.base.model), *((part.prefix, part.model) for part in self.parts)]:
            if isinstance(model, Plan):
                found |= {prefix + inner for inner in model.prefixes}
        return frozenset(found)

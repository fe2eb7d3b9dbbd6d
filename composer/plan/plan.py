"""What a build will do, in order: data that can be printed, compared and carried out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path
from typing import Literal

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.document.node import Mapping as Located
from composer.expr.value import Value
from composer.plan.added_places import AddedPlace, added_places
from composer.plan.angle_context import AngleContext
from composer.plan.drawn import Drawn
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.plan.steps.set_collisions import SetCollisions
from composer.plan.steps.step import Step
from composer.plan.steps.write_keyframe import WriteKeyframe
from composer.recipe.attach import Attachment
from composer.recipe.checks.kind import Check
from composer.recipe.drop import Drop
from composer.recipe.edit import Edit
from composer.recipe.fault import Path as KeyPath
from composer.recipe.motors import Motor
from composer.recipe.randomize import Randomize
from composer.sources.source import Source

KeyPolicy = Literal["merge", "prefix", "none"]

MESH_VERBS = frozenset({"collision", "simplify"})
"""The verbs of `edit` that make something of meshes."""
BASE = "base"
"""The name in a recipe of the model that it starts from."""


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
    """Attach a model to a place, with its names under `prefix` (separator included).

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
    """Leave elements out of a part or the base."""

    drop: tuple[Drop, ...]
    span: Span

    @property
    def words(self) -> str:
        """A description on one line."""
        return f"drop {', '.join(map(str, self.drop))}"


@dataclass(frozen=True, slots=True)
class Plan:
    """One model: the recipe it is made from, the settings of the whole recipe, and the steps in order."""

    name: str
    description: str | None
    path: Path
    file: str
    document: Located
    separator: str
    conflict: Literal["error", "warning", "merge"]
    angle_context: AngleContext
    base: LoadBase
    parts: tuple[AttachPart, ...]
    steps: tuple[Step, ...]
    settled: frozenset[str]
    checks: tuple[Check, ...] = ()
    motors: Mapping[str, Motor] = field(default_factory=dict)
    """The data sheets of motors that the recipe has."""
    scope: Mapping[str, Value] = field(default_factory=dict)
    """The parameters of the recipe and the chosen variants, by name."""
    randomize: Randomize | None = None
    sample: int = 0
    """The number of the sample; 0 is the nominal model."""
    drawn: tuple[Drawn, ...] = ()
    """The parameters that were drawn for the sample."""
    variants: Mapping[str, str] = field(default_factory=dict)
    """The chosen variants only."""
    source: Source | None = None
    """The resolved recipe, if it is nested in another one."""
    extended: tuple[tuple[Source, Span], ...] = ()
    """The recipes that it extends, each with the place that names it."""
    at: KeyPath = ()
    """The path in its file, for a model that is written in place."""
    cells: int = 0
    """The number of cells of its matrix, if this model is none of them."""
    cells_at: Span | None = None
    """Where the first of them is written."""

    def place_of(self, at: KeyPath) -> tuple[str, KeyPath]:
        """Return the file of a path in this recipe, and the path in the file."""
        return self.file, (*self.at, *at)

    @property
    def span(self) -> Span:
        """The place for messages about the whole model: where its only source is named, or the recipe."""
        named = [self.base.span, *(part.span for part in self.parts)]
        places = [span for span in named if span is not None]
        return places[0] if len(places) == 1 else Span(self.file, 1, 1)

    @property
    def keyframes(self) -> tuple[WriteKeyframe, ...]:
        return tuple(step for step in self.steps if isinstance(step, WriteKeyframe))

    @property
    def key_sources(self) -> frozenset[str]:
        """The parts, by path, from whose keys other keys are made."""
        return frozenset(part for step in self.keyframes for part in step.key.sources)

    @property
    def edits(self) -> tuple[EditElements, ...]:
        """The steps that edit the whole model."""
        return tuple(step for step in self.steps if isinstance(step, EditElements))

    @property
    def excludes_touching(self) -> bool:
        """Whether bodies that touch are excluded from colliding."""
        steps = (step for step in self.steps if isinstance(step, SetCollisions))
        return any(not step.collisions.sides for step in steps)  # with what is found by itself

    @property
    def added_places(self) -> Mapping[tuple[str, str], AddedPlace]:
        """The bodies, frames and sites that are added, by kind and name."""
        return added_places(self.steps, self.document)

    @property
    def draws(self) -> tuple[DrawValues, ...]:
        """The steps that draw attributes of the whole model."""
        return tuple(step for step in self.steps if isinstance(step, DrawValues))

    def of_sample(self, sample: int) -> Plan:
        """Return the plan with the draws of another sample; parameters keep their values."""
        steps = tuple(
            replace(step, sample=sample) if isinstance(step, DrawValues) else step for step in self.steps
        )
        return replace(self, steps=steps, sample=sample)

    def walk(self, stands: bool = True) -> Iterator[Place]:
        """Yield the plan itself, then its base and its parts in their order, each followed by its contents.

        `stands` says that the plan itself is fixed in the world.
        """
        yield from _walk(Place(self, stands=stands))

    def plans(self) -> Iterator[Plan]:
        """Yield the plan, and those of its nested recipes."""
        yield from (place.model for place in self.walk() if isinstance(place.model, Plan))

    def sources(self) -> Iterator[Source]:
        """Yield the model files of the plan and of its nested recipes."""
        yield from (place.model for place in self.walk() if isinstance(place.model, Source))

    @property
    def part_names(self) -> tuple[str, ...]:
        """The paths of all parts of the recipe: `base`, `left`, `left/gripper`."""
        return tuple(place.part for place in self.walk() if place.part and place.model is not None)

    @property
    def takes_subtrees(self) -> bool:
        """Whether some model, here or in a nested recipe, is only taken in part."""
        wanted = [place.request for place in self.walk() if place.request is not None]
        return any(each.subtree is not None or each.drop for each in wanted)

    @property
    def edits_elements(self) -> bool:
        """Whether there is an entry of `edit`, here, at a part or in a nested recipe."""
        wanted = [place.request for place in self.walk() if place.request is not None]
        return any(plan.edits for plan in self.plans()) or any(each.edit for each in wanted)

    @property
    def works_on_meshes(self) -> bool:
        """Whether an entry of `edit`, here, at a part or in a nested recipe, makes something of a mesh."""
        own = [step.edit for plan in self.plans() for step in plan.edits]
        parts = [each for place in self.walk() if place.request is not None for each in place.request.edit]
        return any(not MESH_VERBS.isdisjoint(each.verbs) for each in (*own, *parts))

    @property
    def selects_parts(self) -> bool:
        """Whether some edit or draw, here or in a nested recipe, selects elements by their part."""
        selectors = [step.edit.select for plan in self.plans() for step in plan.edits]
        selectors += [step.field.select for plan in self.plans() for step in plan.draws if step.field.select]
        draws_by_part = any(step.field.per == "part" for plan in self.plans() for step in plan.draws)
        return draws_by_part or any(
            each.part is not None for selector in selectors for each in selector.all()
        )

    @property
    def prefixes(self) -> frozenset[str]:
        """The prefixes of all parts, including those of nested recipes; `""` is the base."""
        return frozenset(place.prefix for place in self.walk())


@dataclass(frozen=True, slots=True)
class Place:
    """A model and its place in the outermost plan: that plan itself, or a base or part of it or of a nested plan.

    `outer` is the plan that it is the base or a part of, by `step`; both are None for the outermost plan. `part` is
    its name in the outermost recipe, empty for that recipe itself; `prefix` starts its names, `keys` the names of
    its keyframes, None if they are left out. `others` are longer prefixes that do not belong to it. `stands` says
    that it is fixed in the world, `span` is its place in the outermost recipe.
    """

    model: Source | Plan | None
    outer: Plan | None = None
    step: LoadBase | AttachPart | None = None
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""
    stands: bool = True
    span: Span | None = None

    @property
    def request(self) -> LoadBase | Attachment | None:
        """The entry of the recipe around it that takes or attaches it."""
        return self.step.attachment if isinstance(self.step, AttachPart) else self.step


def _walk(place: Place) -> Iterator[Place]:
    yield place
    plan = place.model
    if not isinstance(plan, Plan):
        return
    above = f"{place.part}{plan.separator}" if place.part else ""
    yield from _walk(
        Place(
            plan.base.model,
            plan,
            plan.base,
            part=above + BASE,
            prefix=place.prefix,
            others=(*place.others, *(place.prefix + part.prefix for part in plan.parts if part.prefix)),
            keys=None if plan.base.keyframes == "none" else place.keys,
            stands=place.stands,
            span=place.span or plan.base.span,
        )
    )
    for part in plan.parts:
        policy = part.attachment.keyframes
        keys = None if policy == "none" or place.keys is None else place.keys
        yield from _walk(
            Place(
                part.model,
                plan,
                part,
                part=above + part_name(part, plan.separator),
                prefix=place.prefix + part.prefix,
                others=place.others,
                keys=keys + part.prefix if keys is not None and policy == "prefix" else keys,
                stands=place.stands and stands_in_world(part.attachment),
                span=place.span or part.span,
            )
        )


def part_name(part: AttachPart, separator: str) -> str:
    """Return a part's name in its recipe: the prefix, or the key if it has no prefix."""
    return part.prefix.removesuffix(separator) or str(part.at[-1])


def stands_in_world(part: Attachment) -> bool:
    """Return whether a part is fixed in the world of its recipe."""
    in_world = part.site is None and part.frame is None and part.body in (None, "world")
    return in_world and part.joint in (None, "weld")

"""What a build will do, in order: data that can be printed, compared and carried out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import field, replace
from pathlib import Path as PathlibPath
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path, Span
from mjcompose.base.rotation import Pose
from mjcompose.build.plan.steps import (
    AddedPlace,
    AngleContext,
    DrawValues,
    EditElements,
    SetCollisions,
    Step,
    WriteKeyframe,
    added_places,
)
from mjcompose.language.attach import Attachment
from mjcompose.language.check import Check
from mjcompose.language.datasheets import Sheet
from mjcompose.language.form import shown
from mjcompose.language.used_model import Drop, KeyPolicy
from mjcompose.language.value import attribute_and_index
from mjcompose.model.grammar import number_text
from mjcompose.model.merged_settings import Adopted, ReadRow
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.sources.reference import ReadAs, Source
from mjcompose.text.expression_values import Value
from mjcompose.text.node import Mapping as Located

if TYPE_CHECKING:
    from mjcompose.language.distribution import Operation
    from mjcompose.language.randomize import DrawField, Randomize
    from mjcompose.link.subtree import DroppedElement, Subtree


@dataclass(frozen=True, slots=True)
class Drawn:
    """A draw for an attribute of an element, or (`element` None) for the parameter `attribute`.

    `element` identifies the draw: a name, or the place of an unnamed element. `shared` says that all elements have
    the same draw. Angles are in radians, those of parameters in the parameter's unit; the first number is component
    `start` of the attribute.
    """

    field: str
    element: str | None
    attribute: str
    operation: Operation
    value: Value
    shared: bool = False
    start: int = 0

    def columns(self) -> list[tuple[str, Value]]:
        """Return the numbers, each with the name of its column in a table of samples.

        >>> Drawn("camera", "top", "pos", "offset", (0.1, 0.2)).columns()
        [('camera[top][0]', 0.1), ('camera[top][1]', 0.2)]
        """
        name = self.field if self.shared or self.element is None else f"{self.field}[{self.element}]"
        if isinstance(self.value, tuple):
            return [(f"{name}[{index}]", each) for index, each in enumerate(self.value)]
        return [(name, self.value)]


@dataclass(frozen=True, slots=True)
class ElementDraws:
    """The draws for one element in all samples from 1, for a table; `first` is that of sample 1.

    `name` is the element's name, if any; `place` is its body, its number among the elements with its tag there, and
    their count. `numbers` are the draws, separately for each number of the attribute. `angles` says which of the
    numbers are angles, `unit` is the unit of bare angles.
    """

    first: Drawn
    field: DrawField
    name: str | None
    place: tuple[str, int, int] | None
    tag: str
    family: str
    numbers: tuple[Sequence[Value], ...]
    angles: tuple[bool, ...] = ()
    unit: str | None = None


def arrays_of_draw(step: DrawValues) -> AbstractSet[str]:
    """Return the arrays that a draw affects."""
    name, _ = attribute_and_index(step.field.attr)
    tag = step.field.select.tag if step.field.select is not None else None
    # Actuators with `inheritrange` copy the range of their joint.
    following = {"actuator_ctrlrange"} if name == "range" else set()
    return following.union(arrays_of(name, tag))


@dataclass(frozen=True, slots=True)
class GeneratedShapes:
    """`shapes` are the geoms that were made for the geom `of`, or the mesh itself where it was simplified.

    `error` has the distances in metres and the shares that `mjcompose.mujoco.fit` measures, `faces` how many the
    mesh has and `made_with` the versions of what made it. `key` is the content that it follows from, and its name where
    it is kept.
    """

    of: str
    mesh: str
    method: str
    wanted: Any
    shapes: tuple[str, ...]
    faces: int
    error: Mapping[str, float | int | None]
    made_with: Mapping[str, str]
    key: str
    span: Span

    @property
    def how(self) -> str:
        """The method with its settings."""
        return in_words(self.method, self.wanted)

    @property
    def words(self) -> str:
        """What `plan` prints, on one line."""
        what = f"{self.mesh} ({self.faces} faces)"
        if self.method == "simplify":
            made = f"simplified, {_mm(self.error['hausdorff'])} off"
        else:
            count = len(self.shapes)
            made = f"{count} geom{'s' * (count != 1)}" + (f" for {self.of}" if self.of else "")
            made += f", {_mm(self.error['beyond'])} beyond it and {_mm(self.error['short'])} short of it"
        volume = self.error["volume"]
        return f"{what}: {made}" + ("" if volume is None else f", {volume:.3g} of its volume")


def _mm(metres: float | int | None) -> str:
    return f"{number_text(float(f'{1000 * (metres or 0):.3g}'))} mm"


RecipePath: TypeAlias = tuple[str, Path]
"""A recipe's file, and a path in it."""


@dataclass(frozen=True, slots=True)
class EditOutcome:
    """The effect of an entry of `edit`: how many elements of each kind it selects, and what it removes.

    `removed` has the selected elements first, then those that go with them; `shapes` what was made of meshes.
    """

    selected: Mapping[str, int]
    removed: tuple[DroppedElement, ...] = ()
    shapes: tuple[GeneratedShapes, ...] = ()


@dataclass(frozen=True, slots=True)
class Excluded:
    """Two bodies that need not collide, and why, in words; "" for bodies that touch."""

    one: str
    other: str
    why: str


@dataclass(frozen=True, slots=True)
class Gains:
    """The stiffness and the damping that a servo gives a joint or a tendon through its `gear`.

    `unit` is that of its force: N or N·m, or "" along a tendon.
    """

    actuator: str
    kp: float
    kv: float
    gear: float
    unit: str


@dataclass(frozen=True, slots=True)
class PlanPreview:
    """What composing finds out about a plan.

    `adopted` are the settings that the model takes from its parts, `excluded` the bodies that need not collide, `gains`
    has the gains of the servos of a model whose actuators are edited, as their joints feel them.
    """

    subtrees: Mapping[RecipePath, Subtree] = field(default_factory=dict)
    edits: Mapping[RecipePath, EditOutcome] = field(default_factory=dict)
    adopted: tuple[Adopted, ...] = ()
    excluded: tuple[Excluded, ...] = ()
    gains: tuple[Gains, ...] = ()


IN_PLACE = Pose()
Tables: TypeAlias = Mapping[ReadAs, tuple[ReadRow, ...]]
"""What was read of sources that are not MJCF, and what was not."""


@dataclass(frozen=True, slots=True)
class PartRecord:
    """A source model, the prefix of its names (separator included), and the pose of its own world.

    `part` is its name in a recipe: the prefix without its last separator, `base` for the base, and both for a part
    of a part. `body` is the body that the part's world is fixed to, None for the world, with `pose` in the body's
    frame, or None if the pose is unknown. `keys` starts the names of its keys; None if they were left out. `welded`
    says that free joints at its root were removed, `is_fixed_in_world` is about the final model: the root link of a
    URDF is then fused with the world. `changed` are the arrays of `mjModel` that the recipe changes in it on purpose,
    `replaced_keys` the keys that the recipe writes in place of the source's keys of these names. `obscure` says why
    it cannot be compared, if so, and `reduced` why it is compared only if a check requests it. `subtree` is the
    body that was taken from the source, if not all of it was.
    """

    part: str
    prefix: str
    source: Source
    body: str | None = None
    pose: Pose | None = IN_PLACE
    keys: str | None = ""
    welded: bool = False
    is_fixed_in_world: bool = True
    changed: tuple[str, ...] = ()
    replaced_keys: tuple[str, ...] = ()
    obscure: str | None = None
    subtree: str | None = None
    reduced: str | None = None

    @property
    def called(self) -> str:
        """Its name in messages."""
        return self.prefix or self.part


def of_part(members: Iterable[PartRecord], part: str | None, separator: str) -> list[PartRecord]:
    """Return the members of a part: one, or all of a nested recipe; with None every one."""
    return [
        member for member in members if part is None or member.part == part or member.part.startswith(part + separator)
    ]


def in_words(method: str, wanted: Any) -> str:
    """Return how shapes are made of a mesh, and with which settings, as in plans and manifests.

    >>> in_words("decompose", {"parts": 8, "threshold": 0.05, "vertices": None, "seed": 1})
    'decompose (parts 8, threshold 0.05, seed 1)'
    """
    if isinstance(wanted, str):
        return f"{method} {wanted}"
    written = [f"{name} {shown(value)}" for name, value in wanted.items() if value is not None]
    return f"{method} ({', '.join(written)})" if written else method


MESH_VERBS = frozenset({"collision", "simplify"})
"""The verbs of `edit` that make something of meshes."""
BASE = "base"
"""The name in a recipe of the model that it starts from."""


@dataclass(frozen=True, slots=True)
class AttachPart:
    """Attach a model to a place, with its names under `prefix` (separator included).

    The base is one without a prefix, at the world. `copy` has its number on each axis of `replicate`, from 0.
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
    path: PathlibPath
    file: str
    document: Located
    separator: str
    conflict: Literal["error", "base", "mujoco"]
    angle_context: AngleContext
    base: AttachPart | None
    parts: tuple[AttachPart, ...]
    steps: tuple[Step, ...]
    settled: frozenset[str]
    checks: tuple[Check, ...] = ()
    datasheets: Mapping[str, Sheet] = field(default_factory=dict)
    """The data sheets of motors that the recipe has."""
    scope: Mapping[str, Value] = field(default_factory=dict)
    """The parameters of the recipe and the chosen variants, by name."""
    randomize: Randomize | None = None
    sample: int = 0
    """The number of the sample; 0 is the nominal model."""
    worlds: bool = False
    """Whether the samples are worlds of this model."""
    drawn: tuple[Drawn, ...] = ()
    """The parameters that were drawn for the sample."""
    variants: Mapping[str, str] = field(default_factory=dict)
    """The chosen variants only."""
    source: Source | None = None
    """The resolved recipe, if it is nested in another one."""
    extended: tuple[tuple[Source, Span], ...] = ()
    """The recipes that it extends, each with the place that names it."""
    at: Path = ()
    """The path in its file, for a model that is written in place."""
    cells: int = 0
    """The number of cells of its matrix, if this model is none of them."""
    cells_at: Span | None = None
    """Where the first of them is written."""

    def place_of(self, at: Path) -> tuple[str, Path]:
        """Return the file of a path in this recipe, and the path in the file."""
        return self.file, (*self.at, *at)

    @property
    def members(self) -> tuple[AttachPart, ...]:
        """The base, if there is one, and the parts."""
        return self.parts if self.base is None else (self.base, *self.parts)

    @property
    def base_keys(self) -> KeyPolicy:
        """What becomes of the keys of the base."""
        return "merge" if self.base is None else self.base.attachment.key_policy

    @property
    def span(self) -> Span:
        """The place for messages about the whole model: where its only source is named, or the recipe."""
        places = [each.span for each in self.members]
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
        steps = tuple(replace(step, sample=sample) if isinstance(step, DrawValues) else step for step in self.steps)
        return replace(self, steps=steps, sample=sample)

    def walk(self, is_fixed: bool = True) -> Iterator[PlacedModel]:
        """Yield the plan itself, then its base and its parts in their order, each followed by its contents.

        `is_fixed` says that the plan itself is fixed in the world.
        """
        yield from _walk(PlacedModel(self, is_fixed_in_world=is_fixed))

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
        return draws_by_part or any(each.part is not None for selector in selectors for each in selector.all())

    @property
    def prefixes(self) -> frozenset[str]:
        """The prefixes of all parts, including those of nested recipes; `""` is the base."""
        return frozenset(place.prefix for place in self.walk())


@dataclass(frozen=True, slots=True)
class PlacedModel:
    """A model and its place in the outermost plan: that plan itself, or a base or part of it or of a nested plan.

    `outer` is the plan that it is the base or a part of, by `step`; both are None for the outermost plan. `part` is
    its name in the outermost recipe, empty for that recipe itself; `prefix` starts its names, `keys` the names of
    its keyframes, None if they are left out. `others` are longer prefixes that do not belong to it. `is_fixed_in_world`
    is about the final model, `span` is its place in the outermost recipe.
    """

    model: Source | Plan | None
    outer: Plan | None = None
    step: AttachPart | None = None
    part: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""
    is_fixed_in_world: bool = True
    span: Span | None = None

    @property
    def request(self) -> Attachment | None:
        """The entry of the recipe around it that attaches it."""
        return None if self.step is None else self.step.attachment


def _walk(placed: PlacedModel) -> Iterator[PlacedModel]:
    yield placed
    plan = placed.model
    if not isinstance(plan, Plan):
        return
    above = f"{placed.part}{plan.separator}" if placed.part else ""
    prefixed = tuple(placed.prefix + part.prefix for part in plan.parts if part.prefix)
    for part in plan.members:
        policy = part.attachment.key_policy
        keys = None if policy == "none" or placed.keys is None else placed.keys
        yield from _walk(
            PlacedModel(
                part.model,
                plan,
                part,
                part=above + part_name(part, plan.separator),
                prefix=placed.prefix + part.prefix,
                others=placed.others if part is not plan.base else (*placed.others, *prefixed),
                keys=keys + part.prefix if keys is not None and policy == "prefix" else keys,
                is_fixed_in_world=placed.is_fixed_in_world and is_fixed_in_world(part.attachment),
                span=placed.span or part.span,
            )
        )


def part_name(part: AttachPart, separator: str) -> str:
    """Return a part's name in its recipe: the prefix, or the key if it has no prefix."""
    return part.prefix.removesuffix(separator) or str(part.at[-1])


def is_fixed_in_world(part: Attachment) -> bool:
    """Return whether a part is fixed in the world of its recipe."""
    in_world = part.site is None and part.frame is None and part.body in (None, "world")
    return in_world and part.joint in (None, "none")

"""The plan of a build: data that can be printed, compared and carried out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence, Set as AbstractSet
from dataclasses import field, replace
from pathlib import Path as PathlibPath
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Path, Span
from mjcompose.base.rotation import Pose
from mjcompose.base.words import number_text
from mjcompose.language.attach import Attachment
from mjcompose.language.check import Check
from mjcompose.language.datasheets import Sheet
from mjcompose.language.edit import Drop, Edit, with_settings
from mjcompose.language.recipe import Order
from mjcompose.language.value import attribute_and_index
from mjcompose.mujoco.attributes import arrays_of
from mjcompose.plan.steps import (
    AddedPlace,
    AngleContext,
    DrawValues,
    EditElements,
    OrderElements,
    Step,
    WriteKeyframe,
    added_places,
)
from mjcompose.sources.reference import ReadAs, Source
from mjcompose.text.expression import Value
from mjcompose.text.node import Mapping as Located
from mjcompose.tree.merged_settings import Adopted, KeyPolicy, ReadRow
from mjcompose.tree.pattern import paths_of

if TYPE_CHECKING:
    from mjcompose.language.distribution import Operation
    from mjcompose.language.identify import Identify
    from mjcompose.language.randomize import DrawField, Randomize
    from mjcompose.link.subtree import DroppedElement, Subtree
    from mjcompose.plan.measured import Measurements
    from mjcompose.plan.measured_draws import DrawnNumber, MeasuredDraws


class Drawn(Struct):
    """A draw for an attribute of an element, or (`element` None) for the parameter `attribute`.

    `element` identifies the draw: a name, or the place of an unnamed element. `shared` says that all elements have the
    same draw. Angles are in radians, or in the unit of the parameter; `start` is the first component. `column` is the
    name of its column in a table, if that is not made of the field and the element.
    """

    field: str
    element: str | None
    attribute: str
    operation: Operation
    value: Value
    shared: bool = False
    start: int = 0
    column: str | None = None

    def columns(self) -> list[tuple[str, Value]]:
        """Return the numbers, each with the name of its column in a table of samples.

        >>> Drawn("camera", "top", "pos", "offset", (0.1, 0.2)).columns()
        [('camera[top][0]', 0.1), ('camera[top][1]', 0.2)]
        """
        name = self.field if self.shared or self.element is None else f"{self.field}[{self.element}]"
        name = self.column or name
        if isinstance(self.value, tuple):
            return [(f"{name}[{index}]", each) for index, each in enumerate(self.value)]
        return [(name, self.value)]


class ElementDraws(Struct):
    """The draws for one element in all samples from 1, for a table; `first` is the draw of sample 1.

    `name` is the element's name, if any; `place` is its body, its number among the elements with its tag there, and
    their count. `numbers` are the draws, separately for each number of the attribute. `angles` says which of the
    numbers are angles, and `unit` is the unit of bare angles.
    """

    first: Drawn
    field: DrawField | DrawnNumber
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
    return ({"actuator_ctrlrange"} if name == "range" else set()).union(arrays_of(name, tag))


class GeneratedShapes(Struct):
    """`shapes` are the geoms that were generated for the geom `of`; there are none for a simplified mesh.

    `error` has the distances in meters and the shares that `mjcompose.mujoco.fit` measures, `faces` is the number of
    faces of the mesh, `made_with` has the versions of the tools. `key` is the hash of the input.
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
        return with_settings(self.method, self.wanted)

    @property
    def words(self) -> str:
        """The line that `plan` prints."""
        mm = {name: f"{number_text(float(f'{1000 * (value or 0):.3g}'))} mm" for name, value in self.error.items()}
        result = f"simplified, {mm['hausdorff']} off"
        if self.method != "simplify":
            count = len(self.shapes)
            result = f"{count} geom{'s' * (count != 1)}" + (f" for {self.of}" if self.of else "")
            result += f", {mm['beyond']} beyond it and {mm['short']} short of it"
        volume = self.error["volume"]
        share = "" if volume is None else f", {volume:.3g} of its volume"
        return f"{self.mesh} ({self.faces} faces): {result}{share}"


RecipePath: TypeAlias = tuple[str, Path]
"""A recipe's file, and a path in it."""


class EditOutcome(Struct):
    """The elements that an entry of `edit` selects, by kind, and removes, followed by their dependents."""

    selected: Mapping[str, int]
    removed: tuple[DroppedElement, ...] = ()
    shapes: tuple[GeneratedShapes, ...] = ()


class ExcludedPair(Struct):
    """Two bodies that need not collide, and the reason in words; "" for bodies that touch."""

    one: str
    other: str
    why: str


class Gains(Struct):
    """The stiffness and damping of a servo at its joint or tendon, by its `gear`; `unit` is N, N·m, or ""."""

    actuator: str
    kp: float
    kv: float
    gear: float
    unit: str


class PlanPreview(Struct):
    """Facts that only composing determines, such as settings from parts, and bodies that need not collide.

    `unsearched` is the number of pairs of bodies that may never touch, but that were not searched.
    """

    subtrees: Mapping[RecipePath, Subtree] = field(default_factory=dict)
    edits: Mapping[RecipePath, EditOutcome] = field(default_factory=dict)
    adopted: tuple[Adopted, ...] = ()
    excluded: tuple[ExcludedPair, ...] = ()
    unsearched: int = 0
    gains: tuple[Gains, ...] = ()


IN_PLACE = Pose()
Tables: TypeAlias = Mapping[ReadAs, tuple[ReadRow, ...]]
"""The elements of sources that are not MJCF: those that were read, and those that were ignored."""


class PartRecord(Struct):
    """A source model, the prefix of its names (separator included), and the pose of its own world.

    `part` is its name in a recipe: the prefix without its last separator, `base` for the base, and both for a part of a
    part. Its world is fixed to `body`, None for the world, with the `pose` there, None if unknown. `keys` starts the
    names of its keys; None if they were dropped. `welded` says that free joints at its root were removed, and
    `is_fixed_in_world` is about the final model. The recipe changes the arrays `changed` and writes `replaced_keys`.
    `obscure` is the reason that it cannot be compared, and `reduced` the reason that it is compared only on request.
    `subtree` is the only body that is used.
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
        return self.prefix or self.part


def of_part(members: Iterable[PartRecord], part: str | None, separator: str) -> list[PartRecord]:
    """Return the record of a part, or all records of a nested recipe; with None all of them."""
    return [each for each in members if part is None or each.part == part or each.part.startswith(part + separator)]


MESH_VERBS = frozenset({"collision", "simplify"})
"""The verbs of `edit` that work on meshes."""
BASE = "base"
"""The name in a recipe of the model that it starts from."""


class AttachPart(Struct):
    """Attach a model to a place, with its names under `prefix` (separator included).

    The base has no prefix, and is at the world. `copy` has the number on each axis of `replicate`, from 0. `inner` are
    the recipes that the MJCF of the model attaches itself. `moved` is the pose of a scattered copy in the frame of its
    place; `floats` says that the copy is a free body, to find a place for it.
    """

    prefix: str
    model: Source | Plan
    attachment: Attachment
    at: tuple[str | int, ...]
    span: Span
    copy: tuple[int, ...] = ()
    inner: tuple[Plan, ...] = ()
    moved: Pose | None = None
    floats: bool = False

    @property
    def waits(self) -> bool:
        """Whether it is a scattered copy without a pose."""
        return self.attachment.scatter is not None and self.moved is None


class DropElements(Struct):
    drop: tuple[Drop, ...]
    span: Span

    @property
    def words(self) -> str:
        """A description on one line."""
        return f"drop {', '.join(map(str, self.drop))}"


class Plan(Struct):
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
    identify: Identify | None = None
    """The numbers that `mjcompose identify` fits."""
    measured: Measurements | None = None
    """The file of measurements whose numbers are among the edits."""
    randomize: Randomize | None = None
    sample: int = 0
    """The number of the sample; 0 is the nominal model."""
    worlds: bool = False
    """Whether the samples are worlds of this model."""
    drawn: tuple[Drawn, ...] = ()
    """The parameters and the measured numbers that were drawn for the sample."""
    measured_draws: MeasuredDraws | None = None
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
    def interface(self) -> tuple[Order, ...]:
        return tuple(step.order for step in self.steps if isinstance(step, OrderElements))

    @property
    def key_sources(self) -> frozenset[str]:
        """The parts, by path, whose keys other keys use."""
        return frozenset(part for step in self.keyframes for part in step.key.sources)

    @property
    def edits(self) -> tuple[EditElements, ...]:
        """The steps that edit the whole model."""
        return tuple(step for step in self.steps if isinstance(step, EditElements))

    @property
    def added_places(self) -> Mapping[tuple[str, str], AddedPlace]:
        """The bodies, frames and sites that are added, by kind and name."""
        return added_places(self.steps, self.document)

    @property
    def draws(self) -> tuple[DrawValues, ...]:
        """The steps that draw attributes of the whole model."""
        return tuple(step for step in self.steps if isinstance(step, DrawValues))

    def draws_assets(self, kind: str) -> bool:
        """Whether a draw, here or in a nested recipe, may change an asset of this kind, itself or by its class."""
        selectors = [step.field.select for plan in self.plans() for step in plan.draws if step.field.select]
        paths = {path for selector in selectors for path in paths_of(selector.tag)}
        return not paths.isdisjoint({kind, "default"})

    def of_sample(self, sample: int) -> Plan:
        """Return the plan with the draws of another sample; parameters keep their values."""
        steps = tuple(replace(step, sample=sample) if isinstance(step, DrawValues) else step for step in self.steps)
        return replace(self, steps=steps, sample=sample)

    def walk(self, is_fixed: bool = True) -> Iterator[PlacedModel]:
        """Yield the plan, fixed in the world if `is_fixed`, then its base and parts, each followed by its contents."""
        yield from _walk(PlacedModel(self, separator=self.separator, is_fixed_in_world=is_fixed))

    def places(self) -> Iterator[PlacedModel]:
        """Yield the same as `walk`, then the recipes that MJCF attaches, under the names of their parts."""
        placed = list(self.walk())
        yield from placed
        for place in placed:
            if place.step is not None:
                for plan in place.step.inner:
                    for each in plan.places():
                        part = f"{place.above}{each.part}" if each.part else place.part
                        yield replace(each, part=part, span=place.span)

    def plans(self) -> Iterator[Plan]:
        """Yield the plan, and the plans of its nested recipes."""
        yield from (place.model for place in self.places() if isinstance(place.model, Plan))

    @property
    def copies(self) -> dict[str, Hashable]:
        """The prefixes of the copies that `replicate` makes and of parts in them, with a value for each original."""
        parts = {place.prefix: (id(place.outer), place.step.at) for place in self.walk() if place.step is not None}
        counts = Counter(parts.values())
        return {prefix: part for prefix, part in parts.items() if counts[part] > 1}

    @property
    def joins_names(self) -> bool:
        """Whether it, or a recipe in it, joins its separator to names: it gives a part a prefix."""
        plans = (place.model for place in self.walk() if isinstance(place.model, Plan))
        return any(part.prefix for plan in plans for part in plan.parts)

    def sources(self) -> Iterator[Source]:
        """Yield the model files of the plan and of its nested recipes."""
        yield from (place.model for place in self.places() if isinstance(place.model, Source))

    @property
    def part_names(self) -> tuple[str, ...]:
        """The paths of all parts of the recipe: `base`, `left`, `left/gripper`."""
        return tuple(place.part for place in self.walk() if place.part and place.model is not None)

    @property
    def all_edits(self) -> list[Edit]:
        """The entries of `edit`, here, at parts and in nested recipes."""
        of_parts = [edit for place in self.places() if place.request is not None for edit in place.request.edit]
        return [step.edit for plan in self.plans() for step in plan.edits] + of_parts

    @property
    def works_on_meshes(self) -> bool:
        """Whether an entry of `edit`, here, at a part or in a nested recipe, works on meshes."""
        return any(not MESH_VERBS.isdisjoint(edit.verbs) for edit in self.all_edits)

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


class PlacedModel(Struct):
    """A model and its place in the outermost plan: that plan itself, or a base or part of it or of a nested plan.

    It is the base or a part of `outer` by `step`, None for the outermost plan. `part` is its name in the outermost
    recipe, empty for the recipe itself, and `separator` is between it and the name of a part in it. `prefix` starts its
    names, and `keys` starts the names of its keyframes; None without keyframes. `others` are longer prefixes.
    `is_fixed_in_world` is about the final model, and `span` is about the outermost recipe.
    """

    model: Source | Plan | None
    outer: Plan | None = None
    step: AttachPart | None = None
    part: str = ""
    separator: str = ""
    prefix: str = ""
    others: tuple[str, ...] = ()
    keys: str | None = ""
    is_fixed_in_world: bool = True
    span: Span | None = None

    @property
    def request(self) -> Attachment | None:
        """The entry of the recipe around it that attaches it."""
        return None if self.step is None else self.step.attachment

    @property
    def above(self) -> str:
        """The start of the names of parts in it."""
        return f"{self.part}{self.separator}" if self.part else ""


def _walk(placed: PlacedModel) -> Iterator[PlacedModel]:
    yield placed
    plan = placed.model
    if not isinstance(plan, Plan):
        return
    prefixed = tuple(placed.prefix + part.prefix for part in plan.parts if part.prefix)
    for part in plan.members:
        policy = part.attachment.key_policy
        keys = None if policy == "none" or placed.keys is None else placed.keys
        inner = PlacedModel(
            part.model,
            plan,
            part,
            part=placed.above + part_name(part, plan.separator),
            separator=plan.separator,
            prefix=placed.prefix + part.prefix,
            others=placed.others if part is not plan.base else (*placed.others, *prefixed),
            keys=keys + part.prefix if keys is not None and policy == "prefix" else keys,
            is_fixed_in_world=placed.is_fixed_in_world and is_fixed_in_world(part.attachment),
            span=placed.span or part.span,
        )
        yield from _walk(inner)


def part_name(part: AttachPart, separator: str) -> str:
    """Return a part's name in its recipe: the prefix, or the key if it has no prefix."""
    return part.prefix.removesuffix(separator) or str(part.at[-1])


def is_fixed_in_world(part: Attachment) -> bool:
    """Return whether a part is fixed in the world of its recipe."""
    return part.site is None and part.frame is None and part.body in (None, "world") and part.joint in (None, "none")

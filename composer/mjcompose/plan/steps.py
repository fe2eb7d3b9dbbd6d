"""All types of steps, in the order in which they are carried out, and their use of angles and added places."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Container, Iterator, Mapping as Map, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Path, Span
from mjcompose.base.sink import Sink
from mjcompose.base.words import with_article
from mjcompose.language.contact import Collisions, Contact
from mjcompose.language.edit import Edit
from mjcompose.language.expand import Concrete
from mjcompose.language.fragment import names_in
from mjcompose.language.keyframe import Keyframe
from mjcompose.language.parameters import Substitution
from mjcompose.language.recipe import Order, Recipe, sections_of
from mjcompose.language.sections import Elements, Singleton
from mjcompose.language.validate import judge
from mjcompose.language.value import RecipeElement
from mjcompose.text.node import Mapping, Node, locate, to_python

if TYPE_CHECKING:
    from mjcompose.language.randomize import DrawField, Randomize
    from mjcompose.plan.measured_draws import DrawnNumber

SETTINGS = ("angle", "eulerseq")


class AngleSettings(Struct):
    """The settings of one file: the unit of bare angles (None: not allowed), and the sequence of `euler`."""

    angle: str | None = None
    eulerseq: str = "xyz"


class AngleContext(Struct):
    """The settings of a merged recipe as a `whole`, and the settings of its files that differ from it."""

    document: Mapping
    whole: AngleSettings = AngleSettings()
    others: Map[str, AngleSettings] = dataclasses.field(default_factory=dict)

    def at(self, path: Path) -> AngleSettings:
        """Return the settings for the value at a path."""
        return self.others.get(locate(self.document, path).file, self.whole) if self.others else self.whole


def angle_context_of(
    concrete: Concrete, document: Mapping, whole: AngleSettings, files: Map[str, Node], sink: Sink
) -> AngleContext:
    """Return the angle context of a concrete recipe's `document`. `files` has the settings of each file."""
    others: dict[str, AngleSettings] = {}
    for file, said in files.items():
        node = Substitution(concrete.scope, frozenset(), sink=sink).of(said)
        assert isinstance(node, Mapping)
        faults = [fault for fault in judge(node)[1] if fault.at[:1] in [(name,) for name in SETTINGS]]
        for fault in faults:
            sink.error(fault.code, fault.message, locate(node, fault.at, key=fault.key), help=fault.help)
        read = whole if faults else AngleSettings(**to_python(node))
        if read != whole:
            others[file] = read
    return AngleContext(document, whole, others)


def check_bare_angles(angle_context: AngleContext, sink: Sink) -> None:
    """Report bare angles in files that do not set `angle` if another file does."""
    if angle_context.whole.angle is None or all(each.angle is not None for each in angle_context.others.values()):
        return
    document = angle_context.document
    silent = Mapping({name: each for name, each in document.entries.items() if name != "angle"}, document.span)
    for fault in judge(silent)[1]:
        if fault.code == "bare-angle" and angle_context.at(fault.at).angle is None:
            message = f"{fault.message}, and its file does not say which"
            sink.error(fault.code, message, locate(document, fault.at), help=fault.help)


class WrittenRecipe(Struct):
    """A recipe with its draws, and the place of each value in its document.

    `draw_words` has words about the draw of a measured number by its place, `numbers_of_worlds` are the measured
    numbers that differ between worlds.
    """

    recipe: Recipe
    document: Mapping
    randomize: Randomize | None
    sample: int
    worlds: bool = False
    draw_words: Map[Span, str] = dataclasses.field(default_factory=dict)
    numbers_of_worlds: tuple[DrawnNumber, ...] = ()

    def span(self, at: Path, key: bool = False) -> Span:
        """Return the place of a value in the recipe, or of its key."""
        return locate(self.document, at, key=key)


class Step(ABC):
    """An entry that a recipe writes. A type of step is a frozen dataclass with a `span`, and a row of `planner.STEPS`.

    `sections` are the top-level keys that it carries out. Steps that have `waits` come after all other steps.
    """

    __slots__ = ()
    sections: ClassVar[tuple[str, ...]]
    waits: ClassVar[bool] = False
    why: ClassVar[str] = ""
    span: Span

    @classmethod
    @abstractmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        """Yield the steps of this type in a recipe, in the order in which they are carried out."""

    @property
    @abstractmethod
    def words(self) -> str:
        """The line that `plan` prints for the step."""

    @property
    def reason(self) -> str:
        """The reason that `explain` gives for an element or attribute written by the step: `why`, or the words."""
        return self.why or self.words


def words_of_element(element: RecipeElement) -> str:
    """Return the name of an element in the words of a step.

    >>> words_of_element(RecipeElement("geom")), words_of_element(RecipeElement("site", {"name": "tip"}))
    ('a geom', 'site tip')
    """
    name = element.attributes.get("name")
    return f"{element.tag} {name}" if name is not None else with_article(element.tag)


@dataclass(frozen=True, slots=True)
class AddElement(Step):
    """Add an element to a body, a frame or the world (`to_kind` world, body, frame)."""

    why: ClassVar[str] = "added by the recipe"
    sections: ClassVar[tuple[str, ...]] = ("add",)
    to_kind: Literal["world", "body", "frame"]
    to: str
    element: RecipeElement
    to_span: Span
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        for item in source.recipe.add:
            path = (*item.at, "to", "frame") if item.to_kind == "frame" else (*item.at, "to")
            for element in item.elements:
                yield cls(item.to_kind, item.to_name, element, source.span(path), source.span(element.at))

    @property
    def words(self) -> str:
        where = "the world" if self.to_kind == "world" else f"the {self.to_kind} {self.to}"
        return f"add {words_of_element(self.element)} to {where}"


KINDS = ("body", "frame", "site")


class AddedPlace(Struct):
    """A place and the step that adds it; `span` is where its name is written."""

    step: AddElement
    span: Span


def added_places(steps: Sequence[Step], document: Mapping) -> dict[tuple[str, str], AddedPlace]:
    """Return every place that the steps add, by kind and name; for duplicate names, the first one."""
    found: dict[tuple[str, str], AddedPlace] = {}
    for step in steps:
        if isinstance(step, AddElement):
            for kind, name, span in _added_places_of(step.element, document):
                found.setdefault((kind, name), AddedPlace(step, span))
    return found


def steps_adding(
    places: Map[tuple[str, str], AddedPlace], kind: str, name: str, done: Container[int] = ()
) -> list[AddElement]:
    """Return the steps that create a place, in order, without the steps `done`, by id; none if no step creates it."""
    found: dict[int, AddElement] = {}
    while (place := places.get((kind, name))) is not None and id(place.step) not in found:
        if id(place.step) in done:
            break
        found[id(place.step)] = place.step
        kind = place.step.to_kind
        name = place.step.to
    return [*reversed(found.values())]


def _added_places_of(element: RecipeElement, document: Mapping) -> Iterator[tuple[str, str, Span]]:
    if element.xml is not None:
        yield from ((tag, name, locate(document, (*element.at, "xml"))) for tag, name in names_in(element.xml, KINDS))
        return
    name = element.attributes.get("name")
    if name is not None and element.tag in KINDS:
        yield element.tag, str(name), locate(document, (*element.at, "name"))
    for child in element.children:
        yield from _added_places_of(child, document)


@dataclass(frozen=True, slots=True)
class AppendElement(Step):
    why: ClassVar[str] = "written in the recipe"
    sections: ClassVar[tuple[str, ...]] = tuple(
        name for name in Recipe.model_fields if name in (*sections_of(Elements), "contact")
    )
    section: str
    element: RecipeElement
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        for section in cls.sections:
            written = getattr(source.recipe, section)
            elements = written.elements if isinstance(written, Contact) else written
            for element in elements:
                yield cls(section, element, source.span(element.at, key=True))

    @property
    def words(self) -> str:
        return f"add {words_of_element(self.element)} to {self.section}"


@dataclass(frozen=True, slots=True)
class DrawValues(Step):
    """Draw the values of a field for a sample. For sample 0, which has no draws, check all other samples."""

    waits: ClassVar[bool] = True
    sections: ClassVar[tuple[str, ...]] = ("randomize",)
    field: DrawField | DrawnNumber
    seed: int
    sample: int
    samples: int
    span: Span
    tabled: bool = False

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        randomize = source.randomize
        if randomize is None:
            return
        fields: list[DrawField | DrawnNumber] = [*source.numbers_of_worlds]
        fields += [field for field in randomize.fields if field.select is not None and field.source is None]
        for field in fields:
            span = source.span(field.drawn_at)
            yield cls(field, randomize.seed, source.sample, samples=randomize.samples, span=span, tabled=source.worlds)

    @property
    def words(self) -> str:
        return self.field.words

    @property
    def reason(self) -> str:
        return f"{self.words}, sample {self.sample}"


@dataclass(frozen=True, slots=True)
class EditElements(Step):
    """Change the selected elements, in the whole model or in one part."""

    waits: ClassVar[bool] = True
    sections: ClassVar[tuple[str, ...]] = ("edit",)
    edit: Edit
    span: Span
    draw: str = ""
    """The words for the draw of a measured number; empty if it is not drawn."""

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        for edit in source.recipe.edit:
            span = source.span(edit.at)
            yield cls(edit, span, source.draw_words.get(span, ""))

    @property
    def words(self) -> str:
        return f"{self.edit.words}, {self.draw}" if self.draw else self.edit.words


@dataclass(frozen=True, slots=True)
class SetCollisions(Step):
    """Exclude contacts between bodies, or make geoms collide."""

    waits: ClassVar[bool] = True
    sections: ClassVar[tuple[str, ...]] = ()
    collisions: Collisions
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        yield from (cls(each, source.span(each.at)) for each in source.recipe.contact.collisions)

    @property
    def words(self) -> str:
        if self.collisions.samples is not None:
            drawn = f"{self.collisions.samples} samples, seed {self.collisions.seed}"
            return f"exclude contacts between bodies that need not collide ({drawn})"
        if not self.collisions.sides:
            return "exclude contacts between bodies of different parts that touch"
        one, other = (", ".join(side) for side in self.collisions.sides)
        if self.collisions.what == "exclude":
            return f"exclude contacts between {one} and {other}"
        return f"let {one} and {other} collide"


@dataclass(frozen=True, slots=True)
class SetDefault(Step):
    """Set a default class, creating it if it does not exist."""

    why: ClassVar[str] = "set by the recipe"
    sections: ClassVar[tuple[str, ...]] = ("default",)
    name: str
    parent: str | None
    element: RecipeElement
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        for each in source.recipe.default:
            yield cls(each.name, each.parent, each.element, span=source.span(each.element.at, key=True))

    @property
    def words(self) -> str:
        return f"set the default class {self.name}: {', '.join(child.tag for child in self.element.children)}"


@dataclass(frozen=True, slots=True)
class SetSingleton(Step):
    """Set attributes of a section that a model has once (`option`, `visual`, …)."""

    why: ClassVar[str] = "set by the recipe"
    sections: ClassVar[tuple[str, ...]] = sections_of(Singleton)
    section: str
    element: RecipeElement
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        for section in cls.sections:
            element: RecipeElement | None = getattr(source.recipe, section)
            if element is not None:
                yield cls(section, element, source.span(element.at, key=True))

    @property
    def words(self) -> str:
        return f"set {self.section}: {', '.join(_settings(self.element))}"

    @property
    def settled(self) -> Iterator[str]:
        """The paths of the values that are set (`option/cone`)."""
        return _paths(self.element, self.section)


def _settings(element: RecipeElement, path: str = "") -> Iterator[str]:
    yield from (f"{path}{name} = {value}" for name, value in element.attributes.items())
    for child in element.children:
        yield from _settings(child, f"{path}{child.tag}.")


def _paths(element: RecipeElement, path: str) -> Iterator[str]:
    yield from (f"{path}/{name}" for name in element.attributes)
    for child in element.children:
        yield from _paths(child, f"{path}/{child.tag}")


@dataclass(frozen=True, slots=True)
class WriteKeyframe(Step):
    """Write a key by the names of joints, actuators and mocap bodies, replacing an existing key of that name."""

    waits: ClassVar[bool] = True
    sections: ClassVar[tuple[str, ...]] = ("keyframe",)
    key: Keyframe
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        yield from (cls(key, source.span(key.at, key=True)) for key in source.recipe.keyframe.values())

    @property
    def words(self) -> str:
        return f"write the keyframe {self.key.name}"


@dataclass(frozen=True, slots=True)
class OrderElements(Step):
    """Bring joints, actuators, sensors or keys into the order of `interface`."""

    waits: ClassVar[bool] = True
    sections: ClassVar[tuple[str, ...]] = ("interface",)
    order: Order
    span: Span

    @classmethod
    def of(cls, source: WrittenRecipe) -> Iterator[Step]:
        if source.recipe.interface is not None:
            for order in source.recipe.interface.orders:
                yield cls(order, source.span(order.at, key=True))

    @property
    def words(self) -> str:
        more = ", …" if self.order.more else ""
        return f"order the {self.order.kind}s: {', '.join(self.order.names) or 'none'}{more}"

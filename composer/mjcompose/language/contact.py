"""The section `contact`: pairs, and which bodies and parts do not collide or may collide."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, ModelWrapValidatorHandler, PrivateAttr, Tag, model_validator

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.suggest import closest
from mjcompose.language.element import Reader, label
from mjcompose.language.forms.context import ByGrammar, Schema, Settings, reference
from mjcompose.language.forms.model import Model, OneOf
from mjcompose.language.forms.scalars import Checked, Count, Expects, Items, Name, Turns, When, whole
from mjcompose.language.value import RecipeElement, kind_of
from mjcompose.tree.grammar import GRAMMAR

BETWEEN = "between"
SAMPLES = 1000


class Collisions(Struct):
    """Bodies that must not collide (`exclude`), or geoms that may (`collide`).

    The two `sides` are names of parts or globs over bodies. They are empty for bodies that already touch, and for
    bodies found in random configurations; `samples` of these are drawn with a `seed`. `at` is the path of the entry
    from the top of the recipe.
    """

    what: Literal["exclude", "collide"]
    sides: tuple[tuple[str, ...], ...]
    at: Path
    samples: int | None = None
    seed: int = 0


class _ElementOf(ByGrammar):
    def __init__(self, path: str) -> None:
        self.kind = GRAMMAR.element(path)

    def schema(self) -> Schema:
        return reference(f"element:{self.kind.path}")

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> RecipeElement | None:
        return Reader(settings, faults).element(self.kind, value, (), label(self.kind.tag, value))


_Side = Annotated[
    tuple[Annotated[str, Name("part", glob=True, what="a name or a glob")], ...],
    Items(1, single=True),
    Expects("a name, a glob or a list of them"),
]
_Sides = Annotated[tuple[_Side, ...], Items(2, 2), Expects("two sides", "[ARM, TABLE]")]


class Auto(Model):
    """Bodies that need not collide. `plan` has the reason for each pair."""

    example: ClassVar = f"{{samples: {SAMPLES}}}"

    samples: Annotated[int, Field(ge=1, le=1_000_000), BeforeValidator(whole)] = SAMPLES
    """the number of random poses in which nothing may touch"""
    seed: Count = 0
    """the seed of the poses"""


class Between(Model):
    """Two sides: parts by name, or globs over names of bodies."""

    example: ClassVar = "{between: [ARM, TABLE]}"

    between: _Sides = Field(examples=["[ARM, TABLE]"])
    """the two sides: parts by name, or globs over names of bodies"""
    repeats: Turns = Field(None, alias="for")
    when: When = None


class Excluded(Model):
    """Bodies that do not collide: the bodies of two sides, or bodies that need not collide."""

    rules: ClassVar = (
        OneOf(BETWEEN, "auto", lacks="names no bodies", advice="write `between: [ARM, TABLE]`, or `auto: {}`"),
    )
    example: ClassVar = "{between: [ARM, TABLE]}"

    between: _Sides | None = None
    """the two sides: parts by name, or globs over names of bodies"""
    auto: Auto | None = None
    """bodies that need not collide; `plan` lists the reason for each pair"""
    repeats: Turns = Field(None, alias="for")
    when: When = None


def _form_of(entry: Any) -> str:
    if isinstance(entry, RecipeElement):
        return "<element>"
    if not isinstance(entry, dict):
        return "<word>" if isinstance(entry, str) else "<mapping>"
    is_ours = not entry or any(key == "auto" or closest(key, (BETWEEN,)) for key in entry)
    return "<mapping>" if is_ours else "<element>"


def _lone_fault(value: Any) -> Fault | None:
    if not isinstance(value, dict) or _form_of(value) != "<element>":
        return None
    message = f"`exclude` in `contact` expects a list, got {kind_of(value)}"
    return Fault("wrong-type", message, help="write `exclude: [{…}]`")


_Word = Annotated[Literal["touching", "auto"], Tag("<word>")]
_Bodies = Annotated[Excluded, Tag("<mapping>")]
_Element = Annotated[RecipeElement, _ElementOf("contact/exclude"), Tag("<element>")]
_Exclude = Annotated[_Word | _Bodies | _Element, Discriminator(_form_of)]
_Lone = Annotated[_Word | _Bodies, Discriminator(_form_of)]


class Contact(Model):
    """Pairs of geoms that may touch, and bodies that may not."""

    noun: ClassVar = "element"
    depth: ClassVar = 3
    example: ClassVar = "{exclude: [{body1: NAME, body2: NAME}]}"

    pair: Annotated[tuple[Annotated[RecipeElement, _ElementOf("contact/pair")], ...], Items(), Expects("a list")] = ()
    """Pairs of geoms that may touch."""
    exclude: Annotated[tuple[_Exclude, ...], Items(single=_Lone), Checked(_lone_fault, first=True)] = ()
    """Pairs of bodies that must not collide: two bodies, all bodies `between` two sides, bodies that are `touching`, or
    `auto` for all pairs that need not collide."""
    collide: Annotated[tuple[Between, ...], Items(single=True)] = ()
    """Adds a `pair` for every two geoms of these parts that could not touch otherwise."""

    _written: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _in_order(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        made = handler(value)
        made._written = tuple(value) if isinstance(value, dict) else ()
        return made

    @property
    def elements(self) -> tuple[RecipeElement, ...]:
        entries = (each for key in self._written for each in getattr(self, key))
        return tuple(each for each in entries if isinstance(each, RecipeElement))

    @property
    def collisions(self) -> tuple[Collisions, ...]:
        top = self.at or ("contact",)
        found = [Collisions("collide", each.between, each.at) for each in self.collide]
        for index, each in enumerate(self.exclude):
            if isinstance(each, str):
                at = (*top, "exclude", index)
                found.append(Collisions("exclude", (), at, samples=SAMPLES if each == "auto" else None))
            elif isinstance(each, Excluded) and each.auto is not None:
                found.append(Collisions("exclude", (), each.at, samples=each.auto.samples, seed=each.auto.seed))
            elif isinstance(each, Excluded):
                found.append(Collisions("exclude", each.between or (), each.at))
        return tuple(found)

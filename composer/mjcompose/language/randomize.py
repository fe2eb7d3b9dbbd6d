"""The section `randomize`: seeded draws of fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.distribution import CHOICE
from mjcompose.base.limits import advice, in_force
from mjcompose.base.words import value_text
from mjcompose.language.assign import MASS, Checker
from mjcompose.language.distribution import (
    DISTRIBUTIONS,
    KINDS,
    DrawnChange,
    FieldDistribution,
    Operation,
    WrittenDistribution,
    read,
)
from mjcompose.language.forms.context import Rows, Settings
from mjcompose.language.forms.model import IT, OWNER, Bars, Belongs, Model, Needs, OneOf
from mjcompose.language.forms.scalars import Checked, Count, Expects, Name, Selects, Text, whole
from mjcompose.language.measured import KINDS as MEASURED_KINDS
from mjcompose.language.select import NARROWED, kinds_of
from mjcompose.language.value import attribute_and_index, must_not_be_negative
from mjcompose.language.variation import NO_EMIT
from mjcompose.tree.grammar import Attribute
from mjcompose.tree.pattern import Selector

_OF_ELEMENTS = ("select", "attr", "per", "expect", "optional")
_OF_MEASURED = ("param", "attr", "per", "group", "expect")
FROM = "from"
_SIGNS = {"set": "=", "scale": "×", "offset": "+"}


class DrawField(Model):
    """An attribute of the selected elements, or a parameter, and the distribution from which it is drawn."""

    rules: ClassVar = (
        Bars("param", *_OF_ELEMENTS, why="draws a parameter"),
        Bars(FROM, *_OF_MEASURED, why="draws measured numbers"),
        Belongs("widen", to=FROM),
        Needs({"select": '{geom: "**"}', "attr": "friction"}, unless=("param", FROM)),
        OneOf(
            *KINDS,
            "scale",
            "offset",
            FROM,
            lacks="has no distribution",
            noun="key",
            help="give the other a field of its own",
            advice="write for instance `uniform: [0.8, 1.2]`, or `scale: {uniform: …}` for a factor",
        ),
    )
    example: ClassVar = '{select: {geom: "**"}, attr: friction, uniform: [0.5, 1]}'
    called: ClassVar = "field `{}` of `randomize`"
    owned: ClassVar = "field `{}`"
    instead: ClassVar = {**NARROWED, **dict.fromkeys(("gauss", "gaussian"), "normal")}

    select: Annotated[Selector, Selects()] | None = Field(None, examples=['{geom: "**"}'])
    """the elements whose attribute is drawn"""
    attr: Annotated[str, Name(what="an attribute of MJCF")] = Field("", examples=["friction"])
    """an attribute of MJCF, with an index for one number: `friction[0]`"""
    param: Annotated[str, Name(what="the name of a parameter")] | None = None
    """a parameter to draw, instead of `select` and `attr`"""
    written: Annotated[Mapping[str, WrittenDistribution], Rows(lambda: DISTRIBUTIONS)] = Field({}, alias="<kinds>")
    """the distribution of the value itself"""
    scale: DrawnChange | None = None
    """a distribution of factors"""
    offset: DrawnChange | None = None
    """a distribution of the amount to add"""
    source: Literal["measured"] | None = Field(None, alias="from")
    """`measured` draws the numbers of the recipe's file of measurements together, with their standard deviations and
    correlations, within their ranges; `select` draws only some of them"""
    widen: Annotated[float, Field(gt=0)] = 1.0
    """a factor for the standard deviations of measured numbers"""
    per: Literal["element", "body", "part", "sample"] = "element"
    """a draw for each element, for each body, for each part, or one for all in a sample"""
    group: Annotated[Text, Expects("the name of a group", "wear")] | None = None
    """fields with the same group share their draws: if one is high in its distribution, all are"""
    expect: Count | None = None
    """how many elements must be selected"""
    optional: bool = False
    """allows an empty selection"""

    @property
    def name(self) -> str:
        return str(self.at[-1])

    @property
    def operation(self) -> Operation:
        """How a draw is used: as the value, as a factor, or as an offset."""
        if self.written or self.source is not None:
            return "set"
        return "scale" if self.scale is not None else "offset"

    @cached_property
    def _read(self) -> tuple[str, FieldDistribution | Fault]:
        change = self.scale or self.offset
        ((kind, written),) = (change.written if change is not None else self.written).items()
        return kind, read(kind, written, self.operation)

    @property
    def distribution(self) -> FieldDistribution:
        if self.source is not None:
            return FieldDistribution(self.source, {"widen": (self.widen,)})
        found = self._read[1]
        assert isinstance(found, FieldDistribution)
        return found

    @property
    def column(self) -> str | None:
        """The name of its column in a table, if that is not made of the field and the element."""
        return None

    @property
    def stream(self) -> str:
        """The name of its random numbers: the field itself, or its group, whose fields share them."""
        return self.name if self.group is None else f"group {self.group}"

    @property
    def _of_distribution(self) -> Path:
        if self.source is not None:
            return (FROM,)
        return (self._read[0],) if self.written else (self.operation, self._read[0])

    @property
    def drawn_at(self) -> Path:
        """The path to the distribution."""
        return (*self.at, *self._of_distribution)

    @property
    def words(self) -> str:
        """The drawn value, its element, and its distribution, as `plan` prints it on one line."""
        if self.source is not None:
            which = "the measured numbers" if self.select is None else f"the measured numbers of {self.select}"
            widened = "" if self.widen == 1 else f", with {value_text(self.widen)} times their standard deviations"
            return f"draw {self.name}: {which}, together{widened}"
        what = f"the parameter {self.param}" if self.param is not None else f"{self.attr} of {self.select}"
        shared = {"sample": ", one for all", "body": ", one a body", "part": ", one a part"}.get(self.per, "")
        grouped = f", with the others of {self.group}" if self.group is not None else ""
        return f"draw {self.name}: {what} {_SIGNS[self.operation]} {self.distribution}{shared}{grouped}"

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if self.source is not None:
            yield from self._selection_faults()
            return
        at = self._of_distribution
        found = self._read[1]
        if isinstance(found, Fault):
            yield replace(found, at=at)
        elif self.select is not None:
            yield from _attribute_faults(self, self.select, at, bare_angles=context.bare_angles)

    def _selection_faults(self) -> Iterator[Fault]:
        """Yield the fault of a selection of measured numbers, which are known by the names of their elements alone."""
        selector = self.select
        if selector is None:
            return
        narrowed = selector.parent or selector.inside or selector.part or selector.dclass or selector.where
        if selector.tag not in MEASURED_KINDS:
            message = f"a file of measurements has no numbers of `{selector.tag}`"
            yield Fault("selector", message, ("select",), help=f"select one of {', '.join(MEASURED_KINDS)}")
        elif narrowed:
            message = f"{OWNER} selects measured numbers, by the names of their elements alone"
            yield Fault("selector", message, ("select",), help=f"write `select: {{{selector.tag}: GLOB}}`")


def _attribute_faults(field: DrawField, selector: Selector, at: Path, *, bare_angles: bool) -> Iterator[Fault]:
    """Yield the faults of an attribute, by the grammar, or of the numbers that are drawn for it."""
    name, index = attribute_and_index(field.attr)
    kinds = kinds_of(selector.tag)
    fitting = [kind.attributes[name] for kind in kinds if name in kind.attributes]
    is_mass = name == MASS and any(kind.path == "body" for kind in kinds)
    fault = _fault_of_values(field, selector, at, fitting=fitting, is_mass=is_mass, bare_angles=bare_angles)
    if fault is not None:
        wrong_name = fault.code in ("unknown-attribute", "unknown-key", "unknown-element") or fault.key
        yield replace(fault, at=("attr",) if wrong_name else at, key=False, fix=fault.fix if wrong_name else None)
        return
    kind = field.distribution.kind
    if fitting and all(attribute.type == "int" for attribute in fitting) and kind not in ("integers", CHOICE):
        message = f"`{name}` of `{selector.tag}` is a whole number, which `{kind}` does not draw"
        yield Fault("wrong-type", message, at, help="write `integers: [FIRST, LAST]` or `choice: […]`")
    if field.operation != "offset":
        yield from _range_faults(field, name, index, at=at)


def _fault_of_values(
    field: DrawField, selector: Selector, at: Path, *, fitting: Sequence[Attribute], is_mass: bool, bare_angles: bool
) -> Fault | None:
    """Return the first fault of a value that can be drawn, or of the attribute itself."""
    faults: list[Fault] = []
    checker = Checker(bare_angles, faults)
    distribution = field.distribution
    samples = distribution.values if distribution.kind == CHOICE else (_like(field),)
    for value in samples:
        operation = _checked_as(field, value, fitting, is_mass=is_mass)
        checker.attributes(operation, {field.attr: value}, selector.tag, at=at)
        if faults:
            return faults[0]
    return None


def _checked_as(field: DrawField, value: Any, fitting: Sequence[Attribute], is_mass: bool) -> Operation:
    """Return the operation whose rules hold for a value that is drawn."""
    _, index = attribute_and_index(field.attr)
    if isinstance(value, list) and field.operation == "set" and index is None:
        return "set"
    if field.distribution.is_whole or field.operation != "set" or index is not None or is_mass:
        return field.operation
    if fitting and not any(attribute.is_number for attribute in fitting):
        return "set"
    return "offset"  # a number for each component of however many there are


def _like(field: DrawField) -> Any:
    distribution = field.distribution
    number: Any = 1 if distribution.kind == "integers" else 0.5
    if distribution.unit is not None:
        number = f"{number}{distribution.unit}"
    elif field.operation != "scale" and all(each == 0 for items in distribution.parameters.values() for each in items):
        number = 0
    return number if distribution.components is None else [number] * distribution.components


def _range_faults(field: DrawField, name: str, index: int | None, at: Path) -> Iterator[Fault]:
    """Yield the fault of a distribution with bounds that have no meaning. Draws of other distributions are checked one
    by one.
    """
    distribution = field.distribution
    for component in range(distribution.components or 1):
        lowest = min((each for each in distribution.extremes(component) if abs(each) != float("inf")), default=0.0)
        if lowest < 0 and must_not_be_negative(name, index if index is not None else component):
            what = "factors" if field.operation == "scale" else "values"
            message = f"`{field.attr}` cannot be negative, and {OWNER} draws {what} from {value_text(lowest)}"
            yield Fault("out-of-range", message, at, help="let it begin at 0 or above")
            return


_MAX_SEED = 2**64 - 1


def _seed_fault(value: int) -> Fault | None:
    return None if value <= _MAX_SEED else Fault("out-of-range", f"{IT} is {value}, and must be less than 2**64")


def _samples_fault(value: int) -> Fault | None:
    most = in_force().samples
    if value <= most:
        return None
    return Fault("limit-exceeded", f"{IT} is {value}; {most} are allowed", help=advice("samples", value))


class Randomize(Model):
    """Seeded draws of parameters, and of attributes of the finished model."""

    instead: ClassVar = {"emit": NO_EMIT}
    owned: ClassVar = ""

    seed: Annotated[
        int, Field(ge=0, json_schema_extra={"maximum": _MAX_SEED}), BeforeValidator(whole), Checked(_seed_fault)
    ] = Field(examples=["7"])
    """The seed of the draws: a whole number below 2**64."""
    samples: Annotated[int, Field(ge=1), BeforeValidator(whole), Checked(_samples_fault)] = Field(examples=["10"])
    """The number of samples, in addition to sample 0, the model without draws."""
    named: Annotated[
        dict[str, DrawField],
        Field(min_length=1),
        Expects("a mapping from names to what is drawn", f"{{friction: {DrawField.example}}}"),
    ] = Field(alias="fields")
    """The draws by name, each with a distribution and a target. The name is part of the seed."""

    @property
    def fields(self) -> tuple[DrawField, ...]:
        return tuple(self.named.values())

    @property
    def of_parameters(self) -> tuple[DrawField, ...]:
        return tuple(each for each in self.fields if each.param is not None)

    @property
    def of_measured(self) -> tuple[DrawField, ...]:
        return tuple(each for each in self.fields if each.source is not None)

"""The file of measurements of one robot, and the key `measured` of a recipe that uses it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, WithJsonSchema

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.joint_normal import impossible_row
from mjcompose.base.words import with_article
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import Checked, Expects, Items, Keys, Measure, Text, in_order
from mjcompose.language.value import attribute_and_index, must_not_be_negative
from mjcompose.text.expression import Angle

FORMAT = 1
"""The version of the file."""
DELAY = "delay"
ZERO = "zero"
COM = "com"
SHAPE = "shape"
COUNTS = {COM: 3, SHAPE: 6}
"""The numbers of a body that the verb `calibrate` takes together, and how many there are."""
FAMILIES = {ZERO: "joint", DELAY: "actuator", COM: "body", SHAPE: "body"}
"""The kinds of elements with numbers that are no attributes of MJCF."""
KINDS = ("joint", "actuator", "body", "geom", "tendon", "site", "equality", "pair")
"""The kinds of elements whose numbers a file can have."""
TOPICS = ("links", "inertia", "friction", "actuators", "options")
"""The topics that measured numbers depend on; the file has a hash of each."""

Number = Annotated[float | Angle, Measure()]
NotNegative = Annotated[float | Angle, Measure(ge=0)]
_Bounds = Annotated[tuple[Number, ...], Items(2, 2), Checked(in_order), Expects("a list of 2 numbers", "[LOW, HIGH]")]
ROUNDING = 0.005
"""How far a correlation in percent may be off, as a number: files have whole percent."""
_CODE = "measured-format"


class UseMeasured(Model):
    """A file of measurements, whose numbers the model gets after `edit`."""

    short: ClassVar = "file"
    example: ClassVar = "robots/A12.yaml"

    file: Text = Field(examples=["robots/A12.yaml"])
    """the file, relative to the recipe"""
    rename: Annotated[dict[str, Text], Expects("a mapping from names to names", '{"left/**": "arm/**"}')] = Field({})
    """names in the file, and the names in this recipe: `{"left/**": "arm/**"}` for all names of a part"""
    only: Annotated[dict[str, Text], Expects("a mapping from kinds to globs", '{joint: "arm/*"}')] = Field({})
    """the elements whose numbers count, by kind; by default all"""
    stale: Literal["refuse", "accept"] = "refuse"
    """`accept` uses numbers that were measured with another version of the recipe"""
    unknown: Literal["leave", "use"] = "leave"
    """`use` also applies numbers that the recordings did not determine"""

    def name_in_recipe(self, name: str) -> str:
        """Return the name in the recipe of an element of the file.

        >>> use = UseMeasured(file="a.yaml", rename={"left/**": "arm/**", "tip": "tool/tip"})
        >>> use.name_in_recipe("left/elbow"), use.name_in_recipe("tip"), use.name_in_recipe("other")
        ('arm/elbow', 'tool/tip', 'other')
        """
        old = self.renamed_by(name)
        if old is None:
            return name
        before, wildcard, behind = _around_wildcard(old)
        start, _, end = _around_wildcard(self.rename[old])
        middle = name[len(before) : len(name) - len(behind)] if wildcard else ""
        return f"{start}{middle}{end}"

    def renamed_by(self, name: str) -> str | None:
        """Return the key of `rename` that renames an element of the file; None if its name stays."""
        if name in self.rename:
            return name
        for old in self.rename:
            before, wildcard, behind = _around_wildcard(old)
            is_long = len(name) >= len(before + behind)
            if wildcard and is_long and name.startswith(before) and name.endswith(behind):
                return old
        return None

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        for old, new in self.rename.items():
            if ("*" in old) != ("*" in new):
                message = f"`{old}: {new}` in {IT} has a wildcard on one side only"
                help = 'write one on both sides, `"left/**": "arm/**"`, or on neither'
                yield Fault("wrong-type", message, ("rename", old), help=help)
        for kind in self.only:
            if kind not in KINDS:
                message = f"`{kind}` is not a kind of element with measured numbers"
                help = f"write one of {', '.join(KINDS)}"
                yield Fault("wrong-keyword", message, ("only", kind), key=True, help=help)


def _around_wildcard(name: str) -> tuple[str, str, str]:
    """Return the text before the first wildcard, `*` or an empty text, and the text behind it."""
    before, wildcard, behind = name.partition("*")
    return before, wildcard, behind.lstrip("*")


class MeasuredNumber(Model):
    """One number of an element, with its standard deviation."""

    example: ClassVar = "{value: 0.62, std: 0.03}"
    called: ClassVar = "the number `{}`"

    value: Number = Field(examples=[0.62])
    """the number, in MuJoCo's units: kg, m, s, N, rad"""
    std: NotNegative = 0.0
    """its standard deviation"""
    recipe: Number | None = None
    """the number that the recipe had"""
    range: _Bounds | None = None
    """the smallest and the largest number that are possible"""
    also: Annotated[tuple[Text, ...], Items(1), Expects("a list of names", "[arm/elbow]")] = ()
    """more elements with the same number"""
    not_identified: Text | None = None
    """why the recordings do not determine the number, which then is not applied"""
    one_sided: Text | None = None
    """the side to which other numbers explain the recordings as well"""
    at_its_bound: Text | None = None
    """the advice for a number at an end of its range"""
    beside_a_jump: Text | None = None
    """the reason for a wider interval: the errors jump near the number"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        if self.range is None:
            return
        value = in_si(self.value)
        low, high = map(in_si, self.range)
        if not low <= value <= high:
            message = f"`value` is {value:g}, outside of its range [{low:g}, {high:g}]"
            yield Fault("out-of-range", message, ("value",), help="correct the value or the range")


def in_si(number: float | Angle) -> float:
    """Return a number in MuJoCo's units; an angle in radians."""
    return number.in_unit("rad") if isinstance(number, Angle) else float(number)


def cannot_be_negative(attribute: str) -> bool:
    """Return whether a measured number has no meaning below 0.

    >>> cannot_be_negative("damping"), cannot_be_negative("damping[1]"), cannot_be_negative("delay")
    (True, False, True)
    """
    name, index = attribute_and_index(attribute)
    return attribute == DELAY or must_not_be_negative(name, index or 0)


def kind_and_name(owner: str) -> tuple[str, str]:
    """Return the kind and the name of an element of the file.

    >>> kind_and_name("joint arm/elbow")
    ('joint', 'arm/elbow')
    """
    kind, _, name = owner.partition(" ")
    return kind, name


def _owner_fault(owner: str, _: Settings) -> Fault | None:
    kind, name = kind_and_name(owner)
    if kind in KINDS and name:
        return None
    help = f"write the kind and the name: `joint arm/elbow`; kinds are {', '.join(KINDS)}"
    return Fault("unknown-key", f"`{owner}` names no element", (owner,), key=True, help=help)


def _version_fault(value: Any) -> Fault | None:
    if type(value) is int and value == FORMAT:
        return None
    message = f"the file has the format {value}; this version of mjcompose knows {FORMAT}"
    return Fault(_CODE, message, help=f"write `measured: {FORMAT}`, or install a newer mjcompose")


_Numbers = Annotated[dict[str, MeasuredNumber], Field(min_length=1), Expects("a mapping from attributes to numbers")]
_Row = Annotated[tuple[float, ...], Items(1)]
_Facts = Annotated[Any, WithJsonSchema({"type": "object"})]


class MeasurementFile(Model):
    """A file of measurements: the numbers of one robot, from a recording or by hand."""

    owned: ClassVar = "a file of measurements"

    measured: Annotated[int, Checked(_version_fault, first=True)]
    """the version of the file: 1"""
    name: Text | None = None
    """the robot: its serial number"""
    date: Any = None
    """when it was measured"""
    recipe: dict[str, Any] = Field({})
    """the recipe, and a hash of each topic that the numbers depend on"""
    mujoco: Any = None
    """the version of MuJoCo"""
    recordings: _Facts = ()
    """the recordings, with their hashes"""
    errors: _Facts = Field({})
    """the root mean square error of each signal, before and after"""
    values: Annotated[dict[str, _Numbers], Keys(_owner_fault), Field(min_length=1)] = Field(
        examples=["{joint elbow: {damping: {value: 0.62, std: 0.03}}}"]
    )
    """the numbers, by element and attribute"""
    correlation: Annotated[tuple[_Row, ...], Items()] = ()
    """the correlations in percent, a row for each number but the first, in the order of `values`"""

    @classmethod
    def subject(cls, at: Path) -> str:
        return super().subject(at) if at else "the file of measurements"

    @property
    def numbers(self) -> Iterator[tuple[str, str, str, MeasuredNumber]]:
        """Yield the kind and the name of each element, and its attribute and number, in the order of the file."""
        for owner, numbers in self.values.items():
            kind, name = kind_and_name(owner)
            for attribute, number in numbers.items():
                yield kind, name, attribute, number

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        for kind, name, attribute, number in self.numbers:
            if in_si(number.value) < 0 and cannot_be_negative(attribute):
                message = f"`{attribute}` of {kind} `{name}` cannot be negative, and is {in_si(number.value):g}"
                yield Fault("out-of-range", message, ("values", f"{kind} {name}", attribute, "value"))
            base, _, index = attribute.partition("[")
            wanted = FAMILIES.get(base, kind)
            if kind == wanted and base in COUNTS and index not in [f"{each}]" for each in range(COUNTS[base])]:
                message = f"`{attribute}` is none of the numbers `{base}[0]` to `{base}[{COUNTS[base] - 1}]`"
                yield Fault("unknown-attribute", message, ("values", f"{kind} {name}", attribute), key=True)
            if kind != wanted:
                at = ("values", f"{kind} {name}", attribute)
                message = f"{with_article(kind)} has no `{attribute}`; {with_article(wanted)} has one"
                yield Fault("unknown-attribute", message, at, key=True, help=f"write it for the {wanted}")
        yield from self._correlation_faults()

    @property
    def correlations(self) -> list[list[float]]:
        """The rows below the diagonal, as numbers from -1 to 1, in the order of the numbers."""
        if self.correlation:
            return [[percent / 100 for percent in row] for row in self.correlation]
        return [[0.0] * size for size in range(1, sum(len(numbers) for numbers in self.values.values()))]

    def _correlation_faults(self) -> Iterator[Fault]:
        if not self.correlation:
            return
        at = ("correlation",)
        size = sum(len(numbers) for numbers in self.values.values())
        lengths = [len(row) for row in self.correlation]
        if lengths != list(range(1, size)):
            message = f"`correlation` does not have a row below the diagonal for each of {size} numbers"
            help = "leave it out for independent numbers"
            if lengths == [size] * size:
                help = "write only the numbers below the diagonal: the others are the same, or 100"
            yield Fault(_CODE, message, at, key=True, help=help)
            return
        for row, percents in enumerate(self.correlation):
            for column, percent in enumerate(percents):
                if not abs(percent) <= 100:
                    message = f"a correlation is between -100 and 100 percent, and this is {percent:g}"
                    yield Fault("out-of-range", message, (*at, row, column))
                    return
        wrong = impossible_row(self.correlations, ROUNDING)
        if wrong is not None:
            words = [f"{kind} {name} {attribute}" for kind, name, attribute, _ in self.numbers]
            message = f"no numbers have these correlations: those of `{words[wrong + 1]}` contradict the rows above"
            help = "fit the recordings again, or leave `correlation` out for independent numbers"
            yield Fault(_CODE, message, (*at, wrong), help=help)


class MeasuredValue(Struct):
    """A number of a file as a recipe uses it: `names` are the names in the recipe."""

    kind: str
    names: tuple[str, ...]
    attribute: str
    number: MeasuredNumber
    path: tuple[str, ...]
    """its path in the file"""
    is_applied: bool

    @property
    def word(self) -> str:
        """Its name in messages and draws: `joint arm/elbow damping`."""
        return f"{self.kind} {self.names[0]} {self.attribute}"


def values_of(file: MeasurementFile, use: UseMeasured) -> Iterator[MeasuredValue]:
    """Yield the numbers of a file by the names in the recipe."""
    for kind, name, attribute, number in file.numbers:
        names = tuple(use.name_in_recipe(each) for each in (name, *number.also))
        yield MeasuredValue(
            kind,
            names,
            attribute,
            number=number,
            path=("values", f"{kind} {name}", attribute),
            is_applied=use.unknown == "use" or number.not_identified is None,
        )

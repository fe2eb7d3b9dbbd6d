"""Distributions as a recipe writes them: `uniform: [0.4, 1.2]`, `normal: {std: 0.01}`, `choice: [a, b]`."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import field
from functools import lru_cache
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, WithJsonSchema, create_model

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.base.distribution import CHOICE, MAKERS, Distribution, Integers, LogUniform, TruncNormal, Uniform
from mjcompose.base.draw_stream import below, bits
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.words import value_text
from mjcompose.language.forms.context import Rows
from mjcompose.language.forms.model import IT, OWNER, WHOLE, Model, OneOf
from mjcompose.language.forms.scalars import Checked, Expects, Items, Measure, NotNegative, Positive, Whole
from mjcompose.language.value import kind_of
from mjcompose.text.expression import Angle, Unit

Operation = Literal["set", "scale", "offset"]
_INTERVALS = ("uniform", "loguniform", "integers")
_LARGEST = 2**53
_MANY = 64  # from this number of draws on it pays to import numpy


class FieldDistribution(Struct):
    """A distribution for each component of a value.

    `parameters` have one number for all components, or one for each. Angles are in `unit`, if the recipe writes
    one. A `choice` has `values` instead.
    """

    kind: str
    parameters: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    values: tuple[Any, ...] = ()
    unit: Literal["deg", "rad"] | None = None

    @property
    def components(self) -> int | None:
        """Return how many components the value must have, or None for any number."""
        return next((len(each) for each in self.parameters.values() if len(each) > 1), None)

    @property
    def is_whole(self) -> bool:
        """Return whether one draw is a whole value with all its numbers."""
        return self.kind == CHOICE and not all(_is_number(each) or isinstance(each, Angle) for each in self.values)

    def of(self, component: int) -> Distribution:
        """Return the distribution of the number of one component. A choice has none."""
        numbers = tuple(each[component if len(each) > 1 else 0] for each in self.parameters.values())
        return _distribution(self.kind, numbers)

    def draw(self, bits: int, component: int) -> Any:
        if self.kind == CHOICE:
            return self.values[below(bits, len(self.values))]
        return self.of(component).draw(bits)

    def draw_all(
        self, seed: int, samples: Sequence[int], stream: str, element: str, component: int, of: int
    ) -> Sequence[Any]:
        """Return `draw` for each of the samples, with the random bits of `component` and the parameters of `of`."""
        if len(samples) < _MANY:
            return [self.draw(bits(seed, each, stream, element=element, component=component), of) for each in samples]
        from mjcompose.base import array_math as many  # numpy

        found = many.bits(seed, samples, stream, element=element, component=component)
        if self.kind == CHOICE:
            return [self.values[each] for each in many.below(found, len(self.values)).tolist()]
        return array("q" if self.kind == "integers" else "d", self.of(of).draw_all(found).tobytes())

    def extremes(self, component: int) -> tuple[float, ...]:
        """Return the smallest and the largest number that can be drawn, or all values of a choice."""
        if self.kind == CHOICE:
            return tuple(float(each) for each in self.values if _is_number(each))
        return self.of(component).support

    def __str__(self) -> str:
        unit = self.unit or ""

        def written(numbers: tuple[float, ...]) -> str:
            texts = [f"{value_text(each)}{unit if each else ''}" for each in numbers]
            return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"

        if self.kind == CHOICE:
            return f"{CHOICE} of {', '.join(value_text(each) for each in self.values)}"
        if self.kind in _INTERVALS:
            return f"{self.kind} {' to '.join(map(written, self.parameters.values()))}"
        return f"{self.kind} {', '.join(f'{name} {written(each)}' for name, each in self.parameters.items())}"


@lru_cache(maxsize=256)
def _distribution(kind: str, numbers: tuple[float, ...]) -> Distribution:
    """Return the distribution. It is cached, because some distributions compute numbers that all their draws need."""
    return MAKERS[kind](*numbers)


Numbers = Annotated[tuple[Annotated[float | Angle, Measure()], ...], Items(1, single=True)]
Spread = Annotated[tuple[Annotated[float | Angle, Measure(ge=0)], ...], Items(1, single=True)]
PositiveSpread = Annotated[tuple[Annotated[float | Angle, Measure(gt=0)], ...], Items(1, single=True)]
PositiveNumbers = Annotated[tuple[Positive, ...], Items(1, single=True)]
Plain = Annotated[tuple[float, ...], Items(1, single=True)]
PlainSpread = Annotated[tuple[NotNegative, ...], Items(1, single=True)]
WholeNumbers = Annotated[tuple[Annotated[Whole, Field(gt=-_LARGEST, lt=_LARGEST)], ...], Items(1, single=True)]


def _bounds(example: str) -> tuple[Items, Expects]:
    return Items(2, 2), Expects("a list of two bounds", example)


class WrittenDistribution(Model):
    """A distribution as it is written, with one number for all components of a value, or a list."""

    @classmethod
    def subject(cls, at: Path) -> str:
        return f"`{at[-1]}` of {cls.field(at)}"

    @staticmethod
    def field(at: Path) -> str:
        return f"field `{at[-3] if at[-2] in ('scale', 'offset') else at[-2]}`"

    def numbers(self) -> dict[str, tuple[Any, ...] | None]:
        return {name: getattr(self, name) for name in type(self).model_fields}


class _Whole(WrittenDistribution):
    """A distribution that is written as a list."""

    @classmethod
    def owner(cls, at: Path) -> str:
        return cls.field(at)


class Interval(_Whole):
    """A distribution between two bounds."""

    bounds: Any = Field(alias=WHOLE)
    """the two"""

    def numbers(self) -> dict[str, tuple[Any, ...] | None]:
        low, high = self.bounds
        return {"min": low, "max": high}


class UniformBounds(Interval):
    """Uniform between two bounds: `[0.4, 1.2]`."""

    bounds: Annotated[tuple[Numbers, ...], *_bounds("[0.8, 1.2]")] = Field(alias=WHOLE)


class LogUniformBounds(Interval):
    """Between two positive bounds, with a uniform logarithm: `[0.1, 10]`."""

    bounds: Annotated[tuple[PositiveNumbers, ...], *_bounds("[0.1, 10]")] = Field(alias=WHOLE)


class IntegerBounds(Interval):
    """Whole numbers from the first to the last: `[1, 6]`."""

    bounds: Annotated[tuple[WholeNumbers, ...], *_bounds("[1, 6]")] = Field(alias=WHOLE)


_MEAN = Field(None, description="the middle; by default the value that changes nothing")


class BellOfChange(WrittenDistribution):
    """Numbers from a normal distribution around `mean`, with the standard deviation `std`."""

    instead: ClassVar = {"mu": "mean", **dict.fromkeys(("sigma", "stddev", "sd"), "std"), "low": "min", "high": "max"}
    example: ClassVar = "{mean: 1, std: 0.1}"

    mean: Numbers | None = _MEAN
    std: Spread = Field(examples=["0.1"])
    """the standard deviation"""


class TruncatedOfChange(WrittenDistribution):
    """The part of a normal distribution that is between `min` and `max`."""

    instead: ClassVar = BellOfChange.instead
    example: ClassVar = "{mean: 1, std: 0.1, min: 0.5, max: 1.5}"

    mean: Numbers | None = _MEAN
    std: PositiveSpread = Field(examples=["0.1"])
    """the standard deviation"""
    min: Numbers = Field(examples=["0.5"])
    """the lower bound"""
    max: Numbers = Field(examples=["1.5"])
    """the upper bound"""


class LogarithmsOfChange(WrittenDistribution):
    """Numbers whose logarithm is normal, with this mean and standard deviation."""

    instead: ClassVar = BellOfChange.instead
    example: ClassVar = "{mean: 0, std: 0.1}"

    mean: Plain | None = _MEAN
    std: PlainSpread = Field(examples=["0.1"])
    """the standard deviation of the logarithm"""


def _of_value(
    form: type[WrittenDistribution], name: str, mean: Any, about: str = "the middle"
) -> type[WrittenDistribution]:
    """Return the form of a value with the distribution: its mean must be written."""
    required = Field(examples=["0" if mean is Plain else "1"], description=about)
    return create_model(name, __base__=form, __doc__=form.__doc__, __module__=__name__, mean=(mean, required))


def _no_value(value: Any) -> Fault | None:
    is_value = not isinstance(value, dict) and value is not None
    return None if is_value else Fault("wrong-type", f"{IT} is among values, got {kind_of(value)}")


_Value = Annotated[Any, Checked(_no_value), WithJsonSchema({"type": ["number", "boolean", "string", "array"]})]


class Choice(_Whole):
    """One of these values, each equally likely: `[1, 2, 5]`."""

    values: Annotated[tuple[_Value, ...], Items(1), Expects("a list of values", "[1, 2, 5]")] = Field(alias=WHOLE)
    """the values"""


_OF_VALUES: dict[str, type[WrittenDistribution]] = {
    "uniform": UniformBounds,
    "loguniform": LogUniformBounds,
    "normal": _of_value(BellOfChange, "Bell", Numbers),
    "truncnormal": _of_value(TruncatedOfChange, "Truncated", Numbers),
    "lognormal": _of_value(LogarithmsOfChange, "Logarithms", Plain, about="the mean of the logarithm"),
    CHOICE: Choice,
    "integers": IntegerBounds,
}
DISTRIBUTIONS: ExtensionTable[type[WrittenDistribution]] = ExtensionTable("distributions", _OF_VALUES, "")
_OF_CHANGES: dict[str, type[WrittenDistribution]] = {
    "normal": BellOfChange,
    "truncnormal": TruncatedOfChange,
    "lognormal": LogarithmsOfChange,
}
CHANGES: ExtensionTable[type[WrittenDistribution]] = ExtensionTable(
    "distributions", {**DISTRIBUTIONS, **_OF_CHANGES}, ""
)
KINDS = DISTRIBUTIONS.own


class DrawnChange(Model):
    """A distribution of factors, or of offsets."""

    rules: ClassVar = (
        OneOf(*KINDS, lacks="has no distribution", advice="write `{uniform: [0.8, 1.2]}`", noun="distribution"),
    )
    example: ClassVar = "{uniform: [0.8, 1.2]}"
    noun: ClassVar = "distribution"

    written: Annotated[Mapping[str, WrittenDistribution], Rows(lambda: CHANGES)] = Field({}, alias="<kinds>")
    """the distribution"""

    @classmethod
    def subject(cls, at: Path) -> str:
        return f"`{at[-1]}` of field `{at[-2]}`"

    @classmethod
    def owner(cls, at: Path) -> str:
        return f"field `{at[-2]}`"


def read(kind: str, written: WrittenDistribution, operation: Operation) -> FieldDistribution | Fault:
    """Return the written distribution, or the fault of the combination of its numbers."""
    if isinstance(written, Choice):
        return FieldDistribution(CHOICE, values=written.values)
    called = f"`{kind}` of {OWNER}"
    neutral = 1.0 if operation == "scale" and kind != "lognormal" else 0.0
    numbers = {name: (neutral,) if items is None else items for name, items in written.numbers().items()}
    angles = [number for items in numbers.values() for number in items if isinstance(number, Angle)]
    fault = _fault_of_angles(called, numbers, angles, operation)
    if fault is not None:
        return fault
    unit = _common_unit(angles)
    parameters = {name: _in_unit(items, kind, unit) for name, items in numbers.items()}
    lengths = {len(items) for items in parameters.values()} - {1}
    if len(lengths) > 1:
        counts = " and ".join(map(str, sorted(lengths)))
        return Fault("wrong-length", f"{called} has lists of {counts} numbers")
    distribution = FieldDistribution(kind, parameters, unit=unit)
    for component in range(distribution.components or 1):
        wrong = _fault_of(distribution.of(component))
        if wrong is not None:
            return Fault("out-of-range", f"{called}: {wrong}")
    return distribution


def _fault_of_angles(
    called: str, numbers: Mapping[str, Sequence[Any]], angles: Sequence[Angle], operation: Operation
) -> Fault | None:
    """Return the fault of a factor with a unit, or of a number without a unit among angles."""
    if not angles:
        return None
    if operation == "scale":
        return Fault("wrong-type", f"{called} is of factors, which have no unit")
    for number in (number for items in numbers.values() for number in items):
        if not isinstance(number, Angle) and number != 0:
            message = f"{called} has numbers with a unit and {value_text(number)} without one"
            return Fault("bare-angle", message, help=f"write `{value_text(number)}{angles[0].unit}`")
    return None


def _common_unit(angles: Sequence[Angle]) -> Unit | None:
    """Return the unit of all the angles, radians if they have several, or None if there are no angles."""
    units = {angle.unit for angle in angles}
    if len(units) > 1:
        return "rad"
    return next(iter(units), None)


def _in_unit(items: Sequence[Any], kind: str, unit: Unit | None) -> tuple[float, ...]:
    """Return plain numbers, which are whole for `integers`."""
    plain = (item.in_unit(unit or "rad") if isinstance(item, Angle) else item for item in items)
    return tuple(map(int if kind == "integers" else float, plain))


def _fault_of(distribution: Distribution) -> str | None:
    if isinstance(distribution, Uniform | LogUniform | Integers | TruncNormal) and distribution.low > distribution.high:
        return f"the first bound, {value_text(distribution.low)}, is above the second, {value_text(distribution.high)}"
    if isinstance(distribution, TruncNormal) and distribution.is_empty:
        return "between `min` and `max` it has almost no probability"
    return None


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

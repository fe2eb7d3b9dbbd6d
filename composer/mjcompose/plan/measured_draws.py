"""The fields of `randomize` with `from: measured`: one joint draw of all numbers of a file of measurements."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import field
from typing import Any, Literal

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Path, Span
from mjcompose.base.joint_normal import JointNormal, factor_of
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean
from mjcompose.base.words import value_text
from mjcompose.language.distribution import FieldDistribution, Operation
from mjcompose.language.measured import FAMILIES, ROUNDING, MeasuredValue, cannot_be_negative, in_si
from mjcompose.language.randomize import FROM, DrawField, Randomize
from mjcompose.language.value import attribute_and_index
from mjcompose.plan.measured import Measurements, NumberPlace, condition_of, word_for_set
from mjcompose.plan.plan import Drawn
from mjcompose.text.expression import Angle
from mjcompose.text.node import Mapping, locate
from mjcompose.tree.pattern import Selector, fitter, is_pattern

_KIND = "measured"


class MeasuredDraws(Struct):
    """The draws of measured numbers of a recipe. `fields` has the field that draws each number of the joint draw."""

    randomize: Randomize
    measurements: Measurements
    joint: JointNormal
    values: tuple[MeasuredValue, ...]
    fields: tuple[DrawField | None, ...]
    separator: str
    known: dict[int, tuple[float, ...]] = field(default_factory=dict)

    def numbers(self, sample: int) -> tuple[float, ...] | None:
        """Return all numbers of the joint draw of a sample; None if no draw is within the ranges."""
        numbers = self.known.get(sample)
        if numbers is None:
            numbers = self.joint.draw(self.randomize.seed, sample)
            if numbers is not None:
                self.known[sample] = numbers
        return numbers

    def check(self, samples: Sequence[int], document: Mapping, sink: Sink) -> bool:
        """Report the first sample without a draw. Return whether there is none."""
        failed = next((sample for sample in samples if self.numbers(sample) is None), None)
        if failed is None:
            return True
        name = next(drawing.name for drawing in self.fields if drawing is not None)
        message = f"no draw of sample {failed} is within the ranges of `{self.measurements.shown}`"
        help = "many numbers are at a bound: widen their ranges and fit again, or lower `widen`"
        sink.error("out-of-range", message, locate(document, ("randomize", "fields", name, FROM)), help=help)
        return False

    @property
    def drawn(self) -> Iterator[tuple[int, MeasuredValue, DrawField, tuple[str, ...]]]:
        """Yield the place in the joint draw of each drawn number, the number, its field, and its elements."""
        for place, (value, drawing) in enumerate(zip(self.values, self.fields, strict=True)):
            if drawing is not None:
                yield place, value, drawing, _selected(drawing, self.measurements, value, self.separator)

    def replaced(self, sample: int) -> dict[NumberPlace, float]:
        """Return the drawn numbers of a sample by their places in the file, and the names of their elements."""
        numbers = self.numbers(sample)
        assert numbers is not None
        return {(value.path, name): numbers[place] for place, value, _, names in self.drawn for name in names}

    def records(self, sample: int) -> Iterator[Drawn]:
        """Yield the draws of a sample for the manifest, in the order of the file."""
        numbers = self.numbers(sample)
        assert numbers is not None
        for place, value, drawing, names in self._in_file_order():
            name, index = attribute_and_index(value.attribute)
            yield Drawn(
                drawing.name,
                names[0],
                name,
                operation="set",
                value=numbers[place],
                start=index or 0,
                column=_column(drawing, value),
            )

    def _in_file_order(self) -> list[tuple[int, MeasuredValue, DrawField, tuple[str, ...]]]:
        order = {value.path: index for index, value in enumerate(self.measurements.values)}
        return sorted(self.drawn, key=lambda row: order[row[1].path])

    def edit_words(self, sample: int) -> dict[Span, str]:
        """Return words about the draw of each number, by the place of the number in the file."""
        words = {}
        for _, value, drawing, _ in self.drawn:
            mean = value_text(value.number.value)
            words[self.measurements.span_of(value, key=True)] = (
                f"drawn by {drawing.name} for sample {sample}, not {mean}"
            )
        return words

    @property
    def lines(self) -> Iterator[tuple[DrawField, str]]:
        """Yield a line about each number that a field draws, as `plan` prints it."""
        for place, value, drawing, _ in self._in_file_order():
            yield drawing, f"{value.word} = {self._distribution(place, value)}"

    def _distribution(self, place: int, value: MeasuredValue) -> MeasuredDistribution:
        is_angle = isinstance(value.number.value, Angle)
        parameters = {"mean": (self.joint.means[place],), "std": (self.joint.stds[place],)}
        return MeasuredDistribution(_KIND, parameters, (), "rad" if is_angle else None, self, place)

    def for_worlds(self, document: Mapping, sink: Sink) -> Iterator[DrawnNumber]:
        """Yield a field for each element with a drawn number; report numbers that a compiled model does not have."""
        for place, value, drawing, names in self._in_file_order():
            if value.attribute.partition("[")[0] in FAMILIES:
                span = locate(document, ("randomize", "fields", drawing.name, FROM))
                message = f"field `{drawing.name}` draws the {value.attribute} of {value.kind} `{names[0]}`"
                message = f"{message}, which a compiled model cannot change"
                help = "build without `--as worlds`: `--worlds FILE` makes worlds of any samples"
                sink.error("draw-at-run-time", message, span, help=help, subjects=(drawing.name,))
                continue
            for name in names:
                yield DrawnNumber(
                    drawing.name,
                    _selector(value.kind, name),
                    word_for_set(value),
                    self._distribution(place, value),
                    column=_column(drawing, value),
                    at=drawing.at,
                )


class MeasuredDistribution(FieldDistribution):
    """The distribution of one number of a joint draw."""

    draws: MeasuredDraws | None = None
    place: int = 0

    def draw_all(
        self, seed: int, samples: Sequence[int], stream: str, element: str, component: int, of: int
    ) -> Sequence[Any]:
        assert self.draws is not None
        rows = [self.draws.numbers(sample) for sample in samples]
        return [row[self.place] for row in rows if row is not None]

    def extremes(self, component: int) -> tuple[float, ...]:
        assert self.draws is not None
        return self.draws.joint.bounds[self.place]

    def __str__(self) -> str:
        unit = self.unit or ""
        mean, std = (f"{self.parameters[name][0]:.5g}{unit}" for name in ("mean", "std"))
        low, high = self.extremes(0)
        ends = [f"{word} {end:.5g}{unit}" for word, end in (("from", low), ("to", high)) if math.isfinite(end)]
        return " ".join([f"{mean} ± {std}", *ends])


class DrawnNumber(Struct):
    """A measured number of one element, in the form of a field of `randomize`, for a table of draws."""

    name: str
    select: Selector
    attr: str
    distribution: MeasuredDistribution
    column: str
    at: Path
    operation: Operation = "set"
    per: Literal["element", "body", "part", "sample"] = "element"
    group: str | None = None
    expect: int | None = None
    optional: bool = False
    param: str | None = None

    @property
    def stream(self) -> str:
        return self.name

    @property
    def drawn_at(self) -> Path:
        return (*self.at, FROM)

    @property
    def words(self) -> str:
        return f"draw {self.name}: {self.attr} of {self.select} = {self.distribution}, with the other measured numbers"


def _column(drawing: DrawField, value: MeasuredValue) -> str:
    return f"{drawing.name}[{value.word}]"


def _selector(kind: str, name: str) -> Selector:
    if is_pattern(name):
        return Selector(kind, "**", where=condition_of(name))
    return Selector(kind, name)


def _selected(drawing: DrawField, measurements: Measurements, value: MeasuredValue, separator: str) -> tuple[str, ...]:
    """Return the elements of a number that a field draws, by their names in the recipe."""
    names = measurements.selected_names(value)
    selector = drawing.select
    if selector is None:
        return names
    if selector.tag != value.kind:
        return ()
    fits = fitter(selector.pattern, lambda: names, separator)
    return tuple(name for name in names if fits(name))


def measured_draws(
    randomize: Randomize, measurements: Measurements, document: Mapping, separator: str, sink: Sink
) -> MeasuredDraws | None:
    """Return the draws of a recipe, whose last field counts for a number; None after reported errors."""
    order = sorted(range(len(measurements.values)), key=lambda index: _identity(measurements.values[index]))
    values = tuple(measurements.values[index] for index in order)
    fields = tuple(_field_of(value, randomize, measurements, separator) for value in values)
    before = sink.error_count
    for drawing in randomize.of_measured:
        _check_field(drawing, measurements, document, separator, sink)
    if sink.error_count > before:
        return None
    widths = [1.0 if drawing is None else drawing.widen for drawing in fields]
    joint = JointNormal(
        tuple(map(_identity, values)),
        tuple(in_si(value.number.value) for value in values),
        tuple(in_si(value.number.std) * width for value, width in zip(values, widths, strict=True)),
        tuple(map(_bounds, values)),
        factor_of(_sorted_correlations(measurements.file.correlations, order), ROUNDING),
    )
    return MeasuredDraws(randomize, measurements, joint, values, fields, separator)


def _identity(value: MeasuredValue) -> str:
    """Return the identity on which a draw depends: the name in the file, which is the same in each recipe."""
    return " ".join(value.path[1:])


def _field_of(
    value: MeasuredValue, randomize: Randomize, measurements: Measurements, separator: str
) -> DrawField | None:
    drawing = [each for each in randomize.of_measured if _selected(each, measurements, value, separator)]
    return drawing[-1] if drawing else None


def _check_field(drawing: DrawField, measurements: Measurements, document: Mapping, separator: str, sink: Sink) -> None:
    """Report a field that selects no number, or only numbers without a standard deviation."""
    selected = [value for value in measurements.values if _selected(drawing, measurements, value, separator)]
    at = ("randomize", "fields", drawing.name)
    if not selected and not drawing.optional:
        selector = drawing.select
        what = "no number" if selector is None else f"no number of `{selector.tag}: {selector.pattern}`"
        message = f"field `{drawing.name}` draws {what} of `{measurements.shown}`"
        kind = "" if selector is None else selector.tag
        names = [name for value in measurements.values if value.kind == kind for name in value.names]
        meant = None if selector is None else did_you_mean(selector.pattern, names)
        help = meant or "it selects by the names in this recipe, which `rename` gave"
        sink.error("selector", message, locate(document, (*at, "select")), help=help)
    elif selected and not any(in_si(value.number.std) for value in selected):
        message = f"field `{drawing.name}` draws numbers of `{measurements.shown}` without `std`, so they never change"
        help = "write the standard deviation of each: `{value: 0.62, std: 0.03}`"
        sink.error("missing-key", message, locate(document, (*at, FROM)), help=help)


def _bounds(value: MeasuredValue) -> tuple[float, float]:
    """Return the range of a number; numbers that MuJoCo does not take below 0 begin there."""
    number = value.number
    low, high = (-math.inf, math.inf) if number.range is None else map(in_si, number.range)
    if cannot_be_negative(value.attribute):
        low = max(low, 0.0)
    return low, high


def _sorted_correlations(rows: list[list[float]], order: Sequence[int]) -> list[list[float]]:
    """Return the rows below the diagonal for numbers in another order."""
    return [
        [rows[max(first, second) - 1][min(first, second)] for second in order[:place]]
        for place, first in enumerate(order)
        if place
    ]

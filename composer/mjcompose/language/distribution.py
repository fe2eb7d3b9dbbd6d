"""Distributions as a recipe writes them: `uniform: [0.4, 1.2]`, `normal: {std: 0.01}`, `choice: [a, b]`."""

from __future__ import annotations

import sys
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from functools import lru_cache
from typing import Any, Literal

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Fix, Path
from mjcompose.base.distribution import (
    Distribution,
    Integers,
    LogNormal,
    LogUniform,
    Normal,
    TruncNormal,
    Uniform,
)
from mjcompose.base.draw_stream import below, bits
from mjcompose.base.suggest import closest, exists_note
from mjcompose.language.form import kind_of, shown
from mjcompose.text.expression_values import Angle

Operation = Literal["set", "scale", "offset"]
CHOICE = "choice"
INTERVALS: Mapping[str, type[Uniform | LogUniform | Integers]] = {
    "uniform": Uniform,
    "loguniform": LogUniform,
    "integers": Integers,
}
"""Distributions between two bounds: a list of the two."""
BELLS: Mapping[str, tuple[Callable[..., Distribution], tuple[str, ...]]] = {
    "normal": (Normal, ("mean", "std")),
    "truncnormal": (TruncNormal, ("mean", "std", "min", "max")),
    "lognormal": (LogNormal, ("mean", "std")),
}
"""Distributions with a mean: a mapping with these keys."""
KINDS = ("uniform", "loguniform", "normal", "truncnormal", "lognormal", CHOICE, "integers")
EXAMPLES = {
    "uniform": "[0.8, 1.2]",
    "loguniform": "[0.1, 10]",
    "normal": "{mean: 1, std: 0.1}",
    "truncnormal": "{mean: 1, std: 0.1, min: 0.5, max: 1.5}",
    "lognormal": "{mean: 0, std: 0.1}",
    CHOICE: "[1, 2, 5]",
    "integers": "[1, 6]",
}
_LARGEST = 2**53
_MANY = 64  # from so many draws on it pays to import numpy


@dataclass(frozen=True, slots=True)
class FieldDistribution:
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
        return self.kind == CHOICE and not all(
            _is_number(each) or isinstance(each, Angle) for each in self.values
        )

    def of(self, component: int) -> Distribution:
        """Return the distribution of the number of one component. A choice has none."""
        numbers = tuple(each[component if len(each) > 1 else 0] for each in self.parameters.values())
        return _distribution(self.kind, numbers)

    def draw(self, bits: int, component: int) -> Any:
        """Return one number, or the chosen value."""
        if self.kind == CHOICE:
            return self.values[below(bits, len(self.values))]
        return self.of(component).draw(bits)

    def draw_all(
        self, seed: int, samples: Sequence[int], stream: str, element: str, component: int, of: int
    ) -> Sequence[Any]:
        """Return what `draw` returns for each of the samples.

        The random bits are those of `component`, and the parameters those of `of`.
        """
        if len(samples) < _MANY:
            return [
                self.draw(bits(seed, each, stream, element=element, component=component), of)
                for each in samples
            ]
        from mjcompose.base import array_math as many  # numpy

        found = many.bits(seed, samples, stream, element=element, component=component)
        if self.kind == CHOICE:
            return [self.values[each] for each in many.below(found, len(self.values)).tolist()]
        numbers = self.of(of).draw_all(found)
        return array("q" if self.kind == "integers" else "d", numbers.tobytes())

    def extremes(self, component: int) -> tuple[float, ...]:
        """Return the least and the greatest number that can be drawn, or all values of a choice."""
        if self.kind == CHOICE:
            return tuple(float(each) for each in self.values if _is_number(each))
        return self.of(component).support

    def __str__(self) -> str:
        unit = self.unit or ""

        def written(numbers: tuple[float, ...]) -> str:
            texts = [f"{shown(each)}{unit if each else ''}" for each in numbers]
            return texts[0] if len(texts) == 1 else f"[{', '.join(texts)}]"

        if self.kind == CHOICE:
            return f"{CHOICE} of {', '.join(shown(each) for each in self.values)}"
        if self.kind in INTERVALS:
            return f"{self.kind} {' to '.join(map(written, self.parameters.values()))}"
        return f"{self.kind} {', '.join(f'{name} {written(each)}' for name, each in self.parameters.items())}"


@lru_cache(maxsize=256)
def _distribution(kind: str, numbers: tuple[float, ...]) -> Distribution:
    """Return the distribution. It is cached, because some compute what all their draws need."""
    if kind in INTERVALS:
        return INTERVALS[kind](*numbers)  # type: ignore[arg-type]  # those of Integers are whole
    return BELLS[kind][0](*numbers)


@dataclass(slots=True)
class DistributionReader:
    """Reads one distribution and adds to the faults. `owner` is the subject of messages."""

    owner: str
    operation: Operation
    faults: list[Fault]

    def read(self, kind: str, value: Any, at: Path) -> FieldDistribution | None:
        """Return the distribution that is written behind `kind`, or None after a reported fault."""
        before = len(self.faults)
        if kind == CHOICE:
            return self._choice(value, at)
        written = self._bounds(kind, value, at) if kind in INTERVALS else self._named(kind, value, at)
        numbers = {name: self._numbers(each, kind, path) for name, each, path in written}
        if len(self.faults) > before:
            return None
        angles = [each for items in numbers.values() for each in items if isinstance(each, Angle)]
        unit = self._unit(numbers, angles, kind, at=at)
        if len(self.faults) > before:
            return None
        plain = {name: tuple(_in(each, unit) for each in items) for name, items in numbers.items()}
        if kind == "integers":
            plain = {name: tuple(int(each) for each in items) for name, items in plain.items()}
        distribution = FieldDistribution(kind, plain, unit=unit)
        self._check(distribution, at)
        return distribution if len(self.faults) == before else None

    def _fault(self, code: str, message: str, at: Path, **more: Any) -> None:
        self.faults.append(Fault(code, message, at, **more))

    def _choice(self, value: Any, at: Path) -> FieldDistribution | None:
        if not isinstance(value, list) or not value:
            got = "an empty list" if value == [] else kind_of(value)
            self._fault("wrong-type", f"`{CHOICE}` of {self.owner} is a list of values, got {got}", at,
                        help=f"write for instance `{CHOICE}: {EXAMPLES[CHOICE]}`")  # fmt: skip
            return None
        wrong = [place for place, each in enumerate(value) if isinstance(each, dict) or each is None]
        for place in wrong:
            message = f"`{CHOICE}` of {self.owner} is among values, got {kind_of(value[place])}"
            self._fault("wrong-type", message, (*at, place))
        return None if wrong else FieldDistribution(CHOICE, values=tuple(value))

    def _bounds(self, kind: str, value: Any, at: Path) -> list[tuple[str, Any, Path]]:
        if isinstance(value, list) and len(value) == 2:
            return [("min", value[0], (*at, 0)), ("max", value[1], (*at, 1))]
        code = "wrong-length" if isinstance(value, list) else "wrong-type"
        got = f"a list of {len(value)}" if isinstance(value, list) else kind_of(value)
        self._fault(code, f"`{kind}` of {self.owner} is a list of two bounds, got {got}", at,
                    help=f"write for instance `{kind}: {EXAMPLES[kind]}`")  # fmt: skip
        return []

    def _named(self, kind: str, value: Any, at: Path) -> list[tuple[str, Any, Path]]:
        keys = BELLS[kind][1]
        example = f"write for instance `{kind}: {EXAMPLES[kind]}`"
        if not isinstance(value, dict):
            known = ", ".join(f"`{key}`" for key in keys)
            message = f"`{kind}` of {self.owner} is a mapping with {known}, got {kind_of(value)}"
            self._fault("wrong-type", message, at, help=example)
            return []
        meant: set[str] = set()
        for key in value:
            if key not in keys:
                near = [_SYMBOLS[key]] if _SYMBOLS.get(key) in keys else closest(key, keys)
                meant.update(near)
                self._fault("unknown-key", f"`{kind}` of {self.owner} has no key `{key}`", (*at, key), key=True,
                            notes=(exists_note("key", keys, key),),
                            help=f"write `{near[0]}`" if near else None,
                            fix=Fix(near[0], key) if near else None)  # fmt: skip
        neutral = {"scale": 0.0 if kind == "lognormal" else 1.0, "offset": 0.0}.get(self.operation)
        given = {"mean": neutral, **value} if neutral is not None else value
        for key in keys:
            if key not in given and key not in meant:
                self._fault("missing-key", f"`{kind}` of {self.owner} lacks `{key}`", at, help=example)
        return [(key, given[key], (*at, key)) for key in keys if key in given]

    def _numbers(self, value: Any, kind: str, at: Path) -> tuple[float | Angle, ...]:
        """Return one number for all components, or one for each."""
        items = value if isinstance(value, list) else [value]
        found: list[float | Angle] = []
        for place, item in enumerate(items):
            read: Any = Angle.read(item) if isinstance(item, str) else item
            finite = _is_number(read) and abs(read) <= sys.float_info.max
            whole = kind != "integers" or (finite and abs(read) < _LARGEST and float(read).is_integer())
            if not whole or not (finite or isinstance(read, Angle)):
                noun = "a whole number" if kind == "integers" else "a number"
                noun = noun if finite or not _is_number(read) else "a finite number"
                message = f"`{kind}` of {self.owner} expects {noun}, got {kind_of(item)}"
                self._fault("wrong-type", message, (*at, place) if isinstance(value, list) else at)
            else:
                found.append(read)
        if not items:
            self._fault("wrong-length", f"`{kind}` of {self.owner} has an empty list of numbers", at)
        return tuple(found)

    def _unit(
        self, numbers: Mapping[str, tuple[float | Angle, ...]], angles: list[Angle], kind: str, at: Path
    ) -> Literal["deg", "rad"] | None:
        if not angles:
            return None
        if self.operation == "scale":
            self._fault("wrong-type", f"{self.owner} scales by a factor, which has no unit", at)
            return None
        if kind in ("loguniform", "lognormal"):
            self._fault("wrong-type", f"`{kind}` of {self.owner} is about a logarithm, which has no unit", at)
            return None
        for items in numbers.values():
            for each in items:
                if not isinstance(each, Angle) and each != 0:
                    unit = angles[0].unit
                    message = (
                        f"`{kind}` of {self.owner} has numbers with a unit and {shown(each)} without one"
                    )
                    self._fault("bare-angle", message, at, help=f"write `{shown(each)}{unit}`")
                    return None
        units = {each.unit for each in angles}
        return units.pop() if len(units) == 1 else "rad"

    def _check(self, distribution: FieldDistribution, at: Path) -> None:
        kind, lengths = distribution.kind, {len(each) for each in distribution.parameters.values()} - {1}
        if len(lengths) > 1:
            counts = " and ".join(map(str, sorted(lengths)))
            self._fault("wrong-length", f"`{kind}` of {self.owner} has lists of {counts} numbers", at)
            return
        for component in range(distribution.components or 1):
            wrong = _fault_of(distribution.of(component))
            if wrong is not None:
                self._fault("out-of-range", f"`{kind}` of {self.owner}: {wrong}", at)
                return


def _fault_of(distribution: Distribution) -> str | None:
    """Return what is wrong with the numbers of a distribution, or None."""
    if (
        isinstance(distribution, Uniform | LogUniform | Integers | TruncNormal)
        and distribution.low > distribution.high
    ):
        return f"the first bound, {shown(distribution.low)}, is above the second, {shown(distribution.high)}"
    if isinstance(distribution, LogUniform) and distribution.low <= 0:
        return f"the bounds are positive, got {shown(distribution.low)}"
    if isinstance(distribution, Normal | LogNormal) and distribution.std < 0:
        return f"`std` is not negative, got {shown(distribution.std)}"
    if isinstance(distribution, TruncNormal):
        if distribution.std <= 0:
            return f"`std` is positive, got {shown(distribution.std)}"
        if distribution.is_empty:
            return "between `min` and `max` there is next to nothing of it"
    return None


# Names that statisticians and other tools use.
_SYMBOLS = {"mu": "mean", "sigma": "std", "stddev": "std", "sd": "std", "low": "min", "high": "max"}


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _in(value: float | Angle, unit: str | None) -> float:
    if not isinstance(value, Angle):
        return float(value)
    return value.in_unit(unit or "rad")


def inner_kinds(value: Mapping[str, Any]) -> Iterator[str]:
    """Return the distributions that a mapping names."""
    return (kind for kind in KINDS if kind in value)

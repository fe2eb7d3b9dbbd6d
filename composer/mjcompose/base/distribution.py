"""Probability distributions: each turns 64 random bits into one number."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Protocol

from mjcompose.base import draw_stream
from mjcompose.base.dataclass import dataclass
from mjcompose.base.draw_stream import FARTHEST, exp, log, probability

if TYPE_CHECKING:
    from numpy.typing import NDArray

Support = tuple[float, float]
"""The least and the greatest number that may be drawn."""

CHOICE = "choice"
"""The key for drawing one of several values, which need not be numbers."""


class Arithmetic(Protocol):
    """The operations of distributions: `draw_stream.py` has them for numbers, `array_math.py` for arrays."""

    def fraction(self, bits: Any, /) -> Any: ...
    def below(self, bits: Any, count: int, /) -> Any: ...
    def exp(self, x: Any, /) -> Any: ...
    def quantile(self, p: Any, /) -> Any: ...
    def within(self, value: Any, low: float, high: float, /) -> Any: ...


class Distribution(ABC):
    """A distribution of numbers. `below` draws the index of a choice among given values."""

    def draw(self, bits: int) -> float:
        number: float = self._draw(bits, draw_stream)
        return number

    def draw_all(self, bits: NDArray[Any]) -> NDArray[Any]:
        """Return `draw` for each element of an array of uint64, bit for bit the same."""
        from mjcompose.base import array_math as many  # numpy, which a model with one sample has no use for

        with many.overflowing():
            numbers: NDArray[Any] = self._draw(bits, many)
        return numbers

    @property
    @abstractmethod
    def support(self) -> Support: ...

    @abstractmethod
    def _draw(self, bits: Any, by: Arithmetic) -> Any: ...


class _Between(Distribution):
    low: float
    high: float

    @property
    def support(self) -> Support:
        return self.low, self.high


@dataclass(frozen=True)
class Uniform(_Between):
    low: float
    high: float

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        return by.within(self.low + (self.high - self.low) * by.fraction(bits), *self.support)


@dataclass(frozen=True)
class LogUniform(_Between):
    """The logarithm is uniform: as many numbers between 0.1 and 1 as between 1 and 10. Both ends are positive."""

    low: float
    high: float

    @cached_property
    def _logarithms(self) -> tuple[float, float]:
        return log(self.low), log(self.high)

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        first, last = self._logarithms
        return by.within(by.exp(first + (last - first) * by.fraction(bits)), *self.support)


@dataclass(frozen=True)
class Normal(Distribution):
    mean: float
    std: float

    @property
    def support(self) -> Support:
        return (-math.inf, math.inf) if self.std else (self.mean, self.mean)

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        return self.mean + self.std * by.quantile(by.fraction(bits))


@dataclass(frozen=True)
class TruncNormal(_Between):
    """A normal distribution, restricted to the numbers between two bounds."""

    mean: float
    std: float
    low: float
    high: float

    @property
    def is_empty(self) -> bool:
        return (self.low - self.mean) / self.std > FARTHEST or (self.high - self.mean) / self.std < -FARTHEST

    @cached_property
    def _span(self) -> tuple[float, float, float]:
        """The probabilities of the two ends, and the sign. The upper side is the mirror image of the lower."""
        low = (self.low - self.mean) / self.std
        high = (self.high - self.mean) / self.std
        sign = 1.0
        if low > 0:
            low, high = -high, -low
            sign = -1.0
        return probability(low), probability(high), sign

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        first, last, sign = self._span
        p = first + (last - first) * (by.fraction(bits) if sign > 0 else 1.0 - by.fraction(bits))
        # If p is rounded to 0 or 1, the quantile is infinite, and an end is drawn.
        return by.within(self.mean + self.std * sign * by.quantile(p), *self.support)


@dataclass(frozen=True)
class LogNormal(Distribution):
    """The logarithm is normal, with this mean and standard deviation."""

    mean: float
    std: float

    @property
    def support(self) -> Support:
        return (0.0, math.inf) if self.std else (exp(self.mean), exp(self.mean))

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        return by.exp(self.mean + self.std * by.quantile(by.fraction(bits)))


@dataclass(frozen=True)
class Integers(_Between):
    low: int
    high: int

    def _draw(self, bits: Any, by: Arithmetic) -> Any:
        return self.low + by.below(bits, self.high - self.low + 1)


MAKERS: Mapping[str, Callable[..., Distribution]] = {
    "uniform": Uniform,
    "loguniform": LogUniform,
    "integers": Integers,
    "normal": Normal,
    "truncnormal": TruncNormal,
    "lognormal": LogNormal,
}

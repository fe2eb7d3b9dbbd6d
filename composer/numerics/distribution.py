"""The distributions that numbers are drawn from: each makes one number of 64 random bits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from composer.numerics.exact import exp, log
from composer.numerics.normal import FARTHEST, probability, quantile
from composer.numerics.stream import below, fraction

Support = tuple[float, float]
"""The least and the greatest number that may be drawn."""


@dataclass(frozen=True, slots=True)
class Uniform:
    """Every number between two is as likely as any other."""

    low: float
    high: float

    @property
    def support(self) -> Support:
        return self.low, self.high

    def draw(self, bits: int) -> float:
        """
        >>> Uniform(0.0, 2.0).draw(2**63)
        1.0000000000000002
        """
        return _within(self.low + (self.high - self.low) * fraction(bits), *self.support)


@dataclass(frozen=True, slots=True)
class LogUniform:
    """The logarithm is uniform: as many between 0.1 and 1 as between 1 and 10. Both ends are positive."""

    low: float
    high: float

    @property
    def support(self) -> Support:
        return self.low, self.high

    def draw(self, bits: int) -> float:
        first, last = log(self.low), log(self.high)
        return _within(exp(first + (last - first) * fraction(bits)), *self.support)


@dataclass(frozen=True, slots=True)
class Normal:
    """Gauss's distribution, with its mean and standard deviation."""

    mean: float
    std: float

    @property
    def support(self) -> Support:
        return (-math.inf, math.inf) if self.std else (self.mean, self.mean)

    def draw(self, bits: int) -> float:
        return self.mean + self.std * quantile(fraction(bits))


@dataclass(frozen=True)
class TruncNormal:
    """What a normal distribution has between two numbers."""

    mean: float
    std: float
    low: float
    high: float

    @property
    def support(self) -> Support:
        return self.low, self.high

    @property
    def is_empty(self) -> bool:
        """Whether next to nothing of the distribution is between the two."""
        return (self.low - self.mean) / self.std > FARTHEST or (self.high - self.mean) / self.std < -FARTHEST

    @cached_property
    def _span(self) -> tuple[float, float, float]:
        """The probabilities of the two ends and the sign: of the upper side the mirror image is taken."""
        low, high, sign = (self.low - self.mean) / self.std, (self.high - self.mean) / self.std, 1.0
        if low > 0:
            low, high, sign = -high, -low, -1.0
        return probability(low), probability(high), sign

    def draw(self, bits: int) -> float:
        first, last, sign = self._span
        p = first + (last - first) * (fraction(bits) if sign > 0 else 1.0 - fraction(bits))
        if not 0.0 < p < 1.0:  # rounded to the very end
            return self.low if (p <= 0.0) == (sign > 0) else self.high
        return _within(self.mean + self.std * sign * quantile(p), *self.support)


@dataclass(frozen=True, slots=True)
class LogNormal:
    """The logarithm is normal, with this mean and standard deviation."""

    mean: float
    std: float

    @property
    def support(self) -> Support:
        return (0.0, math.inf) if self.std else (exp(self.mean), exp(self.mean))

    def draw(self, bits: int) -> float:
        return exp(self.mean + self.std * quantile(fraction(bits)))


@dataclass(frozen=True, slots=True)
class Integers:
    """Whole numbers from the first to the last, both of them included."""

    low: int
    high: int

    @property
    def support(self) -> Support:
        return self.low, self.high

    def draw(self, bits: int) -> int:
        """
        >>> Integers(1, 6).draw(0), Integers(1, 6).draw(2**64 - 1)
        (1, 6)
        """
        return self.low + below(bits, self.high - self.low + 1)


Distribution = Uniform | LogUniform | Normal | TruncNormal | LogNormal | Integers
"""A distribution of numbers; a choice among given values is `below` of their count."""


def _within(value: float, low: float, high: float) -> float:
    """Rounding does not lead out of the bounds."""
    return min(max(value, low), high)

"""The bits of every distribution, and that they are distributed as they should be."""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

import pytest
from hypothesis import given, strategies as st
from mjcompose.base.distribution import Distribution, Integers, LogNormal, LogUniform, Normal, TruncNormal, Uniform
from mjcompose.base.draw_stream import bits

BITS = st.integers(0, 2**64 - 1)
# The number of sample 1, to the bit: it must be this one on every machine and with every version.
KNOWN: list[tuple[Distribution, str]] = [
    (Uniform(0.4, 1.2), "0x1.797023c7813d6p-1"),
    (LogUniform(0.5, 2.0), "0x1.cb3199df5e2eap-1"),
    (Normal(1.0, 0.1), "0x1.f5db5609d81d7p-1"),
    (TruncNormal(0.0, 1.0, 4.0, 9.0), "0x1.082bd4ad1dfddp+2"),
    (LogNormal(0.0, 0.5), "0x1.cfb6fea4afb23p-1"),
    (Integers(1, 6), "0x1.8000000000000p+1"),
]


@pytest.mark.parametrize(("distribution", "number"), KNOWN, ids=lambda each: type(each).__name__)
def test_the_same_bits_everywhere(distribution: Distribution, number: str) -> None:
    assert float(distribution.draw(bits(7, 1, "field", "element", 0))).hex() == number


@pytest.mark.parametrize(
    ("distribution", "below"),
    [
        (Uniform(2, 4), lambda x: (x - 2) / 2),
        (LogUniform(0.1, 10), lambda x: math.log(x / 0.1) / math.log(100)),
        (Normal(3, 2), NormalDist(3, 2).cdf),
        (LogNormal(1, 0.5), lambda x: NormalDist(1, 0.5).cdf(math.log(x))),
        (
            TruncNormal(0, 1, -1, 2),
            lambda x: (NormalDist().cdf(x) - NormalDist().cdf(-1)) / (NormalDist().cdf(2) - NormalDist().cdf(-1)),
        ),
    ],
    ids=lambda each: type(each).__name__,
)
def test_numbers_are_distributed_so(distribution: Distribution, below: Callable[[float], float]) -> None:
    """Kolmogorov and Smirnov: how far the numbers stray from the distribution; the draws are always the same."""
    count = 2000
    drawn = sorted(below(distribution.draw(bits(1, n, "f", "", 0))) for n in range(count))
    stray = max(max(abs(x - n / count), abs(x - (n + 1) / count)) for n, x in enumerate(drawn))
    assert stray < 1.63 / math.sqrt(count)


def test_every_integer_is_as_likely() -> None:
    dice = Integers(1, 6)
    drawn = [dice.draw(bits(1, n, "f", "", 0)) for n in range(6000)]
    assert all(900 < drawn.count(side) < 1100 for side in range(1, 7))


@given(BITS, st.floats(-1e6, 1e6), st.floats(0, 1e6))
def test_within_the_bounds(number: int, low: float, width: float) -> None:
    assert low <= Uniform(low, low + width).draw(number) <= low + width


@given(BITS, st.floats(1e-6, 1e6), st.floats(1, 1e6))
def test_within_the_bounds_of_the_logarithm(number: int, low: float, factor: float) -> None:
    assert low <= LogUniform(low, low * factor).draw(number) <= low * factor


@given(BITS, st.floats(-15, 15), st.floats(1e-3, 30))
def test_within_the_bounds_of_the_bell(number: int, low: float, width: float) -> None:
    distribution = TruncNormal(0, 1, low, low + width)
    assert not distribution.is_empty
    assert low <= distribution.draw(number) <= low + width


def test_far_from_the_mean_there_is_nothing() -> None:
    assert TruncNormal(0, 1, 21, 30).is_empty
    assert TruncNormal(5, 0.1, 0, 1).is_empty
    assert not TruncNormal(0, 1, -30, 30).is_empty


def test_without_deviation_it_is_the_mean() -> None:
    assert Normal(3, 0).draw(5) == 3
    assert Normal(3, 0).support == (3, 3)
    assert LogNormal(0, 0).support == (1, 1)
    assert LogNormal(0, 1).support == (0, math.inf)

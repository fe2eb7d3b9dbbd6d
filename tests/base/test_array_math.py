"""Draws of many samples at once are those of each by itself, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from mjcompose.base import array_math, draw_stream
from mjcompose.base.distribution import Distribution, Integers, LogNormal, LogUniform, Normal, TruncNormal, Uniform
from mjcompose.base.draw_stream import log

# The ends, and both sides of where the quantile has its tails.
EDGES = [0, 1, 2**12, 2**63 - 1, 2**63, 2**64 - 1, *(int(p * 2**64) for p in (1e-12, 0.0749, 0.0751, 0.925))]
BITS = st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=20).map(lambda found: EDGES + found)


@st.composite
def distributions(draw: st.DrawFn) -> Distribution:
    low, high = sorted(draw(st.tuples(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300))))
    mean = draw(st.floats(-1e3, 1e3))
    std = draw(st.floats(1e-3, 1e3))
    first = draw(st.floats(-19, 18))
    width = draw(st.floats(0, 9))
    return draw(
        st.sampled_from(
            [
                Uniform(low, high),
                Uniform(-1.7e308, 1.7e308),
                LogUniform(1 / (1 + abs(low)), 1 + abs(high)),
                Normal(mean, std),
                Normal(mean, 0.0),
                TruncNormal(mean, std, mean + std * first, mean + std * (first + width)),
                LogNormal(mean, std),
                LogNormal(mean, 0.0),
                Integers(int(mean) - 2**53, int(mean)),
            ]
        )
    )


def exact(numbers: list[float]) -> list[tuple[type, str]]:
    return [(type(each), each.hex() if isinstance(each, float) else str(each)) for each in numbers]


@given(distributions(), BITS)
def test_the_same_bits_together(distribution: Distribution, bits: list[int]) -> None:
    one_by_one = [distribution.draw(each) for each in bits]
    assert exact(distribution.draw_all(np.array(bits, np.uint64)).tolist()) == exact(one_by_one)


@given(st.integers(0, 2**64 - 1), st.text(max_size=5), st.text(max_size=5), st.integers(0, 9))
def test_every_sample_has_its_own_bits(seed: int, field: str, element: str, component: int) -> None:
    samples = [0, 1, 9, 10, 99_999]
    wanted = [draw_stream.bits(seed, each, field, element, component) for each in samples]
    assert array_math.bits(seed, samples, field, element, component).tolist() == wanted


@given(BITS, st.integers(1, 2**54))
def test_below(bits: list[int], count: int) -> None:
    assert array_math.below(np.array(bits, np.uint64), count).tolist() == [
        draw_stream.below(each, count) for each in bits
    ]


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=20))
def test_exponentials_and_logarithms_are_rounded_as_those_of_one_number(numbers: list[float]) -> None:
    powers = [*(each % 1000 - 500 for each in numbers if abs(each) < 1e15), *numbers, 0.0, -0.0, 709.7, -745.0]
    assert exact(array_math.exp(np.array(powers)).tolist()) == exact([draw_stream.exp(each) for each in powers])
    positive = [each for each in map(abs, numbers) if 0 < each < float("inf")]
    positive += [*(each % 1 for each in numbers if each % 1 > 0), 0.5, 0.0749, 5e-324, 1e-300, 1 - 2**-53]
    assert exact(array_math.log(np.array(positive)).tolist()) == exact([log(each) for each in positive])


def test_what_is_in_doubt_is_computed_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(array_math, "_DOUBT", 2.0**-54)  # about half of all numbers
    assert array_math.exp(np.array([0.1, 0.2, 0.3, 2.5])).tolist() == [
        draw_stream.exp(each) for each in (0.1, 0.2, 0.3, 2.5)
    ]
    monkeypatch.setattr(draw_stream, "exp", lambda x: 7.0)
    assert 7.0 in array_math.exp(np.linspace(0, 1, 50)).tolist()

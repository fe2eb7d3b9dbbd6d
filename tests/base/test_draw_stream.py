from __future__ import annotations

import hashlib
import math
from statistics import NormalDist

import pytest
from hypothesis import given, strategies as st
from mjcompose.base.draw_stream import BITS, FARTHEST, below, bits, fraction, probability, quantile


@given(st.floats(1e-300, 1, exclude_max=True))
def test_quantile(p: float) -> None:
    assert quantile(p) == pytest.approx(NormalDist().inv_cdf(p), rel=1e-14, abs=1e-15)


@given(st.floats(-FARTHEST, FARTHEST))
def test_probability(x: float) -> None:
    assert probability(x) == pytest.approx(0.5 * math.erfc(-x / math.sqrt(2)), rel=1e-12)


@given(st.floats(-FARTHEST, 8))
def test_they_undo_each_other(x: float) -> None:
    assert quantile(probability(x)) == pytest.approx(x, abs=1e-13 * math.exp(max(x, 0) ** 2 / 2) + 1e-13)


def test_beyond() -> None:
    assert (probability(-21), probability(21)) == (0.0, 1.0)


NUMBERS = st.integers(0, 2**BITS - 1)


def test_bits_are_what_the_documentation_says() -> None:
    """Anybody can make them, in any language."""
    text = '["mjcompose draws 1",7,3,"friction","cube0/w\\u00fcrfel",2]'
    wanted = int.from_bytes(hashlib.sha256(text.encode("ascii")).digest()[:8], "big")
    assert bits(7, 3, "friction", "cube0/würfel", 2) == wanted


def test_every_part_of_the_identity_counts() -> None:
    identities = [
        (seed, sample, field, element, component)
        for seed in (0, 1)
        for sample in (1, 11)
        for field in ("a", "ab")
        for element in ("", "b", 'b","c')
        for component in (0, 1)
    ]
    assert len({bits(*each) for each in identities}) == len(identities)


@given(NUMBERS)
def test_a_fraction_is_never_an_end(number: int) -> None:
    assert 0.0 < fraction(number) < 1.0


@given(NUMBERS, st.integers(1, 10**9))
def test_below(number: int, count: int) -> None:
    assert 0 <= below(number, count) < count

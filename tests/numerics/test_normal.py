from __future__ import annotations

import math
from statistics import NormalDist

import pytest
from hypothesis import given
from hypothesis import strategies as st

from composer.numerics.normal import FARTHEST, probability, quantile


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

"""One bound for all comparisons: what it allows, and what the comparisons that it replaced allowed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from mjcompose.mujoco.unequal import EXACT, Bound, differing_rows, unequal

NUMBERS = (
    math.nan,
    math.inf,
    -math.inf,
    0.0,
    -0.0,
    1e-9,
    1.0000000001e-9,
    -1e-9,
    1e9,
    1e9 + 1,
    1e9 + 1e5,
    1.0,
    1.0 + 1e-7,
)
PAIRS = list(itertools.product(NUMBERS, repeat=2))


def _of_parts(a: float, b: float) -> bool:
    """`mjcompose check`: a part in its composition."""
    return bool(np.allclose(a, b, rtol=1e-6, atol=1e-6, equal_nan=True))


def _of_poses(a: float, b: float) -> bool:
    """Numbers relative to 1 or the expected number, as worlds and keyframes are compared."""
    return a == b or (a != a and b != b) or (math.isfinite(a - b) and abs(a - b) <= 1e-6 * max(1.0, abs(a)))


def _of_diff(a: float, b: float) -> bool:
    """`mjcompose diff --tolerance`."""
    if a == b or (a != a and b != b):
        return True
    return math.isfinite(a - b) and abs(a - b) <= 1e-6 * max(abs(a), abs(b), 1e-6)


def _of_targets(a: float, b: float) -> bool:
    """A model that was read back from another format, an array of one number."""
    scale = max(1.0, abs(a)) if math.isfinite(a) else 1.0
    return bool(np.isclose(a, b, rtol=0, atol=1e-6 * scale, equal_nan=True))


def _of_versions(a: float, b: float) -> bool:
    """`mjcompose migrate`: models of two versions of MuJoCo, a row of one number; it found all numbers near an infinite one."""
    if a == b or (a != a and b != b):
        return True
    return math.isfinite(a - b) and abs(a - b) <= 1e-8 + 1e-6 * max(abs(a), abs(b))


@pytest.mark.parametrize(
    ("bound", "before"),
    [
        (Bound(1e-6, absolute=1e-6, floor=0.0), _of_parts),
        (Bound(1e-6), _of_poses),
        (Bound(1e-6, floor=1e-6), _of_diff),
        (Bound(1e-6, of="array"), _of_targets),
        (Bound(1e-6, absolute=1e-8, floor=0.0, of="row"), _of_versions),
    ],
)
def test_a_bound_allows_what_each_comparison_allowed(bound: Bound, before: Callable[[float, float], bool]) -> None:
    assert [pair for pair in PAIRS if bound.allows(*pair) != before(*pair)] == []
    assert [pair for pair in PAIRS if _is_equal(*pair, bound) != before(*pair)] == []


def test_without_a_bound_numbers_are_equal_bit_for_bit() -> None:
    exact = [(a, b) for a, b in PAIRS if a == b or (a != a and b != b)]
    assert [pair for pair in PAIRS if EXACT.allows(*pair)] == exact
    assert [pair for pair in PAIRS if _is_equal(*pair, EXACT)] == exact


def _is_equal(a: float, b: float, bound: Bound) -> bool:
    return not unequal(np.array([a]), np.array([b]), bound).any()


ROWS: list[tuple[Any, list[list[bool]]]] = [
    ("number", [[False, True], [False, True]]),
    ("row", [[False, False], [False, True]]),
    ("array", [[False, False], [False, False]]),
]


@pytest.mark.parametrize(("of", "different"), ROWS)
def test_the_size_is_of_a_number_a_row_or_the_array(of: Any, different: list[list[bool]]) -> None:
    expected = np.array([[1e6, 1.0], [1.0, 1.0]])
    actual = np.array([[1e6, 1.1], [1.0, 1.1]])
    assert unequal(expected, actual, Bound(1e-6, floor=0.0, of=of)).tolist() == different


@pytest.mark.parametrize("of", ["number", "row", "array"])
@pytest.mark.parametrize("huge", [math.inf, -math.inf, math.nan])
def test_an_infinite_number_hides_nothing_next_to_it(of: Any, huge: float) -> None:
    expected = np.array([[huge, 1.0]])
    actual = np.array([[huge, 2.0]])
    assert unequal(expected, actual, Bound(1e-6, of=of)).tolist() == [[False, True]]


def test_a_given_size_replaces_that_of_the_numbers() -> None:
    expected = np.array([1.0, 1.0])
    actual = np.array([1.1, 1.1])
    assert unequal(expected, actual, Bound(1e-3, floor=0.0), np.array([1.0, 1000.0])).tolist() == [True, False]


def test_integers_have_no_rounding_errors() -> None:
    assert unequal(np.array([1_000_000]), np.array([1_000_001]), Bound(1e-3)).tolist() == [True]


def test_rows_that_differ() -> None:
    assert differing_rows(np.zeros((3, 2), dtype=bool)) == []
    assert differing_rows(np.zeros((0, 4), dtype=bool)) == []
    assert differing_rows(np.array([[[True], [False]], [[False], [False]], [[False], [True]]])) == [0, 2]

"""Joint draws: their moments, their bounds, and correlations that do not exist."""

from __future__ import annotations

import hashlib
import json
import math
from statistics import NormalDist

import numpy as np
import pytest
from mjcompose.base.joint_normal import JointNormal, factor_of, impossible_row

WORDS = ("a", "b", "c", "d")
CORRELATION = np.array([[1, 0.6, 0.3, 0], [0.6, 1, 0.2, -0.1], [0.3, 0.2, 1, -0.9], [0, -0.1, -0.9, 1]])
MEANS = (1.0, -2.0, 30.0, 0.0)
STDS = (0.1, 2.0, 5.0, 1.0)
ENDLESS = ((-math.inf, math.inf),) * 4


def rows_of(correlation: np.ndarray) -> list[list[float]]:
    return [list(correlation[row, :row]) for row in range(1, len(correlation))]


def joint(bounds: tuple[tuple[float, float], ...] = ENDLESS) -> JointNormal:
    return JointNormal(WORDS, MEANS, STDS, bounds, factor_of(rows_of(CORRELATION), 0.005))


def draws(distribution: JointNormal, samples: int) -> np.ndarray:
    return np.array([distribution.draw(7, sample) for sample in range(1, samples + 1)])


def test_many_draws_have_the_means_and_the_covariance() -> None:
    numbers = (draws(joint(), 4000) - MEANS) / STDS
    assert np.abs(numbers.mean(axis=0)).max() < 0.05
    assert np.cov(numbers.T) == pytest.approx(CORRELATION, abs=0.06)


def test_draws_are_within_the_bounds_and_not_clamped_to_them() -> None:
    numbers = draws(joint(((0.95, 1.1), (-3, 9), (-math.inf, 33), (-9, 9))), 1500)
    for column, (low, high) in ((0, (0.95, 1.1)), (1, (-3, 9)), (2, (-math.inf, 33))):
        assert low < numbers[:, column].min()
        assert numbers[:, column].max() < high
    # A truncated joint distribution is the joint distribution of the draws that are within the bounds.
    whole = np.random.default_rng(0).multivariate_normal(MEANS, CORRELATION * np.outer(STDS, STDS), 400_000)
    fits = (whole[:, 0] > 0.95) & (whole[:, 0] < 1.1) & (whole[:, 1] > -3) & (whole[:, 1] < 9) & (whole[:, 2] < 33)
    expected = whole[fits]
    assert (numbers.mean(axis=0) - expected.mean(axis=0)) / STDS == pytest.approx(np.zeros(4), abs=0.08)
    assert np.corrcoef(numbers.T) == pytest.approx(np.corrcoef(expected.T), abs=0.08)


def test_the_first_number_is_a_quantile_of_a_hash() -> None:
    identity = json.dumps(["mjcompose draws 1", 7, 3, "measured", "a", 0], separators=(",", ":")).encode()
    bits = int.from_bytes(hashlib.sha256(identity).digest()[:8], "big")
    found = joint().draw(7, 3)
    assert found is not None
    assert found[0] == pytest.approx(1 + 0.1 * NormalDist().inv_cdf(((bits >> 12) + 0.5) / 2**52), rel=1e-12)


def test_the_same_bits_on_every_machine() -> None:
    """These digits were computed once; a machine or a version of Python with others breaks seeds."""
    found = joint().draw(7, 1)
    assert found is not None
    assert [number.hex() for number in found] == [
        "0x1.0cf59215ec451p+0",
        "-0x1.029bc99542b8ep+0",
        "0x1.adcec0d9eacd2p+4",
        "0x1.eac7744332b17p-1",
    ]


def test_bounds_without_a_draw() -> None:
    assert joint(((9, 10), *ENDLESS[1:])).draw(7, 1) is None


@pytest.mark.parametrize(
    ("rows", "wrong"),
    [
        ([[0.9], [0.9, -0.9]], 1),
        ([[0.9], [0.9, 0.9], [0.9, 0.9, -0.9]], 2),
        ([[1.0], [1.0, 1.0]], None),
        ([[-1.0], [1.0, -1.0]], None),
        ([[0.71], [0.71, 0.0]], None),  # 0.7071 and 0.7071 are possible, and are written as 0.71
        ([[0.75], [0.75, 0.0]], 1),
    ],
)
def test_impossible_correlations(rows: list[list[float]], wrong: int | None) -> None:
    assert impossible_row(rows, 0.005) == wrong


def test_rounded_correlations_become_possible() -> None:
    random = np.random.default_rng(3)
    vectors = random.normal(size=(12, 4))  # of rank 4, so rounding makes it impossible
    covariance = vectors @ vectors.T
    scale = 1 / np.sqrt(np.diag(covariance))
    correlation = covariance * scale[:, None] * scale
    rows = [[round(100 * number) / 100 for number in row] for row in rows_of(correlation)]
    rounded = np.eye(12)
    for row in range(1, 12):
        rounded[row, :row] = rounded[:row, row] = rows[row - 1]
    assert np.linalg.eigvalsh(rounded)[0] < -0.001
    assert impossible_row(rows, 0.005) is None
    factor = np.zeros((12, 12))
    for row, numbers in enumerate(factor_of(rows, 0.005)):
        factor[row, : row + 1] = numbers
    assert factor @ factor.T == pytest.approx(correlation, abs=0.02)

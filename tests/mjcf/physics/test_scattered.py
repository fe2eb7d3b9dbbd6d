from __future__ import annotations

import numpy as np
import pytest

from composer.mjcf.physics.scattered import Home, Scattered


@pytest.fixture
def source() -> np.ndarray:
    return np.arange(6.0)


@pytest.fixture
def rows(source: np.ndarray) -> Scattered:
    return Home.of(source, np.array([4, 0, 1])).read()


def test_items_and_slices_are_written_through(source: np.ndarray, rows: Scattered) -> None:
    rows[0] = 40
    rows[1:] = [10, 11]
    assert source.tolist() == [10, 11, 2, 3, 40, 5]
    assert rows.tolist() == [40, 10, 11]


def test_a_slice_of_it_is_written_through_too(source: np.ndarray, rows: Scattered) -> None:
    rows[1:][0] = 7
    part = rows[:2]
    part += 1
    assert source.tolist() == [8, 1, 2, 3, 5, 5]


@pytest.mark.parametrize(
    ("operator", "expected"),
    [("+", [6, 2, 3]), ("-", [2, -2, -1]), ("*", [8, 0, 2]), ("/", [2, 0, 0.5]), ("**", [16, 0, 1])],
)
def test_operators_in_place(
    operator: str, expected: list[float], source: np.ndarray, rows: Scattered
) -> None:
    exec(f"rows {operator}= 2")
    assert source[[4, 0, 1]].tolist() == expected


def test_rows_of_several(source: np.ndarray) -> None:
    table = source.reshape(3, 2)
    rows = Home.of(table, np.array([2, 0])).read()
    rows[0, 1] = 50
    rows[1] += 10
    rows.T[0] = -1
    assert table.tolist() == [[-1, 11], [2, 3], [-1, 50]]


def test_what_is_computed_from_it_is_its_own(source: np.ndarray, rows: Scattered) -> None:
    other = rows + 1
    other[0] = 99
    other += 1
    rows.copy()[0] = 98
    assert source.tolist() == [0, 1, 2, 3, 4, 5]


def test_it_is_a_copy_of_its_time(source: np.ndarray, rows: Scattered) -> None:
    source[4] = 9
    assert rows[0] == 4

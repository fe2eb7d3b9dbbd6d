from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import basic_indices, integer_array_indices
from mjcompose.mjcf.compile import Scattered, ScatteredRows


@pytest.fixture
def source() -> np.ndarray:
    return np.arange(6.0)


@pytest.fixture
def rows(source: np.ndarray) -> Scattered:
    return ScatteredRows.of(source, np.array([4, 0, 1])).read()


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
def test_operators_in_place(operator: str, expected: list[float], source: np.ndarray, rows: Scattered) -> None:
    exec(f"rows {operator}= 2")
    assert source[[4, 0, 1]].tolist() == expected


def test_rows_of_several(source: np.ndarray) -> None:
    table = source.reshape(3, 2)
    rows = ScatteredRows.of(table, np.array([2, 0])).read()
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


def test_what_is_not_written_stays_as_it_has_become(source: np.ndarray, rows: Scattered) -> None:
    source[:] = 100
    rows[0] = -1
    rows[1:][::-1][0] = -2
    assert sorted(source)[:3] == [-2, -1, 100]


@given(st.data())
def test_keys_of_every_form_reach_the_same_places(data: st.DataObject) -> None:
    shape = data.draw(st.sampled_from([(9,), (7, 3), (6, 2, 2)]))
    index = np.array(data.draw(st.permutations(range(shape[0])))[:4])
    source = np.arange(np.prod(shape), dtype=float).reshape(shape)
    home = ScatteredRows.of(source, index)
    rows = home.read()
    expected = source.copy()
    view = rows
    plain = np.arange(source.size).reshape(shape)[index]
    for _ in range(data.draw(st.integers(0, 2))):
        if view.ndim:
            key = data.draw(basic_indices(view.shape, allow_newaxis=True, allow_ellipsis=True))
            view = np.asanyarray(view[key])
            plain = plain[key]
    if not isinstance(view, Scattered):
        return
    key = data.draw(
        basic_indices(view.shape) | integer_array_indices(view.shape) if view.size and view.ndim else st.just(())
    )
    source[...] = expected[...] = 50.0
    view[key] = -1.0
    expected.reshape(-1)[plain[key]] = -1.0
    assert np.array_equal(source, expected)

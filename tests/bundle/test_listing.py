from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.bundle.listing import IndexRow, ListingError, RowCondition

ROWS = [
    IndexRow(Path("a"), {"sample": 1, "friction[cube]": 0.5, "mass[left]": 1, "mass[right]": 2}),
    IndexRow(Path("b"), {"sample": 2, "friction[cube]": 1.5, "mass[left]": 3, "mass[right]": 4}),
]


def test_a_field_that_was_drawn_for_one_element_goes_by_its_name() -> None:
    condition = RowCondition("friction > 1 and sample == 2")
    assert [condition.holds(row) for row in ROWS] == [False, True]
    condition.check()


def test_a_field_that_was_drawn_for_several_is_no_number() -> None:
    condition = RowCondition("mass > 1")
    assert not any(map(condition.holds, ROWS))
    with pytest.raises(ListingError) as caught:
        condition.check()
    (note,) = caught.value.diagnostic.notes
    assert note.message == "drawn for several: mass[left], mass[right]"

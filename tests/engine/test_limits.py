from __future__ import annotations

import pytest

from composer.engine.limits import Limits
from composer.limits import GIB, allow


def test_the_defaults() -> None:
    assert Limits() == Limits(seconds=300, memory=8 * GIB)


def test_limits_in_force_count_where_none_are_given() -> None:
    with allow(time=7, memory=GIB):
        assert Limits() == Limits(seconds=7, memory=GIB)
        assert Limits(seconds=3) == Limits(seconds=3, memory=GIB)


@pytest.mark.parametrize("wrong", [{"seconds": 0}, {"seconds": float("nan")}, {"memory": -1}])
def test_limits_are_greater_than_zero(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="greater than zero"):
        Limits(**wrong)  # type: ignore[arg-type]

from __future__ import annotations

import pytest

from composer.engine.limits import GIB, Limits


def test_the_defaults() -> None:
    assert Limits() == Limits(seconds=300, memory=8 * GIB)


@pytest.mark.parametrize("wrong", [{"seconds": 0}, {"seconds": float("nan")}, {"memory": -1}])
def test_limits_are_greater_than_zero(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="greater than zero"):
        Limits(**wrong)  # type: ignore[arg-type]

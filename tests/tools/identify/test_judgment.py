"""Which fits are errors, and which have warnings."""

from __future__ import annotations

from typing import Any

import pytest
from mjcompose.tools.identify.judgment import findings_of


def error(signal: str, recipe: float, fitted: float, **more: Any) -> dict[str, Any]:
    return {"signal": signal, "recipe": recipe, "fitted": fitted, "correlated": 1.0, "held_out": {}, **more}


@pytest.mark.parametrize(
    ("errors", "code"),
    [
        ([error("qpos a", 1e-3, 1.2e-3)], "worse-than-recipe"),
        ([error("qpos a", 1e-3, 1.2e-3), error("qpos b", 1e-3, 0.99e-3)], "worse-than-recipe"),
        ([error("qpos a", 1e-4, 4e-4), error("qpos b", 1e-1, 1e-4)], None),
        ([error("qpos a", 1e-3, 1e-3)], None),
        ([error("qpos a", 0.0, 0.0)], None),
        ([error("qpos a", 0.0, 1e-3)], "worse-than-recipe"),
    ],
)
def test_a_fit_that_is_worse_than_the_recipe(errors: list[dict[str, Any]], code: str | None) -> None:
    found = [(each.severity, each.code) for each in findings_of(errors)]
    assert found == ([] if code is None else [("error", code)])


def test_the_worst_signal_is_named() -> None:
    (found,) = findings_of([error("qpos a", 1e-3, 1.5e-3), error("qpos b", 1e-3, 4e-3)])
    assert found.message.endswith("worse than the recipe: `qpos b` is off by 0.004, before 0.001")

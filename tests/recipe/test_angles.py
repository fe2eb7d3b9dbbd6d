from __future__ import annotations

from typing import Any

import pytest

from composer.expr.angle import Angle
from composer.grammar import GRAMMAR
from composer.recipe.angles import bare_angle


@pytest.mark.parametrize(
    ("path", "name", "value", "joint", "at", "instead"),
    [
        ("site", "euler", (0, 90, 0), None, (1,), "euler: [0, 90deg, 0]"),
        ("site", "euler", (90, 0, 45), None, (), "euler: [90deg, 0, 45deg]"),
        ("site", "euler", (1.57, 0, 0), None, (0,), "euler: [1.57rad, 0, 0]"),
        ("site", "axisangle", (0, 0, 1, 90), None, (3,), "axisangle: [0, 0, 1, 90deg]"),
        ("replicate", "euler", (0, 0, 30), None, (2,), "euler: [0, 0, 30deg]"),
        ("joint", "ref", 90, "hinge", (), "ref: 90deg"),
        ("joint", "range", (-90, 90), "ball", (), "range: [-90deg, 90deg]"),
    ],
)
def test_told(path: str, name: str, value: Any, joint: str | None, at: tuple[int, ...], instead: str) -> None:
    fault = bare_angle(GRAMMAR.element(path).attributes[name], value, joint, (), "it")
    assert fault is not None
    assert (fault.code, fault.at) == ("bare-angle", at)
    assert fault.help is not None
    assert f"`{instead}`" in fault.help
    assert "`angle: " in fault.help


@pytest.mark.parametrize(
    ("path", "name", "value", "joint"),
    [
        ("site", "euler", (0, 0.0, 0), None),
        ("site", "euler", (Angle(90.0, "deg"), 0, 0), None),
        ("site", "axisangle", (0, 0, 1, Angle(90.0, "deg")), None),
        ("site", "pos", (1, 2, 3), None),
        ("joint", "range", (0, 90), None),
        ("joint", "range", (0, 90), "slide"),
        ("joint", "ref", 90, "ball"),
        ("camera", "fovy", 60, None),
    ],
)
def test_fine(path: str, name: str, value: Any, joint: str | None) -> None:
    assert bare_angle(GRAMMAR.element(path).attributes[name], value, joint, (), "it") is None

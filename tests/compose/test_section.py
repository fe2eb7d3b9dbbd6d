"""What a recipe writes in the sections of a model whose base has given its top class a name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

Compose = Callable[..., Any]
BASE = '<mujoco><default><geom density="5"/></default><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
RECIPE = """\
recipe: 1
base: ./own.xml
attach: {a: {model: ./robot.xml}}
asset: {texture: {sky: {type: skybox, builtin: flat, width: 8, height: 8}}, material: {m: {}}}
"""


@pytest.mark.parametrize(
    ("default", "expected"), [("", None), ("default: {main: {texture: {colorspace: sRGB}}}\n", "base/")]
)
def test_only_what_the_top_class_sets_makes_a_texture_name_it(
    compose: Compose, default: str, expected: str | None
) -> None:
    """`<texture class="c"/>` is an error in MuJoCo before 3.17. A material has had a class at all times."""
    model = compose(RECIPE + default, own__xml=BASE)
    assert model.find("asset/texture").get("class") == expected
    assert model.find("asset/material").get("class") == "base/"

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from composer.grammar import GRAMMAR
from composer.grammar.format import number_text, to_text

GEOM = GRAMMAR.element("geom").attributes


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("pos", [0, 0.5, -0.0], "0 0.5 -0"),
        ("pos", np.array([1.0, 0.1, 1e-7]), "1 0.1 1e-07"),
        ("mass", 2.0, "2"),
        ("mass", 1e22, "1e+22"),
        ("mass", np.float64(0.1), "0.1"),
        ("mass", math.inf, "inf"),
        ("mass", -math.inf, "-inf"),
        ("mass", -math.nan, "nan"),
        ("mass", "0x10", "0x10"),
        ("group", 3, "3"),
        ("group", 3.0, "3"),
        ("group", np.int32(3), "3"),
        ("shellinertia", True, "true"),
        ("shellinertia", np.bool_(False), "false"),
        ("type", "box", "box"),
    ],
)
def test_to_text(name: str, value: object, text: str) -> None:
    assert to_text(GEOM[name], value) == text


def test_lists_of_words() -> None:
    assert to_text(GRAMMAR.element("sensor/contact").attributes["data"], ["found", "force"]) == "found force"
    assert to_text(GRAMMAR.element("flex").attributes["body"], ("a", "b")) == "a b"
    assert to_text(GRAMMAR.element("visual/headlight").attributes["active"], 1) == "1"
    assert to_text(GRAMMAR.element("joint").attributes["limited"], False) == "false"


def test_what_has_no_text() -> None:
    with pytest.raises(TypeError, match="mass cannot hold NoneType"):
        to_text(GEOM["mass"], None)


@given(st.floats(allow_nan=False))
def test_numbers_are_re_read_exactly(value: float) -> None:
    again = float(number_text(value))
    assert again == value
    assert math.copysign(1, again) == math.copysign(1, value)


@given(st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_mujoco_re_reads_exactly(values: list[float]) -> None:
    xml = f'<mujoco><worldbody><geom pos="{to_text(GEOM["pos"], values)}"/></worldbody></mujoco>'
    assert mujoco.MjSpec.from_string(xml).geoms[0].pos.tolist() == values

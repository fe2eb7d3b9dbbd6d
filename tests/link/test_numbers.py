from __future__ import annotations

import math

import mujoco
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from composer.link import numbers

STEADY = settings(max_examples=80, deadline=None, derandomize=True)
DEGREES = st.floats(-1e4, 1e4)


@STEADY
@given(st.lists(st.floats(allow_nan=False), max_size=8))
def test_what_is_written_reads_back_to_the_same_bits(values: list[float]) -> None:
    read = numbers.read(numbers.text(values))
    assert list(map(float.hex, read)) == list(map(float.hex, values))


@STEADY
@given(st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_mujoco_reads_the_same_bits(values: list[float]) -> None:
    xml = f'<mujoco><worldbody><site pos="{numbers.text(values)}"/></worldbody></mujoco>'
    assert mujoco.MjModel.from_xml_string(xml).site_pos[0].tolist() == values


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1.0, "1"),
        (-0.0, "-0"),
        (0.0, "0"),
        (0.1, "0.1"),
        (1e22, "1e+22"),
        (100000.0, "100000"),
        (math.inf, "inf"),
        (-math.inf, "-inf"),
        (math.nan, "nan"),
        (5e-324, "5e-324"),
    ],
)
def test_numbers_are_as_short_as_can_be(value: float, text: str) -> None:
    assert numbers.text([value]) == text


def test_hexadecimal_numbers_and_any_white_space_are_read() -> None:
    assert numbers.read(" 0x1p-1\n\t0X10  -1e3 inf ") == [0.5, 16.0, -1000.0, math.inf]
    assert numbers.read("") == []


@STEADY
@given(st.lists(DEGREES, min_size=1, max_size=20))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_joints_turn_to_the_same_bits_as_in_mujoco(degrees: list[float]) -> None:
    bodies = "".join(f'<body><geom size="1"/><joint ref="{value!r}"/></body>' for value in degrees)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    assert model.qpos0.tolist() == [numbers.joint_radians(value) for value in degrees]


@STEADY
@given(st.lists(DEGREES, min_size=1, max_size=20))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_orientations_turn_to_the_same_bits_as_in_mujoco(degrees: list[float]) -> None:
    sites = "".join(f'<site axisangle="0 0 1 {value!r}"/>' for value in degrees)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{sites}</worldbody></mujoco>")
    halves = [numbers.orientation_radians(value) / 2 for value in degrees]
    assert model.site_quat[:, 0].tolist() == [math.cos(half) for half in halves]
    assert model.site_quat[:, 3].tolist() == [math.sin(half) for half in halves]


@pytest.mark.parametrize("text", ["1_0", "\u0661", "1\u00a02", "1e400", "-1e400", "0x1p2000", "1,2", "0x"])
def test_what_mujoco_refuses_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="not a number|could not convert"):
        numbers.read(f"1 {text} 2")
    with pytest.raises(ValueError, match="XML Error"):
        mujoco.MjModel.from_xml_string(f'<mujoco><worldbody><site user="1 {text} 2"/></worldbody></mujoco>')


@pytest.mark.parametrize("text", ["inf", "-INFINITY", "nan", "NaN(1)", "0X1P3", "+.5", "5.", "\t5\n"])
def test_what_mujoco_takes_is_a_number(text: str) -> None:
    xml = f'<mujoco><worldbody><site user="{text}"/></worldbody></mujoco>'
    value = mujoco.MjModel.from_xml_string(xml).site_user[0, 0]
    assert numbers.read(text) == pytest.approx([value], abs=0, nan_ok=True)

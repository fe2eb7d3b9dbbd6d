from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from lxml import etree
from mjcompose.link import numbers as numbers_module
from mjcompose.link.numbers import pose_in_world, read_pose

STEADY = settings(max_examples=80, deadline=None, derandomize=True)
DEGREES = st.floats(-1e4, 1e4)


@STEADY
@given(st.lists(st.floats(allow_nan=False), max_size=8))
def test_what_is_written_reads_back_to_the_same_bits(values: list[float]) -> None:
    read = numbers_module.read(numbers_module.text(values))
    assert list(map(float.hex, read)) == list(map(float.hex, values))


@STEADY
@given(st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_mujoco_reads_the_same_bits(values: list[float]) -> None:
    xml = f'<mujoco><worldbody><site pos="{numbers_module.text(values)}"/></worldbody></mujoco>'
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
    assert numbers_module.text([value]) == text


def test_hexadecimal_numbers_and_any_white_space_are_read() -> None:
    assert numbers_module.read(" 0x1p-1\n\t0X10  -1e3 inf ") == [0.5, 16.0, -1000.0, math.inf]
    assert numbers_module.read("") == []


@STEADY
@given(st.lists(DEGREES, min_size=1, max_size=20))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_joints_turn_to_the_same_bits_as_in_mujoco(degrees: list[float]) -> None:
    bodies = "".join(f'<body><geom size="1"/><joint ref="{value!r}"/></body>' for value in degrees)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    assert model.qpos0.tolist() == [numbers_module.joint_radians(value) for value in degrees]


@STEADY
@given(st.lists(DEGREES, min_size=1, max_size=20))
@pytest.mark.mujoco4("the smallest numbers are refused")
def test_orientations_turn_to_the_same_bits_as_in_mujoco(degrees: list[float]) -> None:
    sites = "".join(f'<site axisangle="0 0 1 {value!r}"/>' for value in degrees)
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{sites}</worldbody></mujoco>")
    halves = [numbers_module.orientation_radians(value) / 2 for value in degrees]
    assert model.site_quat[:, 0].tolist() == [math.cos(half) for half in halves]
    assert model.site_quat[:, 3].tolist() == [math.sin(half) for half in halves]


@pytest.mark.parametrize("text", ["1_0", "\u0661", "1\u00a02", "1e400", "-1e400", "0x1p2000", "1,2", "0x"])
def test_what_mujoco_refuses_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="not a number|could not convert"):
        numbers_module.read(f"1 {text} 2")
    with pytest.raises(ValueError, match="XML Error"):
        mujoco.MjModel.from_xml_string(f'<mujoco><worldbody><site user="1 {text} 2"/></worldbody></mujoco>')


@pytest.mark.parametrize("text", ["inf", "-INFINITY", "nan", "NaN(1)", "0X1P3", "+.5", "5.", "\t5\n"])
def test_what_mujoco_takes_is_a_number(text: str) -> None:
    xml = f'<mujoco><worldbody><site user="{text}"/></worldbody></mujoco>'
    value = mujoco.MjModel.from_xml_string(xml).site_user[0, 0]
    assert numbers_module.read(text) == pytest.approx([value], abs=0, nan_ok=True)


FLOATS = st.floats(-3, 3).map(lambda number: round(number, 4))


def numbers(count: int) -> st.SearchStrategy[list[float]]:
    return st.lists(FLOATS, min_size=count, max_size=count).filter(
        lambda values: math.hypot(*values[:3]) > 0.1 and (count < 6 or crossed(values) > 0.1)
    )


def crossed(axes: list[float]) -> float:
    return float(np.linalg.norm(np.cross(axes[:3], axes[3:])))


POSES = st.one_of(
    numbers(4).map(lambda values: ("quat", values)),
    numbers(4).map(lambda values: ("axisangle", values)),
    numbers(3).map(lambda values: ("euler", values)),
    numbers(3).map(lambda values: ("zaxis", values)),
    numbers(6).map(lambda values: ("xyaxes", values)),
)


def written(pose: tuple[str, list[float]], pos: list[float]) -> dict[str, str]:
    name, values = pose
    return {"pos": " ".join(map(repr, pos)), name: " ".join(map(repr, values))}


@settings(max_examples=80, deadline=None, derandomize=True)
@given(POSES, numbers(3), st.booleans(), st.sampled_from(["xyz", "ZYX", "xZy"]))
def test_a_pose_is_read_as_mujoco_reads_it(
    pose: tuple[str, list[float]], pos: list[float], degrees: bool, sequence: str
) -> None:
    attributes = written(pose, pos)
    text = " ".join(f'{name}="{value}"' for name, value in attributes.items())
    angle = "degree" if degrees else "radian"
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="{angle}" eulerseq="{sequence}"/><worldbody><site {text}/></worldbody></mujoco>'
    )
    found = read_pose(attributes, degrees, sequence)
    assert found.pos == tuple(model.site_pos[0])
    assert found.quat == tuple(model.site_quat[0])


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(st.tuples(POSES, numbers(3), st.sampled_from(["body", "frame"])), min_size=1, max_size=5))
def test_poses_are_multiplied_out_as_mujoco_does(steps: list[tuple[tuple[str, list[float]], list[float], str]]) -> None:
    root = etree.Element("mujoco")
    innermost = etree.SubElement(root, "worldbody")
    for pose, pos, tag in steps:
        innermost = etree.SubElement(innermost, tag, written(pose, pos))
    etree.SubElement(innermost, "site")
    model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, data.site_xmat[0])
    found = pose_in_world(innermost, True, "xyz")
    assert found.pos == pytest.approx(data.site_xpos[0], abs=1e-12)
    assert abs(float(np.dot(found.quat, quat))) == pytest.approx(1, abs=1e-12)


def test_nothing_written_is_the_identity() -> None:
    assert read_pose({}, True, "xyz").is_identity
    assert read_pose({"pos": "", "euler": "", "quat": ""}, True, "xyz").is_identity
    assert pose_in_world(etree.fromstring("<worldbody/>"), True, "xyz").is_identity

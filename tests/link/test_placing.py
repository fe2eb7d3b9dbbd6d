from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from composer.link.placing import pose_in_world, read_pose

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
def test_poses_are_multiplied_out_as_mujoco_does(
    steps: list[tuple[tuple[str, list[float]], list[float], str]],
) -> None:
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

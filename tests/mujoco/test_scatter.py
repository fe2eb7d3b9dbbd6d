from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.base.draw_stream import bits, fraction
from mjcompose.mujoco.scatter import _support, _turn

SHAPES = {
    "sphere": 'size=".1"',
    "capsule": 'size=".05 .1"',
    "ellipsoid": 'size=".05 .1 .15"',
    "cylinder": 'size=".05 .1"',
    "box": 'size=".05 .1 .15"',
    "mesh": 'mesh="m"',
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("euler", ["0 0 0", "30 50 70", "90 0 45"])
def test_the_lowest_point_of_a_geom_is_its_distance_to_the_floor(kind: str, euler: str) -> None:
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><asset><mesh name="m" vertex="0 0 0 .2 0 0 0 .3 0 0 0 .4 .1 .1 .2"/></asset>
      <worldbody><geom type="plane" size="1 1 1"/><geom type="{kind}" {SHAPES[kind]} pos=".3 .2 1" euler="{euler}"/></worldbody>
    </mujoco>""")  # fmt: skip
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    points = _support(model, data, 1)
    assert points[-1][2] == pytest.approx(mujoco.mj_geomDistance(model, data, 1, 0, 9, None), abs=1e-6)
    widest = points[:16] @ np.array([1, 0, 0])
    assert widest.argmax() == 0 and widest.max() > 0.3


@pytest.mark.parametrize("count", [2, 4])
def test_turns_are_uniform(count: int) -> None:
    """The mean of the turned x axis is 0; about the vertical, z stays."""
    axes = []
    for trial in range(2000):
        drawn = (fraction(bits(1, trial, "scatter", "", n)) for n in range(1000))
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, np.array(_turn(drawn, count)))
        axes.append(matrix.reshape(3, 3))
    mean = np.mean(axes, axis=0)
    assert np.abs(mean[:2, :2]).max() < 0.05
    assert mean[2, 2] == pytest.approx(1 if count == 2 else 0, abs=0.05)

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from mjcompose.base.draw_stream import bits, fraction
from mjcompose.mujoco.scatter import _support, _turn, scatter

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
    </mujoco>""")
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


class Noisy:
    """MuJoCo on a processor that rounds in another way: noise in the last bits of each result."""

    def __init__(self, seed: int) -> None:
        self.random = np.random.default_rng(seed)

    def __getattr__(self, name: str) -> Any:
        return getattr(mujoco, name)

    def mj_step(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        mujoco.mj_step(model, data)
        data.qpos[:] += 1e-15 * self.random.standard_normal(model.nq)

    def mj_kinematics(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        mujoco.mj_kinematics(model, data)
        data.geom_xpos[:] *= 1 + 1e-15 * self.random.standard_normal(data.geom_xpos.shape)


@pytest.mark.parametrize("settle", [None, 2.0])
@pytest.mark.parametrize(("kind", "upright"), [("box", False), ("mesh", False), ("cylinder", True), ("capsule", True)])
def test_noise_in_the_last_bits_changes_no_place(kind: str, upright: bool, settle: float | None) -> None:
    sizes = {
        "box": 'size=".03 .02 .015"',
        "mesh": 'mesh="m"',
        "cylinder": 'size=".03 .05"',
        "capsule": 'size=".03 .05"',
    }
    bodies = "".join(
        f'<body name="c{n}" pos="0 0 {100 * n + 100}"><freejoint/><geom type="{kind}" {sizes[kind]}/></body>'
        for n in range(6)
    )
    text = f"""<mujoco><asset><mesh name="m" vertex="0 0 0 .06 0 0 0 .06 0 0 0 .04 .06 .06 .02"/></asset><worldbody>
      <geom name="top" type="box" size=".3 .2 .02"/>{bodies}</worldbody></mujoco>"""
    places = 0
    for seed in range(4):
        group = {
            "bodies": [f"c{n}" for n in range(6)],
            "over": ["geom", "top"],
            "place": ["world", ""],
            "part": "c",
            "clearance": 0.01,
            "upright": upright,
            "seed": seed,
            "key": None,
            "settle": settle,
        }
        found = [
            scatter(each, mujoco.MjModel.from_xml_string(text), {"groups": [group]})
            for each in (mujoco, Noisy(1), Noisy(2))
        ]
        outcomes = [each.get("poses", each.get("fault", {}).get("why")) for each in found]
        assert outcomes[0] == outcomes[1] == outcomes[2]
        places += "poses" in found[0]
    # A capsule on its end falls and rolls. On a box, MuJoCo 3.11 keeps meshes trembling.
    is_restless = kind == "capsule" or (kind == "mesh" and mujoco.__version__.startswith("3.11."))
    assert places >= (0 if is_restless and settle is not None else 1)

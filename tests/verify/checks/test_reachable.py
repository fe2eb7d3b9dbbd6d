from __future__ import annotations

import subprocess
import sys

import mujoco
import numpy as np
import pytest
from mjcompose.verify.checks.inverse_kinematics import Solver

from tests.verify.checks.conftest import notes

PLANAR = """
<mujoco>
  <worldbody>
    <body name="u">
      <joint name="a" axis="0 0 1" {first}/>
      <geom type="capsule" fromto="0 0 0 1 0 0" size=".02"/>
      <body name="l" pos="1 0 0">
        <joint name="b" axis="0 0 1" {second}/>
        <geom type="capsule" fromto="0 0 0 1 0 0" size=".02"/>
        <site name="tip" pos="1 0 0"/>
      </body>
    </body>
    <site name="fixed" pos="0 0 1"/>
  </worldbody>
  <keyframe><key name="bent" qpos="0.5 0.5"/></keyframe>
</mujoco>
"""
FREE = PLANAR.format(first="", second="")


@pytest.mark.parametrize("target", ["[2, 0, 0]", "[0, 1.99, 0]", "[-1, 0.5, 0]", "[0, 0, 0]", "[1.2, -1.2, 0]"])
def test_within_reach(ask, target: str) -> None:
    assert ask(FREE, f"reachable: {{site: tip, target: {target}, tolerance: 1e-4}}") == []


def test_out_of_reach(ask) -> None:
    (finding,) = ask(FREE, "reachable: {site: tip, target: [3, 0, 0]}")
    assert finding.at == ("target",)
    assert finding.message == "site `tip` comes no nearer to [3, 0, 0] than 1 m"
    assert notes(finding) == ("expected: within 0.001 m", "actual: 1 m", "32 starts were tried")
    (above,) = ask(FREE, "reachable: {site: tip, target: [1, 0, 0.25]}")
    assert notes(above)[1] == "actual: 0.25 m"


def test_limits_are_kept(ask) -> None:
    limited = PLANAR.format(first='range="-10 10"', second='range="0 90"')
    assert ask(limited, "reachable: {site: tip, target: [1, 1, 0]}") == []
    (finding,) = ask(limited, "reachable: {site: tip, target: [-1, 0, 0]}")
    assert notes(finding)[-1] == "at the nearest pose, joints are at their limits: b, a"


def test_an_elbow_that_must_fold_the_other_way_is_found_from_another_start(ask) -> None:
    apart = PLANAR.format(first='range="-180 180"', second='range="-170 -5"')
    assert ask(apart, "reachable: {site: tip, target: [0.2, -0.3, 0], key: bent, tolerance: 1e-5}") == []


def test_a_site_that_nothing_moves(ask) -> None:
    assert ask(FREE, "reachable: {site: fixed, target: [0, 0, 1]}") == []
    (finding,) = ask(FREE, "reachable: {site: fixed, target: [0, 0, 0]}")
    assert "no joint moves it" in notes(finding)[-1]


def test_a_free_base_stays(ask) -> None:
    body = (
        '<mujoco><worldbody><body pos="0 0 1"><freejoint/><geom size=".1"/><site name="s"/></body></worldbody></mujoco>'
    )
    assert ask(body, "reachable: {site: s, target: [0, 0, 1]}") == []
    assert len(ask(body, "reachable: {site: s, target: [0, 0, 2]}")) == 1


def test_ball_joints_and_their_limits(ask) -> None:
    model = """
    <mujoco><worldbody><body><joint type="ball" range="0 60"/><geom size=".1"/><site name="s" pos="0 0 1"/></body>
    </worldbody></mujoco>"""
    assert ask(model, "reachable: {site: s, target: [0.6, 0, 0.8]}") == []
    (finding,) = ask(model, "reachable: {site: s, target: [1, 0, 0]}")
    assert notes(finding)[1] == f"actual: {2 * np.sin(np.radians(15)):.4g} m"


def test_equality_constraints_stay_closed(ask) -> None:
    coupled = FREE.replace(
        "<keyframe>", '<equality><joint joint1="b" joint2="a" polycoef="0 -2 0 0 0"/></equality><keyframe>'
    )
    # With b = -2a the tip stays on the x axis.
    assert ask(coupled, "reachable: {site: tip, target: [1, 0, 0]}") == []
    (finding,) = ask(coupled, "reachable: {site: tip, target: [1, 1, 0]}")
    assert float(notes(finding)[1].split()[1]) == pytest.approx(1, abs=1e-3)


def test_in_a_nested_recipe_the_target_is_in_its_own_world(ask) -> None:
    frame = {"body": None, "pos": [0, 0, -5], "quat": [1, 0, 0, 0]}
    assert ask(FREE, "reachable: {site: tip, target: [1, 1, 5]}", frame=frame) == []
    turned = {"body": "u", "pos": [0, 0, 0], "quat": [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]}
    assert ask(FREE, "reachable: {site: tip, target: [0, 1, 0]}", frame=turned) == []


def test_positions_that_are_found_do_bring_it_there_and_are_the_same_every_time() -> None:
    model = mujoco.MjModel.from_xml_string(PLANAR.format(first='range="-90 90"', second='range="-150 0"'))
    target = np.array([1.1, 0.3, 0.0])
    found = []
    for _ in range(2):
        data = mujoco.MjData(model)
        solver = Solver(mujoco, model, data, 0 if model.site(0).name == "tip" else 1, target, 1e-4)
        assert solver.solve() <= 1e-4
        mujoco.mj_forward(model, data)
        assert np.linalg.norm(data.site("tip").xpos - target) <= 1e-4
        assert np.all(data.qpos >= model.jnt_range[:, 0]) and np.all(data.qpos <= model.jnt_range[:, 1])
        found.append(data.qpos.copy())
    assert np.array_equal(*found)


def test_a_name_that_is_not_there(ask) -> None:
    (finding,) = ask(FREE, "reachable: {site: tpi, target: [0, 0, 0]}")
    assert (finding.code, finding.at, finding.help) == ("unknown-name", ("site",), "did you mean `tip`?")


def test_a_key_outside_of_the_ranges_is_brought_into_them(ask) -> None:
    apart = PLANAR.format(first='range="-10 10"', second='range="60 90"')  # the key has 29 degrees twice
    assert ask(apart, "reachable: {site: tip, target: [1, 1, 0], key: bent, tolerance: 1e-4}") == []
    (finding,) = ask(apart, "reachable: {site: tip, target: [0.5, 1.3, 0], key: bent}")
    assert "joints are at their limits" in notes(finding)[-1]


def test_a_ball_joint_at_its_limit_turns_along_it() -> None:
    """One of them is at its limit, or nearly, wherever the site is asked to be."""
    text = """
    <mujoco><worldbody><body><joint type="ball"/><geom size=".1"/><body pos="0 0 1"><joint type="ball" range="0 20"/>
    <geom size=".1"/><site name="s" pos="0 0 1"/></body></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    for target in ([0, 0, -1.99], [1.4, 0, -1.4], [-1.98, 0, 0], [0.1, 1.9, -0.54]):
        data = mujoco.MjData(model)
        solver = Solver(mujoco, model, data, 0, np.array(target), 1e-4)
        assert solver.solve() <= 1e-4
        assert 2 * np.arccos(min(abs(data.qpos[4]), 1)) <= np.radians(20) + 1e-6


def test_mujoco_is_not_imported_where_checks_are_only_asked() -> None:
    code = "import sys, mjcompose.verify.checks.check; print('mujoco' in sys.modules)"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "False"

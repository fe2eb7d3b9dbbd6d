"""Limits that `convert` and `datasheet` give: they hold, whatever the actuator or its class said before."""

from __future__ import annotations

from pathlib import Path

import mjcompose
import mujoco
import pytest

ARM = """
<mujoco model="arm"><compiler angle="radian" autolimits="{auto}"/><default><default class="c">{of_class}</default></default>
  <worldbody><body name="b"><joint name="j" axis="0 1 0" {type} range="-0.2 1.4" limited="true"/><geom size=".1"/></body></worldbody>
  <actuator>{actuator}</actuator></mujoco>
"""
MOTOR = '<motor name="m" joint="j" class="c" ctrlrange="-30 30" {}/>'


def converted(
    folder: Path, actuator: str, verb: str, *, of_class: str = "", auto: str = "true", type: str = ""
) -> mujoco.MjModel:
    (folder / "arm.xml").write_text(ARM.format(actuator=actuator, of_class=of_class, auto=auto, type=type))
    (folder / "r.yaml").write_text(
        "recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\ndatasheets: {d: {source: x, effort: 12}}\n"
        f"edit: [{{select: {{actuator: m}}, {verb}, allow: [convert-loss]}}]\n"
    )
    return mjcompose.model(folder / "r.yaml")


@pytest.mark.parametrize("auto", ["true", "false"])
@pytest.mark.parametrize(
    ("own", "of_class"),
    [
        ('ctrllimited="true"', ""),
        ('ctrllimited="false"', ""),
        ('ctrllimited="true"', "<motor gear='1'/>"),
        ("", '<general ctrllimited="false"/>'),
        ("", '<general ctrlrange="-7 7" ctrllimited="true"/>'),
    ],
)
@pytest.mark.parametrize(
    ("to", "expected"),
    [
        ("position, kp: 50, inheritrange: 1", [-0.2, 1.4]),
        ("position, kp: 50, inheritrange: 0.5", [0.2, 1.0]),
        ("position, kp: 50, ctrlrange: [-0.1rad, 0.1rad]", [-0.1, 0.1]),
    ],
)
def test_a_limit_that_the_entry_gives_holds(
    tmp_path: Path, to: str, expected: list[float], own: str, of_class: str, auto: str
) -> None:
    if auto == "false" and "ctrllimited" not in own + of_class:
        own = 'ctrllimited="true"'
    if "inheritrange" in to and "ctrlrange" in of_class and mujoco.__version__.startswith("3."):
        pytest.skip("MuJoCo 3 refuses `inheritrange` next to the `ctrlrange` of a class")
    model = converted(tmp_path, MOTOR.format(own), f"convert: {{to: {to}}}", of_class=of_class, auto=auto)
    assert model.actuator_ctrllimited.tolist() == [True]
    assert model.actuator_ctrlrange[0] == pytest.approx(expected)


@pytest.mark.mujoco4("it has no pid")
@pytest.mark.parametrize("own", ['ctrllimited="true"', 'ctrllimited="false"'])
@pytest.mark.parametrize("name", ["posrange: [-0.3rad, 0.4rad]", "ctrlrange: [-0.3rad, 0.4rad]"])
def test_a_limit_of_a_pid_holds(tmp_path: Path, name: str, own: str) -> None:
    model = converted(tmp_path, MOTOR.format(own), f"convert: {{to: pid, kp: 4, input: [pos], {name}}}")
    assert model.actuator_ctrllimited.tolist() == [True]
    assert model.actuator_ctrlrange[0] == pytest.approx([-0.3, 0.4])


@pytest.mark.parametrize("verb", ["convert: {to: position, kp: 9, forcerange: [-12, 12]}", "datasheet: {model: d}"])
@pytest.mark.parametrize(
    ("own", "of_class"), [('forcelimited="false"', ""), ("", '<general forcelimited="false"/>'), ("", "")]
)
def test_a_limit_of_the_force_holds(tmp_path: Path, verb: str, own: str, of_class: str) -> None:
    model = converted(tmp_path, MOTOR.format(own), verb, of_class=of_class)
    assert model.actuator_forcelimited.tolist() == [True]
    assert model.actuator_forcerange[0] == pytest.approx([-12, 12])


def test_the_range_of_a_joint_is_not_that_of_a_turned_control(tmp_path: Path) -> None:
    """MuJoCo 4.0 ignores the gear -1: of -0.2 to 1.4, the joint would reach 0.2 down to -1.4."""
    with pytest.raises(mjcompose.BuildError) as caught:
        converted(tmp_path, MOTOR.format('gear="-1"'), "convert: {to: position, kp: 9, inheritrange: 1}")
    assert "not-supported" in str(caught.value) and "-1 times the position" in str(caught.value)


BALL = """
<mujoco model="ball"><worldbody><body name="b"><joint name="j" type="ball"/><geom size=".1"/><site name="s"/></body><site name="o"/></worldbody>
  <actuator><motor name="m" {target} gear="{gear}"/></actuator></mujoco>
"""


@pytest.mark.parametrize(
    ("target", "gear", "is_plain"),
    [
        ('joint="j"', "0 1 0", True),
        ('joint="j"', "0 0 -2", False),
        ('site="s" refsite="o"', "0 0 1 0 0 0", True),
        ('site="s" refsite="o"', "0 0 0 3 0 0", False),
    ],
)
def test_a_number_of_a_joint_without_an_axis_is_an_error(
    tmp_path: Path, target: str, gear: str, is_plain: bool
) -> None:
    (tmp_path / "ball.xml").write_text(BALL.format(target=target, gear=gear))
    recipe = "recipe: 1\nallow: [license-missing, convert-loss]\nbase: ./ball.xml\nedit: [{{select: {{actuator: m}}, convert: {{{}}}}}]\n"
    (tmp_path / "r.yaml").write_text(recipe.format("to: position, kp: 50"))
    if is_plain:
        assert mjcompose.model(tmp_path / "r.yaml").actuator_gainprm[0, 0] == 50
        return
    with pytest.raises(mjcompose.BuildError, match="describes a joint with one axis"):
        mjcompose.model(tmp_path / "r.yaml")
    (tmp_path / "r.yaml").write_text(recipe.format("to: position, kp: 50, gear: [0, 0, 1, 0, 0, 0]"))
    assert mjcompose.model(tmp_path / "r.yaml").actuator_gainprm[0, 0] == 50
    (tmp_path / "r.yaml").write_text(recipe.format("to: general, gainprm: [50]"))
    assert mjcompose.model(tmp_path / "r.yaml").actuator_gainprm[0, 0] == 50

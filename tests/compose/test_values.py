"""Values of edits: expressions over parameters, present values and attributes.

The mass of a body in an edit: its whole inertia follows.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from compose.arm import RADIANS, Case, names


def test_attributes_stand_in_values_and_new_names(radian: Case) -> None:
    edit = "{select: {actuator: 'm?'}, set: {gear: ['${index + 3}']}, rename: '${joint}_motor'}"
    assert radian.edited(edit).actuator("elbow_motor").gear[0] == 3


def test_a_parameter_and_an_attribute_of_one_name_are_written_apart(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nparams: {armature: 0.5}\nbase: ./arm.xml\n"
        "edit: [{select: {joint: elbow}, set: {damping: '${params.armature}', frictionloss: '${damping + 1}'}},"
        " {select: {joint: elbow}, set: {armature: 0.25}},"
        " {select: {joint: elbow, where: '${element.armature < params.armature}'}, set: {armature: '${armature}'}},"
        " {select: {joint: elbow}, set: {stiffness: '${element.armature * 4}'}}]\n"
    )
    joint = model.joint("elbow")
    assert (joint.damping[0], model.dof_frictionloss[joint.dofadr[0]]) == (0.5, 1.5)
    assert (joint.armature[0], joint.stiffness[0]) == (0.5, 2)


@pytest.mark.parametrize(
    "edit",
    [
        "{select: {joint: elbow}, set: {damping: '${armature * 2}'}}",
        "{select: {joint: elbow, where: '${armature > 0}'}, optional: true, set: {damping: 2}}",
        "{select: {joint: elbow, where: {damping: '${armature}'}}, optional: true, set: {damping: 2}}",
        "{select: {joint: elbow}, scale: {damping: '${armature}'}}",
        "{select: {joint: elbow}, rename: 'elbow_${armature}'}",
    ],
)
def test_a_name_of_both_is_an_error_everywhere(radian: Case, edit: str) -> None:
    assert [each.split()[1] for each in radian.told(edit, head="params: {armature: 0.5}\n")] == ["expression"]
    assert "write `params.armature` for the parameter, or `element.armature` for the attribute" in radian.said


def test_an_attribute_that_only_others_of_the_family_have(radian: Case) -> None:
    """A condition on it selects none of the elements without it, also if a parameter has its name."""
    motor = "actuator: {drive: {type: motor, joint: elbow}, hold: {type: position, joint: elbow, kp: 77}}\n"
    model = radian.edited(
        "{select: {actuator: '**', where: '${element.kp == params.kp}'}, expect: 1, set: {group: 3}}",
        head=f"params: {{kp: 77}}\n{motor}",
    )
    assert (model.actuator("hold").group[0], model.actuator("drive").group[0]) == (3, 0)


def test_names_by_parent_and_index(radian: Case) -> None:
    model = radian.edited("{select: {geom: '**', parent: {body: tray}}, rename: '${parent}_g${index}'}")
    assert {"tray_g0", "tray_g1"} <= set(names(model, "geom"))


def test_expressions_know_parameters(radian: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from mjcompose.plan import planner as make

    plan_of: Callable[..., Any] = make.plan_what_remains
    monkeypatch.setattr(
        "mjcompose.pipeline.stages.plan_what_remains",
        lambda *given, **named: replace(plan_of(*given, **named), scope={"payload": 0.5}),
    )
    model = radian.edited("{select: {joint: elbow}, set: {armature: '${payload + index}'}}")
    assert model.joint("elbow").armature[0] == 0.5


def test_no_value_yet_in_a_list(radian: Case) -> None:
    assert radian.told("{select: {geom: upper}, set: {rgba: [1, '${value}', 0, 1], user: ['${value}']}}")
    assert "geom `upper` has no `user` yet" in radian.said


@pytest.mark.parametrize("body", ["link1", "link2", "tray", "base"])
def test_a_mass_is_the_whole_inertia(radian: Case, body: str) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n").body(body)
    for verb, value, factor in (
        ("scale", 1.25, 1.25),
        ("set", 3, 3 / before.mass[0]),
        ("set", "'${value + 0.5}'", 1 + 0.5 / before.mass[0]),
        ("set", "'${2 * value}'", 2),
    ):
        after = radian.edited(f"{{select: {{body: {body}}}, {verb}: {{mass: {value}}}}}").body(body)
        assert after.mass == pytest.approx(factor * before.mass, rel=1e-12)
        assert after.inertia == pytest.approx(factor * before.inertia, rel=1e-12)
        assert after.ipos == pytest.approx(before.ipos) and after.iquat == pytest.approx(before.iquat)


def test_a_mass_under_rules_for_the_whole_model(tmp_path: Path) -> None:
    """`settotalmass` has been applied before a body is changed."""
    arm = Case(tmp_path, RADIANS.replace('autolimits="true"', 'settotalmass="20"'))
    before = arm.model("recipe: 1\nbase: ./arm.xml\n")
    after = arm.edited("{select: {body: link2}, scale: {mass: 2}}")
    assert after.body("link2").mass == pytest.approx(2 * before.body("link2").mass)
    assert after.body("base").mass == pytest.approx(before.body("base").mass)


def test_a_full_inertia_follows_the_mass(tmp_path: Path) -> None:
    inertial = '<inertial pos="0 0 0" mass="2" fullinertia="1 2 2.5 .1 .2 .3"/>'
    arm = Case(tmp_path, f'<mujoco><worldbody><body name="b"><joint/>{inertial}</body></worldbody></mujoco>')
    before = arm.model("recipe: 1\nbase: ./arm.xml\n").body("b")
    for verb, factor in (("scale: {mass: 3}", 3), ("set: {mass: 5}", 2.5)):
        after = arm.edited(f"{{select: {{body: b}}, {verb}}}").body("b")
        assert after.mass == pytest.approx(factor * before.mass)
        assert after.inertia == pytest.approx(factor * before.inertia)

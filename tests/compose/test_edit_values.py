"""Values of edits: expressions over parameters, present values and attributes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from compose.arm import Case, names


def test_attributes_stand_in_values_and_new_names(radian: Case) -> None:
    edit = "{select: {actuator: 'm?'}, set: {gear: ['${index + 3}']}, rename: '${joint}_motor'}"
    assert radian.edited(edit).actuator("elbow_motor").gear[0] == 3


def test_a_parameter_stands_before_an_attribute_of_its_name(radian: Case) -> None:
    model = radian.model(
        "recipe: 1\nparams: {armature: 0.5}\nbase: ./arm.xml\n"
        "edit: [{select: {joint: elbow}, set: {damping: '${armature}', frictionloss: '${damping + 1}'}}]\n"
    )
    joint = model.joint("elbow")
    assert (joint.damping[0], model.dof_frictionloss[joint.dofadr[0]]) == (0.5, 1.5)


def test_names_by_parent_and_index(radian: Case) -> None:
    model = radian.edited("{select: {geom: '**', parent: {body: tray}}, rename: '${parent}_g${index}'}")
    assert {"tray_g0", "tray_g1"} <= set(names(model, "geom"))


def test_expressions_know_parameters(radian: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from composer.plan import planner as make

    plan_of: Callable[..., Any] = make.plan_what_remains
    monkeypatch.setattr(
        "composer.stages.plan_what_remains",
        lambda *given, **named: replace(plan_of(*given, **named), scope={"payload": 0.5}),
    )
    model = radian.edited("{select: {joint: elbow}, set: {armature: '${payload + index}'}}")
    assert model.joint("elbow").armature[0] == 0.5


def test_no_value_yet_in_a_list(radian: Case) -> None:
    assert radian.told("{select: {geom: upper}, set: {rgba: [1, '${value}', 0, 1], user: ['${value}']}}")
    assert "geom `upper` has no `user` yet" in radian.said

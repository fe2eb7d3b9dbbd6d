"""The verbs `set`, `scale` and `offset`: units of what is written and of what is there."""

from __future__ import annotations

import numpy as np
import pytest
from compose.arm import Case


def test_angles_are_in_the_unit_of_the_recipe(arm: Case, own: bool) -> None:
    """Bare ones, and what is there now."""
    edits = "{select: {joint: elbow}, set: {range: [-45, 30]}}, {select: {joint: elbow}, set: {'range[0]': '${value + 5deg}', 'range[1]': '${value - 10deg}'}}"
    model = arm.edited(edits, own, "angle: degree\n")
    assert model.joint("elbow").range == pytest.approx(np.radians([-40, 20]), abs=1e-12)
    doubled = "{select: {joint: shoulder}, set: {range: ['${value - 10deg}', '${value}']}}"
    now = arm.model("recipe: 1\nbase: ./arm.xml\n").joint("shoulder").range
    model = arm.edited(doubled, own, "angle: degree\n")
    assert model.joint("shoulder").range == pytest.approx(now - np.radians([10, 0]), abs=1e-12)


def test_without_a_unit_in_the_recipe_values_have_their_own(arm: Case) -> None:
    now = arm.model("recipe: 1\nbase: ./arm.xml\n").joint("shoulder").range
    model = arm.edited("{select: {joint: shoulder}, set: {range: ['${value / 2}rad', '${value / 2}']}}")
    assert model.joint("shoulder").range == pytest.approx(now / 2, abs=1e-12)
    assert arm.told("{select: {joint: shoulder}, set: {range: ['${value}', 1]}}") == ["59 bare-angle"]


def test_degrees_where_mujoco_has_them(radian: Case) -> None:
    eye = "add: [{to: world, camera: {name: eye, fovy: 40}}, {to: world, light: {name: lamp, cutoff: 30}}]\n"
    model = radian.edited(
        "{select: {camera: '*', where: {fovy: 40deg}}, set: {fovy: '${value + 0.1rad}'}}, {select: {light: lamp}, set: {cutoff: '${value + 10deg}'}}",
        head=eye,
    )
    assert model.camera("eye").fovy[0] == pytest.approx(40 + np.degrees(0.1))
    assert model.light("lamp").cutoff[0] == pytest.approx(40)

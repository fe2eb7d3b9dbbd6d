"""The mass of a body in an edit: its whole inertia follows."""

from __future__ import annotations

from pathlib import Path

import pytest
from compose.arm import RADIANS, Case


@pytest.mark.parametrize("body", ["link1", "link2", "tray", "base"])
def test_a_mass_is_the_whole_inertia(radian: Case, body: str) -> None:
    before = radian.model("recipe: 1\nbase: ./arm.xml\n").body(body)
    for verb, value, factor in (
        ("scale", 1.25, 1.25),
        ("set", 3, 3 / before.mass[0]),
        ("offset", 0.5, 1 + 0.5 / before.mass[0]),
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

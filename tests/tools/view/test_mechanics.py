"""The physics of the selected element on a page, with the lines that wrote it; MuJoCo is the judge."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import pytest
from mjcompose.mujoco.engine import Session
from tools.view.pages import page_of

pytestmark = pytest.mark.slow
MODEL = """<mujoco model="arm">
  <default>
    <joint damping="0.5"/>
    <default class="grip"><geom friction="1.5 0.01 0.002" solref="-900 -30"/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1" friction="0.7"/>
    <geom name="ice" type="box" size="0.1 0.1 0.1" pos="0.05 0 0" friction="0.05" priority="1"/>
    <body name="upper">
      <joint name="elbow" axis="0 1 0" range="-1 1" limited="true" actuatorfrcrange="-20 20" actuatorfrclimited="true"/>
      <geom name="pad" class="grip" size="0.1" mass="2"/>
      <body name="lower" pos="0 0 0.03"><joint name="lift" type="slide" stiffness="50"/><geom name="tip" size="0.1" mass="1"/></body>
    </body>
    <body name="other" pos="0.04 0 0"><freejoint/><geom name="ball" size="0.1"/></body>
  </worldbody>
  <contact><exclude body1="lower" body2="other"/></contact>
  <actuator><position name="servo" joint="elbow" kp="100" kv="4" gear="3" forcerange="-5 5"/></actuator>
</mujoco>
"""
RECIPE = """recipe: 1
base: ./arm.xml
edit:
  - {select: {joint: elbow}, set: {armature: 0.02}}
"""


def facts(page: Any, kind: str, name: str) -> dict[str, str]:
    page.evaluate(
        "([kind, name]) => mjcompose.select({kind, index: mjcompose.world.model.scene[kind].name.indexOf(name)}, true)",
        [kind, name],
    )
    found: dict[str, str] = page.evaluate(
        "Object.fromEntries([...document.querySelectorAll('.mechanics dt')].map(each =>"
        " [each.textContent, each.nextElementSibling.textContent]))"
    )
    return found


@pytest.fixture
def page(tmp_path: Path, open_page: Callable[..., Any]) -> Any:
    (tmp_path / "arm.xml").write_text(MODEL)
    (tmp_path / "arm.yaml").write_text(RECIPE)
    with Session() as session:
        return open_page(page_of("arm.yaml", tmp_path, session).as_uri())


def test_a_joint_tells_its_physics_with_the_lines_that_wrote_it(page: Any) -> None:
    elbow = facts(page, "joint", "elbow")
    assert elbow["damping"] == "0.5 N·m·s/rad arm.xml:3", "a default class wrote it"
    assert elbow["armature"] == "0.02 kg·m² arm.yaml:4", "and an edit this"
    assert elbow["dry friction"] == "0 N·m"
    assert elbow["limit"] == "time constant 0.02 s, damping ratio 1"
    assert elbow["stiffness"] == "900 N·m/rad by servo arm.xml:17", "the gear counts twice"
    assert elbow["servo damping"] == "36 N·m·s/rad by servo arm.xml:17"
    assert elbow["effort"] == "± 15 N·m by servo arm.xml:17"
    text = page.locator(".mechanics").inner_text()
    assert "± 20 N·m" in text and "arm.xml:10" in text
    lift = facts(page, "joint", "lift")
    assert lift["spring"] == "50 N/m, at rest at 0 m arm.xml:12" and lift["damping"].startswith("0.5 N·s/m")
    assert facts(page, "body", "upper")["with all below"] == "3 kg"
    servo = facts(page, "actuator", "servo")
    assert servo["gear"] == "3 arm.xml:17" and servo["stiffness"] == "900 N·m/rad at the joint arm.xml:17"


def test_the_friction_that_acts_is_the_one_of_mujoco(page: Any) -> None:
    assert facts(page, "geom", "pad")["contact"] == "stiffness 900 1/s², damping 30 1/s arm.xml:4"
    assert facts(page, "geom", "pad")["friction"] == "sliding 1.5 arm.xml:4"
    model = mujoco.MjModel.from_xml_string(MODEL)
    names = [model.geom(each).name for each in range(model.ngeom)]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)  # all geoms are in each other
    expected = {tuple(names[geom] for geom in each.geom): round(float(each.friction[0]), 6) for each in data.contact}
    shown = {}
    for name in names:
        page.evaluate("i => mjcompose.select({kind: 'geom', index: i}, true)", names.index(name))
        rows = page.locator(".touches dt").all()
        for row in rows:
            other = row.evaluate("each => each.nextElementSibling.querySelector('a').textContent")
            shown[name, other] = float(row.inner_text())
    assert len(expected) == 7, "the floor and the ice do not touch, nor do a body and its parent, nor an excluded pair"
    assert shown == expected | {(other, one): value for (one, other), value in expected.items()}
    assert "by priority" in page.evaluate(
        "(() => { mjcompose.select({kind: 'geom', index: 2}, true); return document.querySelector('.touches').textContent; })()"
    )

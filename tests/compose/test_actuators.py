"""Which controls are angles: what is read from the tree against what MuJoCo has compiled."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose.base.sink import Sink
from mjcompose.compose.actuators import ControlUnits
from mjcompose.link.linking import Linking
from mjcompose.link.measure import measure_with
from mjcompose.mujoco import controls
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tree.parse import parse_file

WORDS = {"rad": "an angle", "rad/s": "an angular velocity"}
MODEL = """
<mujoco><default>
  <default class="servo"><general biastype="affine" gainprm="20" biasprm="0 -20 -1"/>
    <default class="weaker"><general gainprm="7" biasprm="0 -7"/></default></default>
  <default class="rate"><general dyntype="integrator"/></default>
  <default class="mixed"><position kp="5"/></default>
  <default class="geared"><general gear="3"/></default>
  </default>
  <worldbody><body><joint name="hinge"/><geom size=".1"/><body><joint name="slide" type="slide"/><geom size=".1"/>
    <body><joint name="ball" type="ball"/><geom size=".1"/></body></body></body></worldbody>
  <tendon><fixed name="sum"><joint joint="hinge" coef="1"/></fixed></tendon>
  <actuator>{}</actuator></mujoco>
"""
ACTUATORS = [
    '<motor joint="hinge"/>',
    '<position joint="hinge" kp="3"/>',
    '<position joint="hinge"/>',
    '<position jointinparent="hinge" kp="3" kv="1"/>',
    '<position joint="hinge" kp="3" timeconst=".1"/>',
    '<position joint="hinge" kp="3" gear="2"/>',
    '<position joint="hinge" kp="3" gear="-1"/>',
    '<position joint="hinge" class="geared"/>',
    '<position joint="hinge" class="servo"/>',
    '<position joint="hinge" class="rate"/>',
    '<position joint="slide"/>',
    '<position joint="ball"/>',
    '<velocity joint="hinge" kv="3"/>',
    '<velocity joint="hinge" class="servo"/>',
    '<velocity joint="slide" kv="3"/>',
    '<intvelocity joint="hinge" kp="3" actrange="-1 1"/>',
    '<damper joint="hinge" kv="3" ctrlrange="0 1"/>',
    '<muscle joint="hinge" lengthrange="0 1"/>',
    '<cylinder joint="hinge" timeconst="1"/>',
    '<general joint="hinge"/>',
    '<general joint="hinge" class="servo"/>',
    '<general joint="hinge" class="weaker"/>',
    '<general joint="hinge" class="mixed"/>',
    '<general joint="hinge" class="servo" gainprm="3"/>',
    '<general joint="hinge" biastype="affine" gainprm="3" biasprm="0 -3"/>',
    '<general joint="hinge" biastype="affine" gainprm="3" biasprm="0 0 -3"/>',
    '<general joint="hinge" biastype="affine" gainprm="3" biasprm="1 -3"/>',
    '<general joint="hinge" gainprm="3" biasprm="0 -3"/>',
    '<general joint="hinge" class="servo" dyntype="filter" dynprm="1"/>',
    '<general joint="hinge" class="servo" dyntype="integrator"/>',
]


def units_of(folder: Path, text: str, session: Session | None = None) -> ControlUnits:
    (folder / "model.xml").write_text(text)
    sink = Sink()
    unit = parse_file(folder / "model.xml", sink)
    assert unit is not None
    measure = measure_with(Context(environment={}, folder=folder), session=session) if session else None
    linking = Linking(unit, [], sink, measure=measure)
    return ControlUnits(linking, sink, {"hinge": "hinge", "slide": "slide", "ball": "ball"})


@pytest.mark.parametrize("actuator", ACTUATORS)
def test_the_tree_says_what_mujoco_says(tmp_path: Path, actuator: str) -> None:
    text = MODEL.format(actuator)
    model = mujoco.MjModel.from_xml_string(text)
    with Session() as session:  # MuJoCo is asked only where classes reach into an actuator
        found = units_of(tmp_path, text, session)
        meant = found.of(found.linking.base.root.find("actuator")[0])
    wanted = WORDS.get(controls.of_control(model, mujoco, 0) or "")
    assert (*meant.controls, None)[0] == wanted
    assert ("_measured" in found.__dict__) == ('"mixed"' in actuator or '"rate"' in actuator)


def test_a_tendon_has_no_angles(tmp_path: Path) -> None:
    found = units_of(tmp_path, MODEL.format('<position tendon="sum" kp="3"/>'))
    assert found.of(found.linking.base.root.find("actuator")[0]).controls == ()


@pytest.mark.parametrize(
    ("actuator", "activation"),
    [
        ('<position joint="hinge" kp="3" timeconst=".1"/>', "an angle"),
        ('<intvelocity joint="hinge" kp="3" actrange="-1 1"/>', "an angle"),
        ('<general joint="hinge" class="servo" dyntype="filter" dynprm="1"/>', "an angle"),
        ('<general joint="hinge" dyntype="integrator"/>', None),
    ],
)
def test_activations(tmp_path: Path, actuator: str, activation: str | None) -> None:
    found = units_of(tmp_path, MODEL.format(actuator))
    assert found.of(found.linking.base.root.find("actuator")[0]).activation == activation


@pytest.mark.mujoco4("`pid` is new in MuJoCo 4")
def test_each_control_of_a_pid(tmp_path: Path) -> None:
    with Session() as session:
        found = units_of(tmp_path, MODEL.format('<pid joint="hinge" kp="3" kv="1" input="pos vel ff"/>'), session)
        meant = found.of(found.linking.base.root.find("actuator")[0])
    assert meant.controls == ("an angle", "an angular velocity", None)

from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import linted
from mjcompose.mujoco.engine import Session

DOOR = """\
<mujoco model="door">
  <compiler angle="radian"/>
  <worldbody>
    <body name="frame"><joint name="swivel" type="ball"/><geom size="0.1"/></body>
    <body name="door" pos="1 0 0"><joint name="hinge" axis="0 0 1" range="-1 2"/><geom size="0.1"/></body>
  </worldbody>
  <actuator>{actuator}</actuator>
  <keyframe><key name="open" qpos="1 0 0 0 0.8" ctrl="{ctrl}"/></keyframe>
</mujoco>
"""


@pytest.mark.parametrize("transmission", ["joint", "jointinparent"])
@pytest.mark.parametrize("gear", [1, 2.5, -1, -4])
def test_a_key_is_judged_at_its_joint(tmp_path: Path, session: Session, transmission: str, gear: float) -> None:
    servo = f'<position name="opener" {transmission}="hinge" gear="{gear}" kp="9"/>'
    holds = DOOR.format(actuator=servo, ctrl=0.8 * gear)
    assert not linted(holds, "key-does-not-hold", tmp_path, session)
    (found,) = linted(DOOR.format(actuator=servo, ctrl=0.3 * gear), "key-does-not-hold", tmp_path, session)
    assert found.message == "in keyframe `open` actuator `opener` aims at 0.3, and joint `hinge` is at 0.8"


@pytest.mark.mujoco4("its other actuators have one control and one output each")
def test_the_controls_of_other_actuators_come_first(tmp_path: Path, session: Session) -> None:
    others = '<orientation name="turn" joint="swivel" kp="1"/><pid name="p" joint="hinge" input="vel ff" kv="1"/>'
    servo = '<position name="opener" joint="hinge" gear="-2" kp="9" ctrlrange="-2 1"/>'
    text = DOOR.format(actuator=others + servo, ctrl="0 0 0 0 0 -1")
    (found,) = linted(text, "key-does-not-hold", tmp_path, session)
    assert found.message.endswith("aims at 0.5, and joint `hinge` is at 0.8")
    (found,) = linted(text, "control-misses-range", tmp_path, session)
    assert "aim from -0.5 to 1, " in found.message and found.help == 'write `ctrlrange="-4 2"`'
    assert not linted(text.replace('ctrlrange="-2 1"', 'ctrlrange="-4 2"'), "control-misses-range", tmp_path, session)
    assert not linted(text, "dead-actuator", tmp_path, session)


def test_the_control_of_an_integrator_is_no_position(tmp_path: Path, session: Session) -> None:
    rate = '<intvelocity name="opener" joint="hinge" kp="9" actrange="-3 3"/>'
    assert not linted(DOOR.format(actuator=rate, ctrl="0.1"), "key-does-not-hold", tmp_path, session)

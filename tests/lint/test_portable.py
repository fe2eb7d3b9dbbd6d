from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import linted
from mjcompose.lint.rule import chosen, rules
from mjcompose.mujoco.engine import Session
from mjcompose.targets.table import TARGETS

ROBOT = """<mujoco><default><joint {0}/></default><worldbody>{1}<body name="link">
  <joint name="elbow"/><geom size=".1"/></body></worldbody>{2}</mujoco>"""


def robot(joint: str = "", world: str = "", after: str = "") -> str:
    return ROBOT.format(joint, world, after)


MOTOR = '<actuator><{} name="motor" joint="elbow"/></actuator>'
CASES = [
    ("unread-by-mjx", robot(after='<option solver="PGS"/>'), robot(), "no solver `pgs`"),
    ("unread-by-warp", robot(after='<option solver="PGS"/>'), robot(), "no solver `pgs`"),
    ("unread-by-drake", robot('frictionloss=".1"'), robot(), "Drake ignores dry friction of 1 joint: `elbow`"),
    ("unread-by-drake", robot(after=MOTOR.format("damper ctrlrange='0 1'")), robot(after=MOTOR.format("motor")), "1 actuator: `motor`"),
    ("unread-by-drake", robot(world="<light/>"), robot(after=MOTOR.format("general")), "Drake ignores 1 light"),
    ("unread-by-newton", robot(world='<body><joint type="free" damping="1"/><geom size="1" pos="9 9 9"/></body>'),
     robot(world='<body><freejoint/><geom size="1" pos="9 9 9"/></body>'), "Newton ignores damping of 1 joint"),
    ("unread-by-pinocchio", robot(world='<camera name="eye"/>'), robot(), "1 camera: `eye`"),
    ("unread-by-pybullet", robot('damping="2"'), robot(), "PyBullet ignores damping of 1 joint: `elbow`"),
    ("unread-by-genesis", robot(after='<keyframe><key name="home"/></keyframe>'), robot(), "1 keyframe: `home`"),
    ("unread-by-isaac", robot(after='<custom><text name="a" data="b"/></custom>'), robot(), "Isaac Sim ignores"),
    ("unread-by-urdf", robot('stiffness="3"'), robot(), "stiffness of 1 joint"),
    ("newer-mujoco", robot(after='<actuator><position joint="elbow" dampratio="1"/></actuator>'), robot(),
     "`dampratio` of `<position>`: MuJoCo has it since 3.1.6"),
]  # fmt: skip


@pytest.mark.parametrize(("code", "wrong", "right", "words"), CASES)
def test_a_loss_is_found_and_a_near_model_is_not(
    code: str, wrong: str, right: str, words: str, tmp_path: Path, session: Session
) -> None:
    found = linted(wrong, code, tmp_path, session)
    assert [each.message for each in found if words in each.message], found
    assert not linted(right, code, tmp_path, session)


def test_every_target_with_limits_has_a_rule_that_runs_only_if_selected() -> None:
    programs = {name for name, target in TARGETS.items() if target.limits}
    assert {f"unread-by-{name}" for name in programs} == {code for code in rules() if code.startswith("unread-by-")}
    assert not {each.family for each in chosen()} & {"portable"}

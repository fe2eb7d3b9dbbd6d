from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import check_case, linted, mended
from mjcompose.mujoco.engine import Session

FLOOR = '<geom name="floor" type="plane" size="1 1 1"/>'
BALL = '<body pos="0 0 {}"><freejoint/><geom name="ball" size=".1"/></body>'
KEY = '<keyframe><key name="home" qpos="0 0 {} 1 0 0 0"/></keyframe>'
CHAIN = """<body name="base"><freejoint/><geom name="b" size=".1"/><body name="arm" pos=".3 0 0"><joint/><geom size=".1"/>
  <body name="hand" pos="{} 0 0"><joint/><geom name="h" size=".1"/></body></body></body>"""
SPHERE = """<mujoco><asset><mesh name="m" builtin="sphere" params="{}"/></asset>
  <worldbody><body><joint/><geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


def world(inside: str, after: str = "") -> str:
    return f"<mujoco><worldbody>{inside}</worldbody>{after}</mujoco>"


def exclude(one: str, other: str) -> str:
    return f'<contact><exclude body1="{one}" body2="{other}"/></contact>'


def foot(condim: str, friction: str = "") -> str:
    geoms = f'<default><geom condim="{condim}" {friction}/></default>'
    return world(FLOOR + BALL.format(1).replace("ball", "left_foot")).replace("<mujoco>", f"<mujoco>{geoms}")


def boxes(one: str, other: str) -> str:
    return world(f'<body><freejoint/><geom name="a" size=".1" {one}/><geom name="b" size=".1" {other}/></body>')


CLASS = '<mujoco><default><default class="visual"><geom group="2" {}/></default></default><worldbody><body><freejoint/>\
<geom name="collision" size=".1"/><geom class="visual" size=".1" pos="1 0 0"/></body></worldbody></mujoco>'
CASES = [
    ("overlap", world(FLOOR + BALL.format(1), KEY.format(0.09)), world(FLOOR + BALL.format(1), KEY.format(0.097)),
     "in keyframe `home`, geom `floor` is 10 mm inside geom `ball`"),
    ("overlap", world(CHAIN.format(-0.15)), world(CHAIN.format(-0.09)), "in the reference configuration, geom `b`"),
    ("overlap", world(CHAIN.format(-0.15)), world(CHAIN.format(-0.15), exclude("base", "hand")), ""),
    ("plane-hidden", world(FLOOR + FLOOR.replace("floor", "two")), world(FLOOR), "geom `two` is at the same height as"),
    ("plane-hidden", world(FLOOR + '<geom type="plane" size="1 1 1" pos="0 0 .7"/>'),
     world(FLOOR + '<geom type="plane" size="1 1 1" pos="0 0 .7" contype="0" conaffinity="0"/>'), "is 0.7 m below"),
    ("plane-hidden", world(FLOOR + FLOOR.replace("floor", "two")),
     world(FLOOR + '<geom type="plane" size="1 1 1" zaxis="1 0 0"/>'), "an infinite plane"),
    ("visual-collides", CLASS.format(""), CLASS.format('contype="0" conaffinity="0"'), "says that it is visual"),
    ("collides-with-nothing", boxes('contype="4" conaffinity="8"', 'contype="2"'),
     boxes('contype="4" conaffinity="8"', 'contype="8"'), "`contype` 4 and `conaffinity` 8 of geom `a` fit no other"),
    ("hull-too-fine", SPHERE.format(4), SPHERE.format(3), "mesh `m`, which collides, has 2,562 vertices"),
    ("geom-twice", boxes("", ""), boxes("", 'pos="1 0 0"'), "geom `b` is the same as geom `a`, and both collide"),
    ("geom-twice", boxes("", ""), boxes("", 'contype="0" conaffinity="0"'), ""),
    ("frictionless-foot", foot("1"), foot("3"), "geom `left_foot` slides on geom `floor`: `condim` is 1"),
    ("frictionless-foot", foot("3", 'friction="0"'), foot("3"), "the sliding friction is 0"),
    ("exclude-needless", world(CHAIN.format(0.3), exclude("base", "arm")),
     world(CHAIN.format(0.3), exclude("base", "hand")), "one is the parent of the other"),
]  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_fault_is_found_and_a_near_model_is_not(
    case: tuple[str, str, str, str], tmp_path: Path, session: Session
) -> None:
    check_case(case, tmp_path, session)


def test_a_needless_exclude_is_removed(tmp_path: Path, session: Session) -> None:
    text = world(CHAIN.format(0.3), exclude("arm", "hand"))
    assert "<exclude" not in mended(text, linted(text, "exclude-needless", tmp_path, session))


def test_a_base_that_others_mount_may_touch_its_first_link(tmp_path: Path, session: Session) -> None:
    gripper = '<body><geom size=".1"/><body pos=".1 0 0"><joint/><geom size=".1"/></body></body>'
    assert not linted(world(gripper), "overlap", tmp_path, session)
    assert linted(world(FLOOR.replace("/>", ' pos="0 0 -9"/>') + gripper), "overlap", tmp_path, session)


def test_a_pose_out_of_range_and_empty_keyframes_do_not_count(tmp_path: Path, session: Session) -> None:
    folded = world(CHAIN.format(-0.15))
    assert linted(folded, "overlap", tmp_path, session)
    assert not linted(folded.replace("<joint/>", '<joint range="10 90"/>', 1), "overlap", tmp_path, session)
    empty = world(FLOOR + BALL.format(0.05)).replace("<mujoco>", '<mujoco><size nkey="2"/>')
    assert not linted(empty, "overlap", tmp_path, session)

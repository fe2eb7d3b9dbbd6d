from __future__ import annotations

import mujoco

from composer.compiled.kinds import NameTable
from composer.diff.renames import renames

HAND = """<mujoco><worldbody>
  <body name="gripper/palm"><geom name="gripper/palm" size="0.1"/>
    <body name="gripper/finger"><joint name="gripper/finger"/><geom name="gripper/pad" size="0.2"/></body></body>
  <body name="stand"><geom name="stand" size="0.3"/></body>
</worldbody></mujoco>"""


def _roster(text: str) -> NameTable:
    return NameTable(mujoco.MjModel.from_xml_string(text))


def test_a_prefix() -> None:
    found = renames(_roster(HAND), _roster(HAND.replace("gripper/", "hand/")))
    assert found == {
        "body": {"gripper/palm": "hand/palm", "gripper/finger": "hand/finger"},
        "joint": {"gripper/finger": "hand/finger"},
        "geom": {"gripper/palm": "hand/palm", "gripper/pad": "hand/pad"},
    }


def test_a_prefix_of_a_part_that_changed_too() -> None:
    other = HAND.replace("gripper/", "hand/").replace('size="0.2"', 'size="0.25"')
    assert renames(_roster(HAND), _roster(other))["geom"]["gripper/pad"] == "hand/pad"


def test_single_elements_that_are_alike() -> None:
    assert renames(_roster(HAND), _roster(HAND.replace('"stand"', '"pedestal"'))) == {
        "body": {"stand": "pedestal"},
        "geom": {"stand": "pedestal"},
    }


def test_what_changed_is_another_one() -> None:
    other = HAND.replace('name="stand" size="0.3"', 'name="post" size="0.4"')
    assert renames(_roster(HAND), _roster(other)) == {}


def test_two_that_are_alike_are_not_guessed() -> None:
    two = HAND.replace(
        "</worldbody>", '<body name="b"><geom name="b" size="1"/></body><body name="c"/></worldbody>'
    )
    twins = two.replace('<body name="c"/>', '<body name="c"><geom name="c" size="1"/></body>')
    assert renames(_roster(twins), _roster(twins.replace('"b"', '"x"').replace('"c"', '"y"'))) == {}

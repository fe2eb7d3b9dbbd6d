from __future__ import annotations

import math

import mujoco
import pytest
from mjcompose.contrast.models import relative_to_value, renames
from mjcompose.mujoco.attributes import NameTable

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
    two = HAND.replace("</worldbody>", '<body name="b"><geom name="b" size="1"/></body><body name="c"/></worldbody>')
    twins = two.replace('<body name="c"/>', '<body name="c"><geom name="c" size="1"/></body>')
    assert renames(_roster(twins), _roster(twins.replace('"b"', '"x"').replace('"c"', '"y"'))) == {}


def test_of_two_that_look_alike_neither_is_guessed() -> None:
    pair = """<mujoco><worldbody><body name="b"><geom name="{}" size="1"/><geom name="{}" size="{}"/></body></worldbody></mujoco>"""
    before = pair.format("one", "two", "1")
    after = pair.format("three", "four", "1")
    assert renames(_roster(before), _roster(after)) == {}
    assert renames(_roster(pair.format("one", "two", "1")), _roster(pair.format("one", "four", "1"))) == {
        "geom": {"two": "four"}
    }
    # One that is left of two, and two that one may have become.
    assert renames(_roster(pair.format("one", "two", "1")), _roster(pair.format("three", "four", "2"))) == {}
    assert renames(_roster(pair.format("one", "two", "2")), _roster(pair.format("three", "four", "1"))) == {}


@pytest.mark.parametrize(
    ("a", "b", "are_close"),
    [
        (1e-3, 1.001e-3, False),
        (1e-3, 1.00001e-3, True),
        (1000, 1000.05, True),
        (1000, 1001, False),
        (1e-9, -1e-9, False),
        (1e-11, -1e-11, True),
        (0.0, 9e-11, True),
        (0.0, 2e-9, False),
        (math.nan, math.nan, True),
        (math.nan, 1, False),
        (math.inf, math.inf, True),
        (-math.inf, math.inf, False),
        (math.inf, 1, False),
        (1, math.inf, False),
    ],
)
def test_a_tolerance_is_relative_down_to_a_millionth(a: float, b: float, are_close: bool) -> None:
    assert relative_to_value(1e-4).allows(a, b) == are_close

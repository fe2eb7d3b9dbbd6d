"""What a program reads is compared number by number."""

from __future__ import annotations

import json
import math
from dataclasses import asdict

import mujoco
import pytest
from mjcompose.targets.judge import (
    MotionQuestion,
    ReadingQuestion,
    asked_of,
    differences,
    drives_of,
    facts_of,
    questions,
    without_lost,
)
from mjcompose.targets.target import FeatureOutcome, Loss
from targets.models import PROBE

ASKED = asked_of(mujoco, mujoco.MjModel.from_xml_string(PROBE), 3)


def told(*losses: Loss, text: str = PROBE, single: bool = False, **changed: float) -> list[str]:
    """The differences of a program that is MuJoCo itself, with some arrays multiplied."""
    truth, read = (mujoco.MjModel.from_xml_string(text) for _ in range(2))
    for name, factor in changed.items():
        values = getattr(read, name)
        values[:] = values * factor
    facts = facts_of(mujoco, read, ASKED)
    return [each.message for each in differences(mujoco, truth, facts, ASKED, losses, single=single)]


@pytest.mark.parametrize(
    ("array", "expected"),
    [
        ("body_mass", "the mass of `base` is 16, not 8"),
        ("body_inertia", "the inertia of `base` is 0.106667 "),
        ("body_ipos", "the center of mass of `b4` is at 0.075"),
        ("body_pos", "the pose of `"),
        ("dof_damping", "the damping of the joint `j1` is 1, not 0.5"),
        ("dof_frictionloss", "the dry friction of the joint `j1` is 0.1, not 0.05"),
        ("dof_armature", "the armature of the joint `j1` is 0.04, not 0.02"),
        ("jnt_stiffness", "the stiffness of the joint `j3` is 4, not 2"),
        ("jnt_range", "the limits of the joint `j1` is -2.0944 2.0944, not -1.0472 1.0472"),
        ("jnt_actfrcrange", "the greatest force of the joint `j1` is -14 14, not -7 7"),
        ("actuator_biasprm", "the stiffness (`kp`) of the actuator `a2` is 100, not 50"),
        ("actuator_gear", "the stiffness (`kp`) of the actuator `a4` is 8000, not 2000"),
        ("actuator_ctrlrange", "the greatest force of the actuator `a1` is -12 18, not -12 15"),
        ("actuator_forcerange", "the greatest force of the actuator `a2` is -7 7, not -3.5 3.5"),
        ("geom_type", "there are 1 geoms of the type `box`, not 5"),
        ("actuator_ctrlrange", "the range of the control of the actuator `a2` is -2 2, not -1 1"),
        ("actuator_gear", "under full control the force of the joint `j4` is "),
        ("actuator_gainprm", "after 0.2 s of motion under control the joint `j"),
        ("qpos_spring", "after 0.2 s of motion the joint `j3` is at "),
    ],
)
def test_each_number_is_compared(array: str, expected: str) -> None:
    found = told(**{array: 9.0 if array == "qpos_spring" else 2.0})
    assert any(each.startswith(expected) for each in found), found


def test_nothing_is_told_of_the_same_model() -> None:
    assert told() == told(single=True) == []


@pytest.mark.parametrize(
    ("loss", "array"),
    [
        (Loss("damping", "joint", 0, "joint", "j1", what="damping"), "dof_damping"),
        (Loss("friction", "joint", 0, "joint", "j1", what="dry friction"), "dof_frictionloss"),
        (Loss("springs", "joint", 2, "joint", "j3", what="stiffness"), "jnt_stiffness"),
    ],
    ids=lambda each: each if isinstance(each, str) else each.feature,
)
def test_what_is_lost_is_not_compared_nor_moved(loss: Loss, array: str) -> None:
    """Of one joint; that of the others is."""
    others = [each.split("`")[1] for each in told(loss, **{array: 0.0}) if "joint" in each and "motion" not in each]
    assert loss.name not in others
    only = PROBE.replace(' damping=".3"', "").replace(' damping=".1"', "").replace(' damping="3"', "")
    only = only.replace(' frictionloss=".2"', "")
    assert told(loss, text=only, **{array: 0.0}) == []


def test_what_an_actuator_loses_is_still_that_of_the_joint_of_its_number() -> None:
    assert told(Loss("damping", "actuator", 0, "motor", "a1", what="damping")) == []


def test_a_motion_that_does_not_end_in_numbers() -> None:
    truth = mujoco.MjModel.from_xml_string(PROBE)
    facts = facts_of(mujoco, truth, ASKED)
    facts["motion"]["j2"] = math.nan
    (found,) = [each.message for each in differences(mujoco, truth, facts, ASKED, single=True)]
    assert found.startswith("after 0.2 s of motion the joint `j2` is at nan, not at ")


def test_no_limit_may_be_written_as_none_on_both_sides() -> None:
    truth = mujoco.MjModel.from_xml_string(PROBE)
    facts = facts_of(mujoco, truth, ASKED)
    without = [each for each in facts["joints"].values() if each["range"] is None]
    for each in without:
        each["range"] = [None, None]
    assert without and list(differences(mujoco, truth, facts, ASKED, single=False)) == []
    facts["joints"]["j1"]["range"] = None
    assert len(list(differences(mujoco, truth, facts, ASKED, single=False))) == 1


def test_a_motion_begins_at_the_home_key() -> None:
    """At the first key if none has that name, else at the reference."""

    def start(*keys: str) -> float:
        rows = "".join(f'<key name="{name}" qpos="{at}"/>' for at, name in enumerate(keys, 1))
        body = '<body><joint name="j"/><geom size=".1"/></body>'
        text = f"<mujoco><worldbody>{body}</worldbody><keyframe>{rows}</keyframe></mujoco>"
        return float(questions(mujoco.MjModel.from_xml_string(text), 0)["home"]["joints"]["j"][0])

    assert (start("a", "home", "b"), start("a", "b"), start()) == (2, 1, 0)


def test_a_joint_that_is_missing() -> None:
    truth = mujoco.MjModel.from_xml_string(PROBE)
    facts = facts_of(mujoco, truth, ASKED)
    del facts["joints"]["j2"], facts["bodies"]["b2"], facts["actuators"]["a5"]
    found = [each.message for each in differences(mujoco, truth, facts, ASKED, single=False)]
    assert found == [
        "the body `b2` is missing",
        "the joint `j2` is missing",
        "the actuator `a5` is missing",
    ]


DRIVEN = """<mujoco><worldbody>
  <body name="a"><joint name="a" axis="0 1 0" damping="1"/><geom size=".1" pos=".2 0 0"/></body>
  <body name="b" pos="1 0 0"><joint name="b" type="slide" axis="0 0 1" damping="1"/><geom size=".1"/></body></worldbody>
  <actuator>
    <motor name="motor" joint="a" gear="-3" ctrlrange="-1 2"/>
    <position name="servo" joint="b" gear="4" kp="5" kv=".5" ctrlrange="-2 2"/>
    <general name="lag" joint="a" dyntype="filter" dynprm="0.1"/>
  </actuator></mujoco>"""


def test_full_control_is_that_of_the_joint() -> None:
    model = mujoco.MjModel.from_xml_string(DRIVEN)
    drives = drives_of(mujoco, model, questions(model, 0))["drives"]
    assert {name: (each["input"], each["full"]["at_joint"]) for name, each in drives.items()} == {
        "motor": ("force", -6),
        "servo": ("position", 0.5),
    }
    forces = facts_of(mujoco, model, asked_of(mujoco, model, 0))["forces"]
    assert forces == {"a": pytest.approx(-6), "b": pytest.approx(4 * 5 * 2)}


@pytest.mark.parametrize(
    ("loss", "left"),
    [
        (Loss("actuators", "actuator", 0, "motor", "motor"), {"servo"}),
        (Loss("gears", "actuator", 1, "position", "servo", what="`gear`"), {"motor"}),
        (Loss("gears", "actuator", 1, "position", "servo", outcome=FeatureOutcome.WRITTEN), {"motor", "servo"}),
        (Loss("effort", "joint", 0, "joint", "a"), {"servo"}),
        (Loss("gains", "actuator", 1, "position", "servo", what="`kv`"), {"motor", "servo"}),
    ],
)
def test_lost_actuators_do_not_drive(loss: Loss, left: set[str]) -> None:
    model = mujoco.MjModel.from_xml_string(DRIVEN)
    asked = without_lost(asked_of(mujoco, model, 0), [loss])
    assert set(asked["drives"]) == left
    forces = facts_of(mujoco, model, asked)["forces"]
    assert {name for name, force in forces.items() if force} == {{"motor": "a", "servo": "b"}[each] for each in left}


def test_a_gain_that_is_written_otherwise_is_compared() -> None:
    """A gear that a target writes into the gains is no excuse for other gains."""
    loss = Loss("gears", "actuator", 3, "position", "a4", outcome=FeatureOutcome.WRITTEN)
    assert any("`kp`) of the actuator `a4`" in each for each in told(loss, actuator_gear=2.0))


def test_a_motion_that_depends_on_the_step_is_not_compared() -> None:
    """A servo that is too stiff for its step moves otherwise in each program; its forces are still compared."""
    model = mujoco.MjModel.from_xml_string(DRIVEN.replace('kp="5"', 'kp="1e8"'))
    asked = asked_of(mujoco, model, 0)
    assert not asked["eases"]
    facts = facts_of(mujoco, model, asked)
    assert facts["forces"]["b"] == pytest.approx(4 * 1e8 * 2) and "driven" not in facts
    assert asked_of(mujoco, mujoco.MjModel.from_xml_string(DRIVEN), 0)["eases"]


def test_questions_come_to_the_child_process_whole() -> None:
    losses = [Loss("damping", "joint", 1, tag="joint", name="elbow", why="it has none", help="leave it out")]
    asked = {"poses": [], "seconds": 0.2}
    for sent in (ReadingQuestion({"bodies": {}}, asked, True, losses), MotionQuestion(asked, losses, ["friction"])):
        assert type(sent).of(json.loads(json.dumps(asdict(sent)))) == sent

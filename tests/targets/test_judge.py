"""What a program reads is compared number by number."""

from __future__ import annotations

import math

import mujoco
import pytest
from mjcompose.targets.judge import differences, facts_of, questions
from mjcompose.targets.target import Loss
from targets.models import PROBE

ASKED = questions(mujoco.MjModel.from_xml_string(PROBE), 3)


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
        "the body `b2` is missing", "the joint `j2` is missing", "the actuator `a5` is missing",
    ]  # fmt: skip

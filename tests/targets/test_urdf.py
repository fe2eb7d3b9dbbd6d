"""URDF: MuJoCo reads the same robot; what ROS needs is there."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.build.bundle.staging import write_folder
from mjcompose.targets.judge import differences, facts_of, questions
from mjcompose.targets.target import Loss
from targets.models import SELDOM
from targets.writing import written

SETTINGS = '<mujoco><compiler fusestatic="false" discardvisual="false" strippath="false"/></mujoco></robot>'
MASS = ('<mass value="0"/>', '<mass value="1e-12"/>')
"""MuJoCo has no massless links that move."""


def test_mujoco_reads_the_same_robot(tmp_path: Path) -> None:
    bundle, context = written(SELDOM, "urdf", tmp_path)
    assert bundle is not None and not context.sink.has_errors
    write_folder(bundle, tmp_path / "seldom")
    urdf = (tmp_path / "seldom" / "model.urdf").read_text().replace("</robot>", SETTINGS).replace(*MASS)
    urdf = urdf.replace(
        'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"', 'ixx="1e-12" ixy="0" ixz="0" iyy="1e-12" iyz="0" izz="1e-12"'
    )
    truth = mujoco.MjModel.from_xml_string(SELDOM)
    read = mujoco.MjModel.from_xml_string(urdf)
    asked = questions(truth) | {"seconds": 0}  # what follows another joint is stiff in MuJoCo
    facts = facts_of(mujoco, read, asked)
    for joint in facts["joints"].values():  # no limit is an effort of 1000000
        joint.pop("effort")
        joint.pop("force")
    facts.pop("shapes")  # a capsule is three
    losses = [Loss("actuators", "actuator", 0, "actuator", name) for name in ("turn", "slide")]
    assert [each.message for each in differences(mujoco, truth, facts, asked, losses, single=False)] == []


@pytest.mark.parametrize("references", [("0", "0"), ("0.2", "-0.3")])
def test_a_follower_stands_where_mujoco_wants_it(references: tuple[str, str], tmp_path: Path) -> None:
    """`offset` and `multiplier` leave nothing of the constraint of MuJoCo."""
    bodies = "".join(
        f'<body pos="{number} 0 0"><joint name="{name}" ref="{each}"/><geom size=".1"/></body>'
        for number, (name, each) in enumerate(zip("ab", references, strict=True))
    )
    text = f"""<mujoco><compiler angle="radian"/><worldbody>{bodies}</worldbody>
      <equality><joint joint1="a" joint2="b" polycoef="0.1 -0.5"/></equality></mujoco>"""
    bundle, _ = written(text, "urdf", tmp_path)
    assert bundle is not None
    mimic = etree.fromstring(bundle.files["model.urdf"]).find("joint[@name='a']/mimic")
    assert mimic is not None and mimic.get("joint") == "b"
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for angle in (-0.4, 0.7):
        data.joint("b").qpos = angle
        data.joint("a").qpos = float(str(mimic.get("multiplier"))) * angle + float(str(mimic.get("offset")))
        mujoco.mj_forward(model, data)
        assert abs(float(data.efc_pos[0])) < 1e-12


@pytest.mark.parametrize(
    ("joint", "actuators", "effort"),
    [
        ("", '<motor joint="j" gear="-3" forcerange="-4 2"/>', "12"),
        ("", '<motor joint="j" gear="3" ctrlrange="-1 2"/>', "6"),
        ("", '<motor joint="j" forcerange="-4 4"/><position joint="j" kp="2" forcerange="-1 1"/>', "5"),
        ("", '<motor joint="j" forcerange="-4 4"/><position joint="j" kp="2"/>', "1000000"),
        ('actuatorfrcrange="-3 3"', '<motor joint="j" gear="2" forcerange="-4 4"/>', "3"),
        ('actuatorfrcrange="-3 3"', '<motor joint="j"/>', "3"),
        ("", '<position joint="j" kp="2" ctrlrange="-1 1"/>', "1000000"),
    ],
)
def test_effort_is_the_greatest_force_at_the_joint(joint: str, actuators: str, effort: str, tmp_path: Path) -> None:
    text = f"""<mujoco><worldbody><body><joint name="j" {joint}/><geom size=".1"/></body></worldbody>
      <actuator>{actuators}</actuator></mujoco>"""
    bundle, _ = written(text, "urdf", tmp_path)
    assert bundle is not None
    limit = etree.fromstring(bundle.files["model.urdf"]).find("joint[@name='j']/limit")
    assert limit is not None and limit.get("effort") == effort


def test_a_link_without_mass_says_so(tmp_path: Path) -> None:
    """PyBullet gives 1 kg to a link without an inertia."""
    text = "<mujoco><worldbody><body name='hub' pos='0 0 1'><body name='b'><joint/><geom size='.1'/></body></body></worldbody></mujoco>"
    bundle, _ = written(text, "urdf", tmp_path)
    assert bundle is not None
    mass = etree.fromstring(bundle.files["model.urdf"]).find("link[@name='hub']/inertial/mass")
    assert mass is not None and mass.get("value") == "0"


def test_what_ros_needs(tmp_path: Path) -> None:
    bundle, _ = written(SELDOM.replace("<exclude", '<exclude body1="pad" body2="finger_1"/><exclude'), "urdf", tmp_path)
    assert bundle is not None
    robot = etree.fromstring(bundle.files["model.urdf"])
    limit = robot.find("joint[@name='turn']/limit")
    assert limit is not None and limit.get("effort") == "30" and limit.get("velocity") == "1000000"
    mimic = robot.find("joint[@name='bend_0']/mimic")
    assert mimic is not None and dict(mimic.attrib) == {"joint": "bend_1", "multiplier": "0.5", "offset": "0.1"}
    control = robot.find("ros2_control")
    assert control is not None
    assert {each.get("name"): each.find("command_interface").get("name") for each in control.iterfind("joint")} == {  # type: ignore[union-attr]
        "turn": "position",
        "slide": "effort",
    }
    srdf = etree.fromstring(bundle.files["model.srdf"])
    apart = [(each.get("link1"), each.get("link2"), each.get("reason")) for each in srdf.iterfind("disable_collisions")]
    assert ("pad", "finger_1", "Excluded in MuJoCo") in apart and ("stand", "two_joints", "Adjacent") in apart
    state = srdf.find("group_state[@name='home']")
    assert state is not None and [each.get("name") for each in state] == ["turn", "slide", "spin", "bend_0", "bend_1"]
    assert b"<name>recipe</name>" in bundle.files["package.xml"]

"""URDF: MuJoCo reads the same robot; what ROS needs is there."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from lxml import etree
from mjcompose.bundle.bundle import Bundle
from mjcompose.bundle.staging import write_folder
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.targets.judge import differences, facts_of, questions
from mjcompose.targets.target import Loss
from targets.models import SELDOM
from targets.writing import compiled, losses, written

SETTINGS = '<mujoco><compiler fusestatic="false" discardvisual="false" strippath="false"/></mujoco></robot>'


def test_mujoco_reads_the_same_robot(tmp_path: Path) -> None:
    bundle, context = written(SELDOM, "urdf", tmp_path)
    assert bundle is not None and not context.sink.has_errors
    write_folder(bundle, tmp_path / "seldom")
    urdf = (tmp_path / "seldom" / "model.urdf").read_text().replace("</robot>", SETTINGS)
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


GEARED = """<mujoco model="geared">
  <compiler angle="radian"/>
  <default><default class="weak"><motor gear="20" ctrlrange="-0.5 0.25"/></default></default>
  <worldbody>
    <body name="base">
      <inertial pos="0 0 0" mass="3" diaginertia="0.2 0.2 0.2"/>
      <body name="one" pos="0 0 0.1"><joint name="one" axis="0 1 0" range="-2 2" damping="0.4"/><geom size="0.1"/>
        <body name="two" pos="0 0 0.2"><joint name="two" axis="1 0 0" range="-2 2" damping="0.1"/><geom size="0.08"/>
          <body name="three" pos="0.2 0 0"><joint name="three" type="slide" axis="0 0 1" damping="2"/><geom size="0.06"/>
            <body name="four" pos="0 0.2 0"><joint name="four" axis="0 0 1" actuatorfrcrange="-0.3 0.3"/><geom size="0.05"/>
              <body name="five" pos="0 0 0.1"><joint name="five" axis="0 1 0"/><joint name="six" axis="1 0 0"/>
                <geom size="0.04" pos="0.05 0 0"/></body></body></body></body></body>
    </body>
  </worldbody>
  <actuator>
    <motor name="m_one" joint="one" gear="-12" ctrlrange="-0.5 1"/>
    <position name="p_two" joint="two" gear="4" kp="3" kv="0.2" ctrlrange="-2 4" forcerange="-1.5 1.5"/>
    <velocity name="v_three" joint="three" gear="-0.5" kv="30" ctrlrange="-0.4 0.1"/>
    <motor name="m_four" class="weak" joint="four"/>
    <general name="g_five" joint="five" gear="3" gainprm="0.5" biastype="affine" biasprm="0 -0.5 -0.05" ctrlrange="-1.5 1.5"/>
    <motor name="m_six" joint="six" gear="0.1" forcerange="-1 1"/>
  </actuator>
</mujoco>"""
"""All kinds of actuators that a URDF has, through gears of both signs."""


def read_by_us(bundle: Bundle, folder: Path) -> mujoco.MjModel:
    """The model of a recipe whose base is the URDF that was written."""
    write_folder(bundle, folder / "robot")
    (folder / "again.yaml").write_text("recipe: 1\nallow: [license-missing]\nbase: ./robot/model.urdf\n")
    context = Context(folder=folder)
    built = build(ModelRequest(folder / "again.yaml"), context)
    assert built is not None, context.sink.sorted()
    return compiled(built.bundle, folder / "again")


def at_joint(model: mujoco.MjModel, actuator: int, control: float) -> float:
    """The control of the same actuator without a gear."""
    gear = float(model.actuator_gear[actuator][0])
    return control / gear if model.actuator_biastype[actuator] else control * gear


def driven(model: mujoco.MjModel, controls: dict[str, float], steps: int) -> tuple[dict[str, float], dict[str, float]]:
    """The forces at the joints under controls by the names of the joints, and where these are after some steps."""
    model.opt.timestep = 0.0005
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    data = mujoco.MjData(model)
    for number in range(model.nu):
        data.ctrl[number] = controls[model.joint(int(model.actuator_trnid[number][0])).name]
    mujoco.mj_forward(model, data)
    names = [model.joint(number).name for number in range(model.njnt)]
    forces = dict(zip(names, data.qfrc_actuator.tolist(), strict=True))
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return forces, dict(zip(names, data.qpos.tolist(), strict=True))


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0], ids=lambda share: f"{share:.0%} of the range")
def test_what_we_read_again_pushes_and_moves_as_before(share: float, tmp_path: Path) -> None:
    bundle, context = written(GEARED, "urdf", tmp_path)
    assert bundle is not None and not context.sink.has_errors
    before = mujoco.MjModel.from_xml_string(GEARED)
    after = read_by_us(bundle, tmp_path)
    own = {}
    at_joints = {}
    for number in range(before.nu):
        low, high = before.actuator_ctrlrange[number] if before.actuator_ctrllimited[number] else (-1.0, 1.0)
        joint = before.joint(int(before.actuator_trnid[number][0])).name
        own[joint] = low + share * (high - low)
        at_joints[joint] = at_joint(before, number, own[joint])
    forces, ends = driven(before, own, 400)
    forces_again, ends_again = driven(after, at_joints, 400)
    assert set(forces_again) == set(forces)
    for name, force in forces.items():
        assert forces_again[name] == pytest.approx(force, rel=1e-9, abs=1e-12), name
        assert ends_again[name] == pytest.approx(ends[name], abs=1e-5), name
    assert max(map(abs, ends.values())) > 0.01  # it moves


def test_the_ranges_of_controls_are_those_at_the_joints(tmp_path: Path) -> None:
    bundle, _ = written(GEARED, "urdf", tmp_path)
    assert bundle is not None
    robot = etree.fromstring(bundle.files["model.urdf"])
    ranges = {
        str(joint.get("name")): [float(str(each.text)) for each in joint.iterfind("command_interface/param")]
        for joint in robot.iterfind("ros2_control/joint")
    }
    assert ranges == {
        "one": [-12, 6],
        "two": [-0.5, 1],
        "three": [-0.2, 0.8],
        "four": [-10, 5],
        "five": [-0.5, 0.5],
        "six": [],
    }


@pytest.mark.parametrize(
    ("actuator", "expected"),
    [
        ('<motor name="m" joint="j" ctrlrange="-1 1" delay="0.01" nsample="5"/>', "`delay` of 1 actuator"),
        ('<position name="m" joint="j" kp="3" timeconst="0.1"/>', "1 actuator: `m`"),
        ('<motor name="m" joint="j"/><motor name="n" joint="j"/>', "2 actuators: `m`, `n`"),
        ('<motor name="m" joint="j" forcerange="-1 2"/>', "the narrower side of `forcerange` of 1 actuator"),
        ('<motor name="m" joint="j" ctrlrange="-1 2"/>', None),
        ('<motor name="m" joint="j" gear="2"/>', "controls are at the joint"),
        ('<motor name="m" joint="j"/>', "controls have the names of their joints"),
    ],
)
def test_what_controls_lose_is_reported(actuator: str, expected: str | None, tmp_path: Path) -> None:
    text = f"""<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
      <actuator>{actuator}</actuator></mujoco>"""
    _, context = written(text, "urdf", tmp_path)
    told = [each for each in losses(context) if "in another form" not in each or expected]
    assert bool(told) == (expected is not None)
    assert expected is None or any(expected in each for each in told), told


def test_what_a_key_loses_is_reported(tmp_path: Path) -> None:
    text = """<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>
      <actuator><motor name="j" joint="j"/></actuator>
      <keyframe><key name="held" qpos="0.1" ctrl="2"/><key name="at_rest" qpos="0.2"/></keyframe></mujoco>"""
    _, context = written(text, "urdf", tmp_path)
    (told,) = losses(context)
    assert told == "URDF ignores controls of 1 keyframe: `held`; a `group_state` has the positions of joints"

"""Actuators for what a URDF says is commanded.

What other programs say in a URDF.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest
from mjcompose.tree.unit import Unit
from mjcompose.urdf.read import UrdfReader
from urdf.parts import ARM, INERTIAL, joint, link, robot

Reader = Callable[..., UrdfReader]


def actuators(reader: UrdfReader) -> list[dict[str, str]]:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    found = unit.root.find("actuator")
    return [] if found is None else [{"tag": each.tag, **dict(each.attrib)} for each in found]


def control(*joints: str) -> str:
    return f'<ros2_control name="c" type="system"><hardware/>{"".join(joints)}</ros2_control>'


def commanded(name: str, *interfaces: str, inside: str = "") -> str:
    tags = "".join(f'<command_interface name="{each}"/>' for each in interfaces)
    return f'<joint name="{name}">{tags}<state_interface name="position"/>{inside}</joint>'


def test_an_interface_without_gains_is_a_motor_of_the_joints_effort(reader: Reader) -> None:
    text = robot(*ARM, control(commanded("shoulder", "position"), commanded("elbow", "position", "effort")))
    assert actuators(reader("r.urdf", text)) == [
        {"tag": "motor", "name": name, "joint": name, "ctrlrange": "-20 20"} for name in ("shoulder", "elbow")
    ]


def test_gains_make_servos(reader: Reader) -> None:
    pid = '<param name="kp">300</param><param name="kd">12.5</param>'
    text = robot(
        *ARM,
        control(
            commanded("shoulder", "position", inside=pid),
            commanded("elbow", "velocity", inside='<param name="kv">4</param>'),
        ),
    )
    assert actuators(reader("r.urdf", text)) == [
        {"tag": "position", "name": "shoulder", "joint": "shoulder", "kp": "300", "kv": "12.5", "ctrlrange": "-1 1.5"},
        {"tag": "velocity", "name": "elbow", "joint": "elbow", "kv": "4", "ctrlrange": "-2 2"},
    ]


def test_the_range_of_an_interface_and_soft_limits_count(reader: Reader) -> None:
    soft = '<safety_controller k_velocity="1" soft_lower_limit="-0.5" soft_upper_limit="0.75"/>'
    effort = '<joint name="elbow"><command_interface name="effort"><param name="min">-3</param><param name="max">4</param></command_interface></joint>'
    text = robot(
        *ARM[:3],
        joint("shoulder", "base", "upper", soft),
        ARM[4],
        control(commanded("shoulder", "position", inside='<param name="p">9</param>'), effort),
    )
    assert [each["ctrlrange"] for each in actuators(reader("r.urdf", text))] == ["-0.5 0.75", "-3 4"]


@pytest.mark.parametrize("kind", ["<type>transmission_interface/SimpleTransmission</type>", ""])
def test_a_transmission_acts_on_its_joint(reader: Reader, kind: str) -> None:
    attribute = "" if kind else ' type="pr2_mechanism_model/SimpleTransmission"'
    text = robot(
        *ARM,
        f'<transmission name="t"{attribute}>{kind}<joint name="elbow"><hardwareInterface>hardware_interface/EffortJointInterface'
        '</hardwareInterface></joint><actuator name="m"><mechanicalReduction>50</mechanicalReduction></actuator></transmission>',
    )
    read = reader("r.urdf", text)
    assert actuators(read) == [{"tag": "motor", "name": "elbow", "joint": "elbow", "ctrlrange": "-20 20"}]
    assert "transmission/mechanicalReduction" in {row.what for row in read.rows if row.why}
    plain = reader("r.urdf", text.replace(">50<", ">1.0<"))
    assert actuators(plain) and "transmission/mechanicalReduction" not in {row.what for row in plain.rows}


def test_other_transmissions_are_in_the_table(reader: Reader) -> None:
    text = robot(
        *ARM, '<transmission name="t"><type>x/DifferentialTransmission</type><joint name="elbow"/></transmission>'
    )
    read = reader("r.urdf", text)
    assert actuators(read) == []
    assert [row.what for row in read.rows if row.why][:1] == ["joint/limit"] or any(
        row.what == "transmission" and row.why for row in read.rows
    )


def test_what_mimics_and_what_is_fixed_has_none(reader: Reader) -> None:
    text = robot(
        *ARM[:4],
        joint("elbow", "upper", "fore", '<mimic joint="shoulder"/>'),
        link("tip"),
        joint("tip", "fore", "tip", kind="fixed"),
        control(*(commanded(each, "effort") for each in ("shoulder", "elbow", "tip"))),
    )
    assert [each["name"] for each in actuators(reader("r.urdf", text))] == ["shoulder"]


def test_a_joint_that_does_not_exist_is_a_warning(reader: Reader) -> None:
    read = reader("r.urdf", robot(*ARM, control(commanded("elbw", "effort"))))
    assert actuators(read) == []
    (found,) = (each for each in read.sink.sorted() if each.code == "unknown-name")
    assert found.help == 'did you mean `name="elbow"`?'


@pytest.mark.parametrize(("choice", "names"), [("none", []), ("all", ["shoulder", "elbow"]), ("declared", ["elbow"])])
def test_the_choice(reader: Reader, choice: str, names: list[str]) -> None:
    text = robot(*ARM, control(commanded("elbow", "effort")))
    assert sorted(each["name"] for each in actuators(reader("r.urdf", text, actuators=choice))) == sorted(names)


def test_an_actuator_knows_its_place(reader: Reader) -> None:
    read = reader("r.urdf", robot(*ARM, control(commanded("elbow", "effort"))))
    unit = read.unit()
    assert unit is not None
    (motor,) = unit.root.iterfind("actuator/motor")
    assert unit.origins.span(motor, unit.file).line == 7


ExtrasReader = Callable[..., UrdfReader]
BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'


def read(reader: UrdfReader) -> Unit:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    return unit


def test_friction_of_gazebo(reader: ExtrasReader) -> None:
    gazebo = '<gazebo reference="upper"><mu1>0.4</mu1><mu2>0.3</mu2><kp>1e6</kp></gazebo>'
    reading = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + BALL + BALL), *ARM[2:], gazebo))
    assert [geom.get("friction") for geom in read(reading).root.iter("geom")] == ["0.4", "0.4"]
    rows = {row.what: row for row in reading.rows}
    assert rows["gazebo/mu1"].became == "friction" and rows["gazebo/mu2"].why and rows["gazebo/kp"].why


def test_contact_of_pybullet(reader: ExtrasReader) -> None:
    contact = '<contact><lateral_friction value="0.7"/><rolling_friction value="0.01"/></contact>'
    (geom,) = read(reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + BALL + contact), *ARM[2:]))).root.iter(
        "geom"
    )
    assert (geom.get("friction"), geom.get("condim")) == ("0.7 0.005 0.01", "6")


@pytest.mark.parametrize(
    ("setting", "expected"),
    [("<gravity>0</gravity>", "1"), ("<turnGravityOff>true</turnGravityOff>", "1"), ("<gravity>true</gravity>", None)],
)
def test_gravity(reader: ExtrasReader, setting: str, expected: str | None) -> None:
    unit = read(reader("r.urdf", robot(*ARM, f'<gazebo reference="fore">{setting}</gazebo>')))
    (fore,) = (body for body in unit.root.iter("body") if body.get("name") == "fore")
    assert fore.get("gravcomp") == expected


def test_a_spring(reader: ExtrasReader) -> None:
    spring = (
        '<gazebo reference="elbow"><springStiffness>5</springStiffness><springReference>0.2</springReference></gazebo>'
    )
    unit = read(reader("r.urdf", robot(*ARM, spring)))
    (elbow,) = (each for each in unit.root.iter("joint") if each.get("name") == "elbow")
    assert (elbow.get("stiffness"), elbow.get("springref")) == ("5", "0.2")


def test_a_mimic_is_one_equality(reader: ExtrasReader) -> None:
    mimic = joint("elbow", "upper", "fore", '<mimic joint="shoulder" multiplier="-2" offset="0.1"/>')
    (equality,) = read(reader("r.urdf", robot(*ARM[:4], mimic))).root.iterfind("equality/joint")
    assert [equality.get("joint1"), equality.get("joint2")] == ["elbow", "shoulder"]
    assert [float(each) for each in str(equality.get("polycoef")).split()] == [0.1, -2, 0, 0, 0]


def test_a_note_has_all_that_is_not_in_the_model(reader: ExtrasReader) -> None:
    text = robot(*ARM, "<gazebo><plugin/></gazebo>", '<gazebo reference="elbow"><sensor/></gazebo>', "<made_up/>")
    reading = reader("r.urdf", text)
    read(reading)
    (note,) = (each for each in reading.sink.sorted() if each.code == "urdf-unread")
    lines = [each.message for each in note.notes]
    assert [line.split(":")[1] for line in lines] == ["7", "8", "9"]
    assert "`<made_up>` (1)" in lines[-1]


PREFIXED = """<robot name="r">
<link name="base"/>
<link name="tip">{inertial}<visual drake:accepting="g"><geometry><sphere radius="0.1"/></geometry></visual><drake:inertial/></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><drake:rotor_inertia value="0.1"/>
<limit lower="-1" upper="1" drake:acceleration="3"/></joint>
<drake:joint name="k"/>
<gazebo reference="tip"><ignition:plugin/></gazebo>
</robot>"""


@pytest.mark.parametrize("is_declared", [True, False])
@pytest.mark.parametrize("visuals", [None, "keep"])
def test_elements_of_other_programs_are_not_taken_for_those_of_urdf(
    reader: Reader, is_declared: bool, visuals: str | None
) -> None:
    """A prefix need not be declared; `visuals` has MuJoCo read another text than the file's own."""
    text = PREFIXED.replace("{inertial}", INERTIAL)
    if is_declared:
        names = 'xmlns:drake="https://drake.mit.edu" xmlns:ignition="https://gazebosim.org"'
        text = text.replace('name="r"', f'name="r" {names}')
    reading = reader("r.urdf", text, visuals=visuals)
    read(reading)
    unread = {row.what for row in reading.rows if row.why and row.what != "link/visual"}
    assert unread == {"link/drake:inertial", "joint/drake:rotor_inertia", "drake:joint", "gazebo/ignition:plugin"}
    (note,) = (each for each in reading.sink.sorted() if each.code == "urdf-unread")
    assert "`<drake:joint>` (1)" in "".join(each.message for each in note.notes)


def test_a_continuous_joint_gives_its_servo_no_range(reader: Reader) -> None:
    """The limits of a continuous joint have no meaning in URDF, nor have its soft limits."""
    soft = '<safety_controller k_velocity="1" soft_lower_limit="-0.5" soft_upper_limit="0.75"/>'
    gains = '<param name="kp">300</param>'
    for inside in ("", soft):
        text = robot(
            *ARM[:3],
            joint("shoulder", "base", "upper", inside, kind="continuous"),
            ARM[4],
            control(*(commanded(name, "position", inside=gains) for name in ("shoulder", "elbow"))),
        )
        assert [each.get("ctrlrange") for each in actuators(reader("r.urdf", text))] == [None, "-1 1.5"]


@pytest.mark.parametrize(
    ("part", "what"),
    [
        (
            control(commanded("elbow", "position", inside='<param name="kp">9</param><param name="ki">2</param>')),
            "ros2_control/param",
        ),
        (
            control(
                commanded("elbow", "effort"),
                commanded("shoulder", "effort", inside='<param name="mimic">elbow</param>'),
            ),
            "ros2_control/param mimic",
        ),
        (
            control(
                commanded("elbow", "effort"),
                '<transmission name="t"><joint name="elbow"><mechanical_reduction>30'
                "</mechanical_reduction></joint></transmission>",
            ),
            "ros2_control/transmission",
        ),
        (
            2
            * '<transmission name="t" type="x/SimpleTransmission"><joint name="elbow"/><actuator name="a"/></transmission>',
            "transmission",
        ),
        ('<gazebo reference="wrist"><mu1>0.3</mu1></gazebo>', "gazebo"),
    ],
    ids=[
        "other gains",
        "mimicry of ros2_control",
        "reduction of ros2_control",
        "second transmission",
        "gazebo of nothing",
    ],
)
def test_what_controls_say_and_the_model_lacks(reader: Reader, part: str, what: str) -> None:
    reading = reader("r.urdf", robot(*ARM, part))
    read(reading)
    rows = [row for row in reading.rows if row.why and row.what == what]
    assert [row.count for row in rows] == [1], reading.rows


def test_a_reduction_of_one_and_known_gains_are_no_loss(reader: Reader) -> None:
    gains = '<param name="kp">9</param><param name="kd">2</param>'
    one = '<transmission><joint name="elbow"><mechanical_reduction>1.0</mechanical_reduction></joint></transmission>'
    reading = reader("r.urdf", robot(*ARM, control(commanded("elbow", "position", inside=gains), one)))
    read(reading)
    assert not [row for row in reading.rows if row.why and not row.is_minor]


def test_limits_of_a_continuous_joint_are_told(reader: Reader) -> None:
    limit = '<limit lower="-1" upper="1" effort="3" velocity="2"/>'
    turns = joint("elbow", "upper", "fore", limit, kind="continuous")
    reading = reader("r.urdf", robot(*ARM[:4], turns))
    read(reading)
    assert [row.count for row in reading.rows if row.what == "joint/limit lower"] == [1]

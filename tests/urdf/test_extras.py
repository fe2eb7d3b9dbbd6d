"""What other programs say in a URDF."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from urdf.parts import ARM, INERTIAL, joint, link, robot

from composer.tree.unit import Unit
from composer.urdf.read import UrdfReader

Reader = Callable[..., UrdfReader]
BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'


def read(reader: UrdfReader) -> Unit:
    unit = reader.unit()
    assert unit is not None, [each.message for each in reader.sink.errors]
    return unit


def test_friction_of_gazebo(reader: Reader) -> None:
    gazebo = '<gazebo reference="upper"><mu1>0.4</mu1><mu2>0.3</mu2><kp>1e6</kp></gazebo>'
    reading = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + BALL + BALL), *ARM[2:], gazebo))
    assert [geom.get("friction") for geom in read(reading).root.iter("geom")] == ["0.4", "0.4"]
    rows = {row.what: row for row in reading.reading.rows.values()}
    assert rows["gazebo/mu1"].became == "friction" and rows["gazebo/mu2"].why and rows["gazebo/kp"].why


def test_contact_of_pybullet(reader: Reader) -> None:
    contact = '<contact><lateral_friction value="0.7"/><rolling_friction value="0.01"/></contact>'
    (geom,) = read(
        reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + BALL + contact), *ARM[2:]))
    ).root.iter("geom")
    assert (geom.get("friction"), geom.get("condim")) == ("0.7 0.005 0.01", "6")


@pytest.mark.parametrize(("setting", "expected"), [("<gravity>0</gravity>", "1"), ("<turnGravityOff>true</turnGravityOff>", "1"),
                                                   ("<gravity>true</gravity>", None)])  # fmt: skip
def test_gravity(reader: Reader, setting: str, expected: str | None) -> None:
    unit = read(reader("r.urdf", robot(*ARM, f'<gazebo reference="fore">{setting}</gazebo>')))
    (fore,) = (body for body in unit.root.iter("body") if body.get("name") == "fore")
    assert fore.get("gravcomp") == expected


def test_a_spring(reader: Reader) -> None:
    spring = '<gazebo reference="elbow"><springStiffness>5</springStiffness><springReference>0.2</springReference></gazebo>'
    unit = read(reader("r.urdf", robot(*ARM, spring)))
    (elbow,) = (each for each in unit.root.iter("joint") if each.get("name") == "elbow")
    assert (elbow.get("stiffness"), elbow.get("springref")) == ("5", "0.2")


def test_a_mimic_is_one_equality(reader: Reader) -> None:
    mimic = joint("elbow", "upper", "fore", '<mimic joint="shoulder" multiplier="-2" offset="0.1"/>')
    (equality,) = read(reader("r.urdf", robot(*ARM[:4], mimic))).root.iterfind("equality/joint")
    assert [equality.get("joint1"), equality.get("joint2")] == ["elbow", "shoulder"]
    assert [float(each) for each in str(equality.get("polycoef")).split()] == [0.1, -2, 0, 0, 0]


def test_a_note_has_all_that_is_not_in_the_model(reader: Reader) -> None:
    text = robot(
        *ARM, "<gazebo><plugin/></gazebo>", '<gazebo reference="elbow"><sensor/></gazebo>', "<made_up/>"
    )
    reading = reader("r.urdf", text)
    read(reading)
    (note,) = (each for each in reading.sink.sorted() if each.code == "urdf-unread")
    lines = [each.message for each in note.notes]
    assert [line.split(":")[1] for line in lines] == ["7", "8", "9"]
    assert "`<made_up>` (1)" in lines[-1]

from __future__ import annotations

import pytest

from composer import mjcf
from composer.mjcf import MjcfError, RootElement


@pytest.fixture
def leg() -> RootElement:
    leg = RootElement("leg")
    thigh = leg.worldbody.add("body")
    thigh.add("joint")
    thigh.add("geom", size=[0.1])
    thigh.add("body").add("geom", size=[0.1])
    return leg


def test_what_is_referred_to_without_a_name_gets_one(leg: RootElement) -> None:
    joint = leg.find_all("joint")[0]
    motor = leg.actuator.add("motor", joint=joint)
    assert motor.joint is joint and joint.name == "unnamed_joint_0"
    assert leg.find("joint", "unnamed_joint_0") is joint
    assert joint.origin_of("name").file == __file__
    assert leg.actuator.add("velocity", joint=joint).joint is joint
    assert leg.compile_model().model.actuator(0).trnid[0] == 0


def test_two_of_a_call_get_different_names(leg: RootElement) -> None:
    thigh, shin = leg.find_all("body")
    exclude = leg.contact.add("exclude", body1=thigh, body2=shin)
    assert (exclude.body1, exclude.body2) == (thigh, shin)
    assert [thigh.name, shin.name] == ["unnamed_body_0", "unnamed_body_1"]


def test_names_that_are_taken_are_not_given(leg: RootElement) -> None:
    thigh, shin = leg.find_all("body")
    shin.name = "unnamed_body_1"
    leg.sensor.add("framepos", objtype="body", objname=thigh)
    assert thigh.name == "unnamed_body_2"


def test_what_hangs_on_a_model_is_named_under_its_prefix(leg: RootElement) -> None:
    trunk = RootElement("trunk")
    trunk.attach(leg)
    joint = leg.find_all("joint")[0]
    motor = trunk.actuator.add("motor", joint=joint)
    assert motor.joint is joint and joint.full_identifier == "leg/unnamed_joint_0"
    assert trunk.compile_model().model.nu == 1


def test_a_call_that_fails_names_nothing(leg: RootElement) -> None:
    joint = leg.find_all("joint")[0]
    for wrong in ({"gear": "x"}, {"joints": 1}, {"site": joint}):
        with pytest.raises(MjcfError):
            leg.actuator.add("motor", joint=joint, **wrong)
    with pytest.raises(MjcfError, match="not attached to"):
        RootElement("other").actuator.add("motor", joint=joint)
    assert joint.name is None and leg.find("joint", "unnamed_joint_0") is None


def test_a_material_made_of_a_texture_without_a_name() -> None:
    model = mjcf.RootElement()
    checker = model.asset.add("texture", type="2d", builtin="checker", width=8, height=8)
    model.asset.add("material", name="grid", texture=checker)
    assert checker.name == "unnamed_texture_0"
    assert model.compile_model().model.ntex == 1

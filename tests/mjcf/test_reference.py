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
    assert joint.name is None and leg.find("joint", "unnamed_joint_0") is None


def test_a_material_made_of_a_texture_without_a_name() -> None:
    model = mjcf.RootElement()
    checker = model.asset.add("texture", type="2d", builtin="checker", width=8, height=8)
    model.asset.add("material", name="grid", texture=checker)
    assert checker.name == "unnamed_texture_0"
    assert model.compile_model().model.ntex == 1


def test_references_read_as_elements_and_are_set_by_element_or_name(arm: mjcf.RootElement) -> None:
    motor, shoulder = arm.find("actuator", "elbow"), arm.find("joint", "shoulder")
    assert motor is not None and motor.joint is arm.find("joint", "elbow_joint")
    motor.joint = shoulder
    assert motor.joint is shoulder and 'name="elbow" joint="shoulder"' in repr(motor)
    motor.joint = "elbow_joint"
    assert motor.joint is arm.find("joint", "elbow_joint")
    sensor = arm.find("sensor", "tip")
    assert sensor is not None and sensor.objname is arm.find("site", "flange")
    geom = arm.find("body", "upper").find("geom")  # type: ignore[union-attr]
    assert geom is not None and geom.dclass is arm.find("default", "visual")
    assert geom.mesh is arm.find("mesh", "shell")


def test_lists_of_references_are_lists() -> None:
    model = mjcf.RootElement()
    bodies = [model.worldbody.add("body", name=name) for name in "ab"]
    flex = model.deformable.add(
        "flex", name="f", dim=1, body=bodies, vertex=[0, 0, 0, 1, 0, 0], element=[0, 1]
    )
    assert flex.body == bodies
    bodies[0].name = "c"
    assert 'body="c b"' in repr(flex)


def test_a_reference_of_another_kind_is_refused(arm: mjcf.RootElement) -> None:
    motor = arm.find("actuator", "elbow")
    assert motor is not None
    with pytest.raises(mjcf.MjcfError, match="expects a joint, got `<body>` `fore`"):
        motor.joint = arm.find("body", "fore")
    with pytest.raises(mjcf.MjcfError, match="expects no element"):
        motor.gear = motor.joint
    other = mjcf.RootElement("other").worldbody
    flex = arm.deformable.add("flex", name="f", dim=1, vertex=[0, 0, 0, 1, 0, 0], element=[0, 1])
    with pytest.raises(mjcf.MjcfError, match="not attached to `arm`"):
        flex.body = [other, other]
    assert motor.joint.name == "elbow_joint"


def test_the_world_can_be_referred_to(arm: mjcf.RootElement) -> None:
    sensor = arm.sensor.add("framepos", objtype="body", objname=arm.worldbody)
    assert sensor.objname is arm.worldbody and 'objname="world"' in repr(sensor)
    assert arm.find("body", "world") is arm.worldbody


def test_what_is_in_a_list_of_names_gets_no_name_with_a_space() -> None:
    model, child = mjcf.RootElement("model"), mjcf.RootElement("child")
    body, other = model.worldbody.add("body", name="a"), child.worldbody.add("body", name="b")
    model.attach(child)
    flex = model.deformable.add("flex", name="cloth", body=[body, other])
    for rename in (
        lambda: setattr(body, "name", "a a"),
        lambda: setattr(other, "name", "b b"),
        lambda: setattr(child, "model", "the child"),
    ):
        with pytest.raises(mjcf.MjcfError, match="`<flex>` `cloth` has it in a list of names"):
            rename()
        assert flex.body == [body, other] and str(flex) == '<flex name="cloth" body="a child/b"/>'
    flex.remove()
    body.name, other.name, child.model = "a a", "b b", "the child"
    assert other.full_identifier == "the child/b b"

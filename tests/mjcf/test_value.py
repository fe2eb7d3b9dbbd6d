from __future__ import annotations

import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, RootElement
from mjcompose.mjcf.value import BadValue, decode, encode
from mjcompose.tree.grammar import GRAMMAR


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
    motor = arm.find("actuator", "elbow")
    shoulder = arm.find("joint", "shoulder")
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
    flex = model.deformable.add("flex", name="f", dim=1, body=bodies, vertex=[0, 0, 0, 1, 0, 0], element=[0, 1])
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
    model = mjcf.RootElement("model")
    child = mjcf.RootElement("child")
    body = model.worldbody.add("body", name="a")
    other = child.worldbody.add("body", name="b")
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
    body.name = "a a"
    other.name = "b b"
    child.model = "the child"
    assert other.full_identifier == "the child/b b"


GEOM = GRAMMAR.element("geom").attributes
MESH = GRAMMAR.element("mesh").attributes


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("size", [1, 2.5], "1 2.5"),
        ("size", (0.1, np.float64(0.2)), "0.1 0.2"),
        ("size", np.array([0.1, 0.2, 0.3]), "0.1 0.2 0.3"),
        ("size", 0.1, "0.1"),
        ("size", "0.1  0x1p-1", "0.1  0x1p-1"),
        ("pos", np.array([1, 2, 3]), "1 2 3"),
        ("mass", 1, "1"),
        ("mass", np.array(2.0), "2"),
        ("group", 3.0, "3"),
        ("type", "mesh", "mesh"),
        ("name", "a b", "a b"),
    ],
)
def test_values_become_the_text_that_mjcf_has(name: str, value: object, text: str) -> None:
    assert encode(GEOM[name], value) == text


def test_bytes_are_no_list_of_numbers() -> None:
    for value in (b"abc", bytearray(3), np.bytes_(b"abc")):
        with pytest.raises(BadValue, match="expects 3 numbers"):
            encode(GEOM["pos"], value)


def test_text_is_taken_as_it_stands_in_xml() -> None:
    mocap = GRAMMAR.element("body").attributes["mocap"]
    limited = GRAMMAR.element("joint").attributes["limited"]
    assert [encode(mocap, value) for value in (True, "true", np.bool_(False))] == ["true", "true", "false"]
    assert [encode(limited, value) for value in (True, "auto")] == ["true", "auto"]
    for attribute, value in ((mocap, "yes"), (mocap, 1), (limited, "maybe"), (GEOM["type"], "sphere box")):
        with pytest.raises(BadValue):
            encode(attribute, value)


def test_rows_are_joined_where_any_number_of_items_will_do() -> None:
    assert encode(MESH["vertex"], np.eye(3)) == encode(MESH["vertex"], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert encode(MESH["vertex"], np.eye(3)) == "1 0 0 0 1 0 0 0 1"


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("size", [1, 2, 3, 4], "1 to 3 numbers, got 4"),
        ("size", [], "got 0"),
        ("size", "1 x", "got `x`"),
        ("size", [True], "got `true`"),
        ("size", {1, 2}, "expects"),
        ("size", object(), "expects"),
        ("pos", np.zeros((3, 1)), "flat array, got one of shape (3, 1)"),
        ("pos", [0, 0, float("nan")], "got `nan`"),
        ("pos", "0 0 nan", "got `nan`"),
        ("pos", [0, 0, float("inf")], "expects finite numbers, got `inf`"),
        ("size", "-inf", "expects finite numbers, got `-inf`"),
        ("pos", np.array([1j, 0, 0]), "number"),
        ("pos", np.array(["a", "b", "c"]), "number"),
        ("mass", [1.0], "got a list of 1"),
        ("group", 1.5, "integer"),
        ("type", "spere", "got `spere`"),
        ("type", 3, "expects"),
        ("name", 3, "got a number `3`"),
        ("name", "a\x01", "XML cannot hold"),
    ],
)
def test_what_does_not_fit_is_told(name: str, value: object, told: str) -> None:
    with pytest.raises(BadValue) as caught:
        encode(GEOM[name], value)
    assert told in str(caught.value)


def test_numbers_come_back_as_numpy() -> None:
    size = decode(GEOM["size"], "0.1 0x1p3")
    assert isinstance(size, np.ndarray) and size.dtype == np.float64 and size.tolist() == [0.1, 8.0]
    mass = decode(GEOM["mass"], "2")
    group = decode(GEOM["group"], "2")
    assert isinstance(mass, np.float64) and mass == 2.0
    assert isinstance(group, np.int64) and group == 2
    assert decode(GEOM["type"], "mesh") == "mesh"


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("1 2.5 -.5e-3", [1, 2.5, -0.0005]), ("\t1\n2 3 ", [1, 2, 3]), ("+1. 0x10 1e300", [1, 16, 1e300])],
)
def test_numbers_are_read_however_they_are_written(text: str, numbers: list[float]) -> None:
    assert decode(GEOM["pos"], text).tolist() == numbers  # type: ignore[attr-defined]


@pytest.mark.parametrize("text", ["1 2 1_0", "1 2 3\u00a0", "1 2 1e999", "1 2 \u0663", "1,2,3", "1 2 3 4"])
def test_what_python_takes_for_numbers_and_mujoco_does_not_is_refused(text: str) -> None:
    with pytest.raises(BadValue):
        decode(GEOM["pos"], text)


@pytest.mark.parametrize("value", [0.1 + 0.2, 1e-300, -0.0, 1 / 3, 123456789.125])
def test_numbers_survive_to_the_bit(value: float) -> None:
    read = decode(GEOM["pos"], encode(GEOM["pos"], [value, 0, 0]))
    assert read[0].hex() == value.hex()  # type: ignore[index]


def test_text_that_mujoco_would_refuse_is_not_read() -> None:
    with pytest.raises(BadValue):
        decode(GEOM["pos"], "1 2")


def test_rows_are_of_one_length_and_any_precision() -> None:
    with pytest.raises(BadValue, match="expects rows of one length"):
        encode(MESH["vertex"], [[0, 0, 0], [1, 0]])
    assert encode(MESH["vertex"], np.full((2, 3), 0.5, np.longdouble)) == "0.5 0.5 0.5 0.5 0.5 0.5"


def test_axes_of_angles_are_letters() -> None:
    eulerseq = GRAMMAR.element("compiler").attributes["eulerseq"]
    assert encode(eulerseq, "XYz") == "XYz"
    for value, said in (("xyw", "expects letters of `xyzXYZ`, got `w`"), ("xy", "expects 3 characters, got 2")):
        with pytest.raises(BadValue, match=said):
            encode(eulerseq, value)

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from composer import mjcf


@pytest.fixture
def body() -> mjcf.Element:
    return mjcf.RootElement("m").worldbody.add("body", name="b")


def test_an_element_keeps_its_identity(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "elbow_joint")
    assert joint is not None
    assert arm.find("joint", "elbow_joint") is joint
    assert joint.parent is arm.find("body", "fore") and joint.parent.joint[0] is joint
    assert joint.root is arm and arm.worldbody.parent is arm and arm.parent is None
    assert any(each is joint for each in arm.find_all("joint"))


def test_tag_name_and_attributes(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "shoulder")
    assert joint is not None
    assert (joint.tag, joint.name, joint.full_identifier) == ("joint", "shoulder", "shoulder")
    np.testing.assert_array_equal(joint.range, [-1.5, 1.5])
    assert joint.damping is None and joint.get("damping", 3) == 3
    assert joint.get_attributes().keys() == {"name", "axis", "range"}


def test_get_of_an_attribute_that_such_elements_do_not_have_is_the_default(body: mjcf.Element) -> None:
    assert body.get("mass", "default") == "default"


def test_an_attribute_that_does_not_exist_is_told_and_hasattr_works(body: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="has no attribute `mas`"):
        _ = body.mas
    assert not hasattr(body, "mass") and getattr(body, "mass", 7) == 7
    with pytest.raises(AttributeError):
        body.mass = 1


def test_attributes_are_set_and_deleted(body: mjcf.Element) -> None:
    geom = body.add("geom", size=[0.1])
    geom.size = np.array([0.2, 0.3])
    geom.type = "capsule"
    np.testing.assert_array_equal(geom.size, [0.2, 0.3])
    del geom.type
    geom.rgba = None
    assert geom.type is None and geom.get_attributes().keys() == {"size"}


def test_set_attributes_sets_all_or_none(body: mjcf.Element) -> None:
    geom = body.add("geom", name="g", size=[0.1])
    with pytest.raises(mjcf.MjcfError):
        geom.set_attributes(name="h", size=[0.5], type="spere")
    assert geom.name == "g" and geom.size.tolist() == [0.1]
    geom.set_attributes(name="h", size=[0.5], pos=None)
    assert geom.name == "h" and geom.size.tolist() == [0.5]


def test_a_failed_add_adds_nothing(body: mjcf.Element) -> None:
    for tag, attributes in (
        ("goem", {}),
        ("geom", {"siz": 1}),
        ("geom", {"size": [1, 2, 3, 4]}),
        ("geom", {"name": "x", "quat": [1, 0, 0, 0], "euler": [0, 0, 0]}),
    ):
        with pytest.raises(mjcf.MjcfError):
            body.add(tag, **attributes)
    assert body.all_children() == [] and body.root.find("geom", "x") is None


@pytest.mark.parametrize(
    ("tag", "attributes", "code", "said"),
    [
        ("goem", {}, "unknown-element", "did you mean `geom`?"),
        ("motor", {}, "unknown-element", "`<body>` cannot have a `motor`"),
        ("geom", {"frictoin": [1]}, "unknown-attribute", "did you mean `friction`?"),
        ("geom", {"size": [1, 2, 3, 4]}, "wrong-length", "1 to 3 numbers, got 4"),
        ("geom", {"type": "spere"}, "wrong-keyword", "did you mean `sphere`?"),
        ("geom", {"mass": "heavy"}, "wrong-type", "got `heavy`"),
        ("geom", {"name": "taken"}, "name-clash", "`<geom>` `taken` is here"),
        ("body", {"name": "world"}, "name-clash", "`world`"),
    ],
)
def test_what_is_wrong_is_told_with_what_is_there(
    body: mjcf.Element, tag: str, attributes: dict[str, object], code: str, said: str
) -> None:
    body.add("geom", name="taken")
    with pytest.raises(mjcf.MjcfError) as caught:
        body.add(tag, **attributes)
    (fault,) = caught.value.diagnostics
    assert fault.code == code and said in str(caught.value)
    assert fault.span is not None and fault.span.file == __file__


def test_a_clash_names_both_places(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        arm.worldbody.add("body", name="fore")
    (fault,) = caught.value.diagnostics
    assert fault.span is not None and fault.span.file == __file__
    place = fault.notes[0].span
    assert place is not None and place.file.endswith("arm.xml") and place.line == 17


def test_names_are_unique_in_a_namespace_only(body: mjcf.Element) -> None:
    body.add("geom", name="b")
    body.add("joint", name="b")
    with pytest.raises(mjcf.MjcfError):
        body.add("freejoint", name="b")


def test_insert_puts_a_child_before_another(body: mjcf.Element) -> None:
    first = body.add("geom", name="1")
    last = body.insert("geom", 99, name="3")
    middle = body.insert("site", position=1)
    zeroth = body.insert("geom", position=-3)
    assert body.all_children() == [zeroth, first, middle, last]
    assert body.insert("geom", -1, name="2") is body.all_children()[3]
    assert (
        first.add("plugin") is not None and body.insert("body", 0).insert("geom", -1).parent is body.body[0]
    )
    with pytest.raises(mjcf.MjcfError):
        body.insert("geom", "first")  # type: ignore[arg-type]


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
    other = mjcf.RootElement("other").worldbody.add("body", name="x").add("joint", name="j")
    with pytest.raises(mjcf.MjcfError, match="not attached to `arm`"):
        motor.joint = other
    assert motor.joint.name == "elbow_joint"


def test_the_world_can_be_referred_to(arm: mjcf.RootElement) -> None:
    sensor = arm.sensor.add("framepos", objtype="body", objname=arm.worldbody)
    assert sensor.objname is arm.worldbody and 'objname="world"' in repr(sensor)
    assert arm.find("body", "world") is arm.worldbody


def test_renaming_renames_what_refers_to_it(arm: mjcf.RootElement) -> None:
    fore, flange, visual = (
        arm.find("body", "upper"),
        arm.find("site", "flange"),
        arm.find("default", "visual"),
    )
    assert fore is not None and flange is not None and visual is not None
    fore.name, flange.name, visual.name = "arm1", "tool", "looks"
    text = arm.to_xml_string()
    assert 'body2="arm1"' in text and 'objname="tool"' in text and '<geom class="looks"' in text
    assert arm.find("body", "upper") is None and arm.find("body", "arm1") is fore


def test_renaming_an_asset_without_a_name_gives_it_one(gripper: mjcf.RootElement) -> None:
    mesh = gripper.find("mesh", "shell")
    assert mesh is not None and mesh.name == "shell"
    mesh.name = "half"
    assert 'name="half"' in repr(mesh) and gripper.find_all("geom")[1].mesh is mesh


def test_a_name_can_be_taken_away(arm: mjcf.RootElement) -> None:
    site = arm.find("site", "flange")
    assert site is not None
    del site.name
    assert site.name is None and site.full_identifier is None
    with pytest.raises(mjcf.MjcfError, match="`flange`, which does not exist"):
        arm.to_xml_string()


def test_an_orientation_replaces_another(body: mjcf.Element) -> None:
    geom = body.add("geom", quat=[1, 0, 0, 0])
    geom.euler = [0, 90, 0]
    assert geom.quat is None and geom.euler.tolist() == [0, 90, 0]


def test_children_by_tag(arm: mjcf.RootElement) -> None:
    fore = arm.find("body", "fore")
    assert fore is not None
    assert [each.tag for each in fore.all_children()] == ["joint", "geom", "site", "site"]
    assert fore.site == fore.all_children()[2:] and fore.inertial is None
    inertial = fore.add("inertial", pos=[0, 0, 0], mass=1, diaginertia=[1, 1, 1])
    assert fore.inertial is inertial
    with pytest.raises(mjcf.MjcfError, match="can have one only"):
        fore.add("inertial", pos=[0, 0, 0], mass=2)


def test_settings_are_there_when_asked_for_and_not_written_when_empty() -> None:
    model = mjcf.RootElement()
    model.visual.headlight.ambient = [0.1, 0.1, 0.1]
    assert model.visual.global_.fovy is None and model.option.flag.contact is None
    assert model.default.geom.rgba is None and model.visual.headlight is model.visual.headlight
    model.worldbody.add("geom", size=[1])
    assert model.to_xml_string() == (
        '<mujoco>\n  <visual>\n    <headlight ambient="0.1 0.1 0.1"/>\n  </visual>\n'
        '  <worldbody>\n    <geom size="1"/>\n  </worldbody>\n</mujoco>\n'
    )


def test_default_classes_are_elements() -> None:
    model = mjcf.RootElement()
    red = model.default.add("default", dclass="red")
    red.geom.rgba = [1, 0, 0, 1]
    geom = model.worldbody.add("geom", size=[1], dclass=red)
    assert red.name == "red" and geom.dclass is red and red.geom.tag == "geom"
    geom.dclass = model.default
    assert geom.dclass is model.default and 'class="main"' in repr(geom)
    with pytest.raises(mjcf.MjcfError, match="default class is called `red`"):
        model.default.add("default", dclass="red")


def test_children_cannot_be_assigned(body: mjcf.Element) -> None:
    for element, name in ((body, "geom"), (body.root, "worldbody"), (body.root.visual, "global_")):
        with pytest.raises(mjcf.MjcfError, match="is an element and cannot be set"):
            setattr(element, name, 3)


def test_what_is_not_an_attribute_cannot_be_set(body: mjcf.Element) -> None:
    for name in ("tag", "parent", "root", "full_identifier"):
        with pytest.raises(mjcf.MjcfError, match=f"`{name}` of `<body>` `b` cannot be set"):
            setattr(body, name, None)
    flex = body.add("flexcomp", name="f", type="grid", origin=[1, 0, 0])
    with pytest.raises(mjcf.MjcfError, match=r"`set_attributes\(origin=…\)` sets the attribute"):
        flex.origin = [2, 0, 0]
    flex.set_attributes(origin=[2, 0, 0])
    assert flex.get("origin").tolist() == [2, 0, 0] and flex.origin.file == __file__


def test_the_origin_is_a_place_in_a_file_or_a_line_of_the_program(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "shoulder")
    assert joint is not None and (joint.origin.file.endswith("arm.xml"), joint.origin.line) == (True, 14)
    added = arm.worldbody.add("geom", size=[1])
    assert added.origin.file == __file__


def test_the_origin_of_an_attribute(arm: mjcf.RootElement) -> None:
    joint = arm.find("joint", "shoulder")
    assert joint is not None
    name = joint.origin_of("name")
    assert (name.file, name.line) == (joint.origin.file, 14) and name.column > joint.origin.column
    joint.damping = 3
    place = joint.origin_of("damping")
    assert place.file == __file__ and place.line > joint.origin.line
    assert joint.origin_of("name") == name
    assert copy.deepcopy(arm).find("joint", "shoulder").origin_of("damping") == place  # type: ignore[union-attr]
    added = arm.worldbody.add("geom", size=[1])
    assert added.origin_of("size") == added.origin
    with pytest.raises(mjcf.MjcfError, match="`armature` of .* is not set"):
        joint.origin_of("armature")
    with pytest.raises(mjcf.MjcfError, match="did you mean `damping`"):
        joint.origin_of("dampin")


def test_scopes_lead_to_attached_models(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    cell = mjcf.RootElement("cell")
    cell.attach(arm)
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    assert cell.enter_scope("arm/gripper") is cell.enter_scope("arm/gripper/") is gripper
    assert cell.worldbody.enter_scope("arm").enter_scope("gripper") is gripper  # type: ignore[union-attr]
    assert cell.enter_scope("gripper") is arm.enter_scope("arm") is None
    assert (gripper.full_identifier, cell.full_identifier) == ("arm/gripper/", "")
    turn = frame.add("joint", name="turn")
    own = arm.find_all("joint", exclude_attachments=True)
    assert turn in own and len(own) == 3 and len(cell.find_all("joint")) == 5
    assert cell.find_all("joint", exclude_attachments=True) == []


def test_a_removed_element_is_of_no_use(body: mjcf.Element) -> None:
    geom = body.add("geom", name="g", size=[1])
    body.remove()
    assert body.tag == "body" and repr(geom) == '<geom name="g" size="1"/>'
    for attempt in (
        lambda: body.add("geom"),
        lambda: geom.parent,
        lambda: geom.size,
        lambda: geom.get("size"),
        geom.get_attributes,
        lambda: setattr(geom, "size", [2]),
        lambda: geom.find("plugin"),
        lambda: body.attach(mjcf.RootElement("x")),
        body.remove,
    ):
        with pytest.raises(mjcf.MjcfError, match="was removed"):
            attempt()


def test_an_element_is_not_copied_alone_and_pickled_with_its_model(body: mjcf.Element) -> None:
    for copied in (copy.copy, copy.deepcopy):
        with pytest.raises(mjcf.MjcfError, match="without its model"):
            copied(body)
    assert pickle.loads(pickle.dumps(body)).root.to_xml_string() == body.root.to_xml_string()


def test_a_value_in_a_file_that_mujoco_refuses_is_told_where_it_stands() -> None:
    model = mjcf.from_xml_string('<mujoco>\n<worldbody><geom name="g" pos="1 2"/></worldbody></mujoco>')
    with pytest.raises(mjcf.MjcfError, match="expects 3 numbers, got 2") as caught:
        _ = model.find("geom", "g").pos  # type: ignore[union-attr]
    assert caught.value.diagnostics[0].span.line == 2  # type: ignore[union-attr]


def test_attributes_and_children_are_completed(body: mjcf.Element) -> None:
    assert {"pos", "childclass", "geom", "add"} <= set(dir(body))
    assert "dclass" in dir(body.add("geom"))


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


def test_the_top_class_keeps_its_name() -> None:
    model = mjcf.RootElement()
    model.default.geom.rgba = [1, 0, 0, 1]
    with pytest.raises(mjcf.MjcfError, match="the top default class is called `main`"):
        model.default.dclass = "top"
    model.default.dclass = "main"
    assert model.find("default", "main") is model.default

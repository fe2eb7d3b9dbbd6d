from __future__ import annotations

import copy

import numpy as np
import pytest
from mjcompose import mjcf


@pytest.fixture
def body() -> mjcf.Element:
    return mjcf.RootElement("m").worldbody.add("body", name="b")


def test_get_of_an_attribute_that_such_elements_do_not_have_is_the_default(body: mjcf.Element) -> None:
    assert body.get("mass", "default") == "default"


def test_an_attribute_that_does_not_exist_is_told_and_hasattr_works(body: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="`mas` is not an attribute of"):
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


def test_a_value_in_a_file_that_mujoco_refuses_is_told_where_it_stands() -> None:
    model = mjcf.from_xml_string('<mujoco>\n<worldbody><geom name="g" pos="1 2"/></worldbody></mujoco>')
    with pytest.raises(mjcf.MjcfError, match="expects 3 numbers, got 2") as caught:
        _ = model.find("geom", "g").pos  # type: ignore[union-attr]
    assert caught.value.diagnostics[0].span.line == 2  # type: ignore[union-attr]

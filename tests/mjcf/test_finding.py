from __future__ import annotations

import pytest

from composer import mjcf


def test_a_family_is_found_by_its_name() -> None:
    model = mjcf.RootElement()
    free = model.worldbody.add("body", name="a").add("freejoint", name="f")
    hinge = model.worldbody.add("body", name="b").add("joint", name="h")
    motor = model.actuator.add("motor", name="m", joint=hinge)
    servo = model.actuator.add("position", name="p", joint=hinge)
    assert model.find_all("joint") == [free, hinge]
    assert model.find_all("freejoint") == [free] and model.find("freejoint", "h") is None
    assert model.find_all("actuator") == [motor, servo] and model.find_all("position") == [servo]
    assert model.find("joint", "f") is free and model.find("actuator", "p") is servo
    assert model.find("motor", "p") is None


def test_find_without_a_name_is_the_first_in_document_order(arm: mjcf.RootElement) -> None:
    assert arm.find("body") is arm.find("body", "base")
    assert arm.find("material") is arm.asset.material[0]
    assert arm.find("camera") is None and arm.find("camera", "x") is None


def test_elements_of_default_classes_are_no_elements_of_the_model(arm: mjcf.RootElement) -> None:
    assert [joint.name for joint in arm.find_all("joint")] == ["shoulder", "elbow_joint"]
    assert len(arm.default.find_all("joint")) == 1
    assert [each.name for each in arm.default.find_all("default")] == ["visual"]


def test_the_same_tag_in_another_section_is_another_thing(gripper: mjcf.RootElement) -> None:
    assert [joint.name for joint in gripper.find_all("joint")] == ["left", "right"]
    assert gripper.equality.find_all("joint") == [gripper.find("equality", "mirror")]
    assert len(gripper.find("tendon", "split").find_all("joint")) == 2  # type: ignore[union-attr]


def test_only_what_is_below_is_found(arm: mjcf.RootElement) -> None:
    fore, upper = arm.find("body", "fore"), arm.find("body", "upper")
    assert fore is not None and upper is not None
    assert fore.find("joint", "shoulder") is None and upper.find("joint", "elbow_joint") is fore.joint[0]
    assert fore.find("body", "fore") is None
    assert [each.name for each in upper.find_all("geom")] == [None, "upper", "fore"]
    assert [each.name for each in upper.find_all("geom", immediate_children_only=True)] == [None, "upper"]
    assert fore.find_all("actuator") == []


def test_sections_are_found_too(arm: mjcf.RootElement) -> None:
    assert arm.find("worldbody") is arm.worldbody and arm.find_all("compiler") == [arm.compiler]
    assert arm.find_all("asset", immediate_children_only=True) == [arm.asset]


def test_a_tag_that_mjcf_does_not_have_is_told(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError, match="did you mean `joint`"):
        arm.find("jiont")
    with pytest.raises(mjcf.MjcfError, match="expects a name"):
        arm.find("joint", 3)  # type: ignore[arg-type]
    with pytest.raises(mjcf.MjcfError, match="MJCF has no element"):
        arm.find_all(None)  # type: ignore[arg-type]


def test_a_model_may_be_edited_while_going_through_it(arm: mjcf.RootElement) -> None:
    for body in arm.find_all("body"):
        body.add("body", name=f"{body.name}_more")
    assert len(arm.find_all("body")) == 6

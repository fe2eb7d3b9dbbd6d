from __future__ import annotations

import pytest
from mjcompose import mjcf


def test_what_is_removed_is_gone(arm: mjcf.RootElement) -> None:
    near = arm.find("exclude", "near")
    near.remove()  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match="was removed from its model"):
        near.origin  # type: ignore[union-attr]  # noqa: B018
    assert arm.find("exclude") is None and "exclude" not in arm.to_xml_string()
    arm.contact.add("exclude", name="near", body1="base", body2="fore")


def test_references_to_what_was_removed_are_told_with_everyone_who_refers(arm: mjcf.RootElement) -> None:
    arm.sensor.add("jointpos", name="angle", joint="elbow_joint")
    arm.find("joint", "elbow_joint").remove()  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError) as caught:
        arm.to_xml_string()
    (fault,) = caught.value.diagnostics
    assert fault.code == "unknown-name"
    told = [note.message for note in fault.notes]
    assert told[0].startswith("`<motor>` `elbow` refers") and told[1].startswith("`<jointpos>` `angle` refers")
    assert told[2] == "joints that exist: shoulder"
    assert arm.find("actuator", "elbow").joint == "elbow_joint"  # type: ignore[union-attr]


def test_a_whole_body_takes_its_names_along(arm: mjcf.RootElement) -> None:
    arm.find("body", "fore").remove()  # type: ignore[union-attr]
    assert arm.find("joint", "elbow_joint") is None and arm.find("site", "flange") is None
    arm.worldbody.add("body", name="fore")


def test_cascade_removes_who_refers(arm: mjcf.RootElement) -> None:
    arm.find("body", "fore").remove(cascade=True)  # type: ignore[union-attr]
    assert [each.name for each in arm.find_all("actuator")] == ["shoulder"]
    assert arm.find_all("sensor") == [] and arm.find("exclude", "near") is not None
    arm.keyframe.remove()
    arm.to_xml_string()


def test_cascade_takes_a_tendon_and_what_pulls_it_as_a_whole(gripper: mjcf.RootElement) -> None:
    gripper.find("joint", "left").remove(cascade=True)  # type: ignore[union-attr]
    assert gripper.find_all("tendon") == [] and gripper.find_all("actuator") == []
    assert gripper.find_all("equality") == [] and gripper.find("joint", "right") is not None


def test_cascade_only_drops_classes_and_materials(arm: mjcf.RootElement) -> None:
    geom = arm.find("geom", "base")
    assert geom is not None
    visual = arm.find("body", "upper").geom[0]  # type: ignore[union-attr]
    arm.find("material", "grey").remove(cascade=True)  # type: ignore[union-attr]
    arm.find("default", "visual").remove(cascade=True)  # type: ignore[union-attr]
    assert visual.material is None and visual.dclass is None and visual.mesh is not None


def test_a_reference_in_a_class_goes_without_the_class() -> None:
    model = mjcf.RootElement()
    grey = model.asset.add("material", name="grey")
    model.default.geom.material = grey
    grey.remove(cascade=True)
    assert model.default.geom.material is None


def test_a_section_is_emptied_and_stays(arm: mjcf.RootElement) -> None:
    sensors = arm.sensor
    tip = arm.find("sensor", "tip")
    sensors.remove()
    assert arm.sensor is sensors and arm.find("sensor", "tip") is None and tip is not None
    sensors.add("framepos", name="tip", objtype="site", objname="flange")


def test_the_root_cannot_be_removed(arm: mjcf.RootElement) -> None:
    with pytest.raises(mjcf.MjcfError, match="cannot be removed"):
        arm.remove()


def test_what_is_attached_to_a_removed_body_is_detached(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    arm.sensor.add("jointpos", joint="gripper/left")
    arm.find("body", "fore").remove(cascade=True)  # type: ignore[union-attr]
    assert gripper.parent_model is None and arm.find_all("sensor") == []
    arm.attach(gripper)


def test_cascade_takes_who_refers_to_a_joint_of_an_attachment_frame(
    arm: mjcf.RootElement, gripper: mjcf.RootElement
) -> None:
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    turn = frame.add("joint", name="turn")
    slide = frame.add("joint")
    arm.sensor.add("jointpos", joint=turn)
    arm.sensor.add("jointpos", name="kept", joint=slide)
    turn.remove(cascade=True)
    assert [each.name for each in arm.find_all("sensor")] == ["tip", "kept"]


def test_cascade_takes_who_refers_to_a_copy_that_a_replicate_makes() -> None:
    scene = mjcf.RootElement("scene")
    rack = mjcf.RootElement("rack")
    pads = rack.worldbody.add("replicate", count=12)
    pad = pads.add("site", name="pad")
    rack.worldbody.add("site", name="pad_other")
    scene.attach(rack)
    for model, names in ((rack, ("pad03", "pad_other")), (scene, ("rack/pad11", "rack/pad_other"))):
        for name in names:
            model.sensor.add("framepos", name=name.rpartition("/")[2], objtype="site", objname=name)
    pad.remove(cascade=True)
    assert [each.name for each in rack.find_all("sensor")] == ["pad_other"]
    assert [each.name for each in scene.find_all("sensor")] == ["pad_other", "pad_other"]

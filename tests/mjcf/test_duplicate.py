from __future__ import annotations

import copy

from composer import mjcf


def test_a_deep_copy_is_a_model_of_its_own(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    turn = frame.add("joint", name="turn")
    arm.actuator.add("motor", joint=turn)
    text = arm.to_xml_string()
    twin = copy.deepcopy(arm)
    assert twin is not arm and twin.to_xml_string() == text and twin.assets == arm.assets
    other = twin.attached_models[0]
    assert other is not gripper and twin.find("geom", "gripper/palm") is other.find("geom", "palm")
    twin.find("joint", "gripper/turn").name = "yaw"  # type: ignore[union-attr]
    other.find("body", "palm").remove(cascade=True)  # type: ignore[union-attr]
    assert arm.to_xml_string() == text and turn.name == "turn"
    assert twin.actuator.motor[1].joint.name == "yaw"


def test_a_copy_of_an_attached_model_hangs_on_nothing(
    arm: mjcf.RootElement, gripper: mjcf.RootElement
) -> None:
    arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    twin = copy.deepcopy(gripper)
    assert twin.parent_model is None
    twin.model = "second"
    arm.attach(twin)
    assert arm.find("geom", "second/palm") is twin.find("geom", "palm")


def test_origins_are_copied(arm: mjcf.RootElement) -> None:
    added = arm.worldbody.add("geom", name="added", size=[1])
    assert copy.deepcopy(arm).find("geom", "added").origin == added.origin  # type: ignore[union-attr]


def test_elements_that_are_copied_together_with_their_model_stay_in_it(
    arm: mjcf.RootElement, gripper: mjcf.RootElement
) -> None:
    frame = arm.find("site", "flange").attach(gripper)  # type: ignore[union-attr]
    turn = frame.add("joint", name="turn")
    shoulder, left = arm.find("joint", "shoulder"), gripper.find("joint", "left")
    for held in (
        {"model": arm, "joints": [shoulder, left], "frame": [frame, turn], "gripper": gripper},
        {"joints": [shoulder, left], "model": None, "frame": [frame, turn], "gripper": None},
    ):
        twin = copy.deepcopy(held)
        root = twin["model"] or twin["joints"][0].root
        assert root is not arm and twin["joints"][0] is root.find("joint", "shoulder")
        assert twin["frame"] == [
            mjcf.get_attachment_frame(root.enter_scope("gripper")),
            root.find("joint", "gripper/turn"),
        ]
        assert twin["joints"][1] is root.find("joint", "gripper/left")
        assert twin["gripper"] in (None, root.enter_scope("gripper"))
    assert turn.root is arm and left is arm.find("joint", "gripper/left")

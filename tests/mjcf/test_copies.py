from __future__ import annotations

import copy
import pickle
from pathlib import Path

import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, RootElement


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


def test_a_copy_of_an_attached_model_hangs_on_nothing(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
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
    shoulder = arm.find("joint", "shoulder")
    left = gripper.find("joint", "left")
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


def _through(value: object, protocol: int = pickle.HIGHEST_PROTOCOL) -> object:
    return pickle.loads(pickle.dumps(value, protocol))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_a_composition_means_the_same(protocol: int, arm: RootElement, gripper: RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)
    frame.pos = [0, 0, 0.01]
    frame.add("joint", type="slide", name="slide")
    twin = _through(arm, protocol)
    assert isinstance(twin, RootElement)
    assert twin is not arm
    assert twin.to_xml_string() == arm.to_xml_string()
    assert twin.assets == arm.assets
    twin.find("body", "gripper/left").name = "renamed"
    assert arm.find("body", "gripper/left") is not None


def test_what_is_pickled_together_stays_together(arm: RootElement, gripper: RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)
    joint = frame.add("joint", name="slide")
    parts = [arm, gripper, gripper.find("joint", "left"), frame, joint, arm.worldbody]
    a, g, left, f, j, world = _through(parts)  # type: ignore[misc]
    assert g.parent_model is a and f is mjcf.get_attachment_frame(g)
    assert left is a.find("joint", "gripper/left") and left.root is g
    assert j is a.find("joint", "gripper/slide") and world is a.worldbody


def test_files_in_memory_and_origins(arm: RootElement, folder: Path) -> None:
    arm.asset.add("mesh", name="extra", file=mjcf.Asset(b"solid", ".stl"))
    site = arm.find("body", "fore").add("site", name="new")
    twin = _through(arm)
    assert isinstance(twin, RootElement)
    assert twin.find("mesh", "extra").file.contents == b"solid"
    assert twin.find("mesh", "shell").file.path == arm.find("mesh", "shell").file.path
    for tag, name in (("body", "fore"), ("joint", "elbow_joint"), ("site", "new")):
        assert twin.find(tag, name).origin == arm.find(tag, name).origin
    assert site.origin.file == __file__


def test_a_removed_element_is_told(arm: RootElement) -> None:
    site = arm.find("site", "flange")
    site.remove()
    with pytest.raises(MjcfError, match="was removed"):
        pickle.dumps(site)


def test_comments_above_the_first_section_stay_there() -> None:
    cell = mjcf.from_xml_string("<mujoco><!-- who made it --><option timestep='0.01'/><worldbody/></mujoco>")
    cell.attach(mjcf.RootElement("tool"))
    assert pickle.loads(pickle.dumps(cell)).to_xml_string() == cell.to_xml_string()

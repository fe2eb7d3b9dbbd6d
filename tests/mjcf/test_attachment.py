from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf

Compiled = Callable[[mjcf.RootElement], mujoco.MjModel]


@pytest.fixture
def frame(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> mjcf.Element:
    """The gripper on the arm's flange."""
    site = arm.find("site", "flange")
    assert site is not None
    return site.attach(gripper)


def test_a_child_is_seen_under_its_prefix_and_keeps_its_own_names(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element
) -> None:
    pad = gripper.find("geom", "left_pad")
    assert pad is not None and arm.find("geom", "gripper/left_pad") is pad
    assert (pad.name, pad.full_identifier, pad.root) == ("left_pad", "gripper/left_pad", gripper)
    assert arm.find("geom", "left_pad") is None
    assert gripper.parent_model is arm and gripper.root_model is arm and arm.attached_models == [gripper]


def test_everything_is_found_where_it_hangs(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element
) -> None:
    bodies = [body.full_identifier for body in arm.find_all("body")]
    assert bodies == ["base", "upper", "fore", "gripper/palm", "gripper/left", "gripper/right"]
    fore = arm.find("body", "fore")
    base = arm.find("geom", "base")
    assert fore is not None and base is not None
    assert fore.find("body", "gripper/palm") is gripper.find("body", "palm")
    assert len(fore.find_all("joint")) == 3 and fore.find("actuator", "gripper/fingers") is None
    assert [each.full_identifier for each in arm.find_all("actuator")] == ["shoulder", "elbow", "gripper/fingers"]
    assert arm.actuator.find("position", "gripper/fingers") is gripper.actuator.position[0]
    assert [each.name for each in fore.find_all("body", immediate_children_only=True)] == ["palm"]
    assert arm.find("default", "gripper/finger") is gripper.find("default", "finger")
    assert arm.find("default", "gripper/") is gripper.default


def test_a_child_stays_live(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    gripper.find("body", "palm").add("site", name="tcp", pos=[0, 0, 0.1])  # type: ignore[union-attr]
    gripper.find("joint", "left").name = "thumb"  # type: ignore[union-attr]
    model = compiled(arm)
    assert model.site("gripper/tcp").pos.tolist() == [0, 0, 0.1]
    assert model.joint("gripper/thumb").range.tolist() == [0, 0.03]


def test_the_parent_refers_into_the_child_and_follows_its_names(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    sensor = arm.sensor.add("framepos", name="s", objtype="site", objname="gripper/pinch")
    by_element = arm.sensor.add("jointpos", name="j", joint=gripper.find("joint", "right"))
    assert sensor.objname is gripper.find("site", "pinch") and by_element.joint.root is gripper
    gripper.find("site", "pinch").name = "center"  # type: ignore[union-attr]
    assert 'objname="gripper/center"' in repr(sensor)
    gripper.model = "hand"
    assert 'objname="hand/center"' in repr(sensor) and by_element.joint is gripper.find("joint", "right")
    model = compiled(arm)
    assert model.sensor("j").objid == model.joint("hand/right").id


def test_a_child_refers_to_its_parent(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    shoulder = arm.find("joint", "shoulder")
    sensor = gripper.sensor.add("jointpos", name="turned", joint=shoulder)
    assert sensor.joint is shoulder and 'joint="../shoulder"' in repr(sensor)
    model = compiled(arm)
    assert model.sensor("gripper/turned").objid[0] == model.joint("shoulder").id
    with pytest.raises(mjcf.MjcfError, match="`../shoulder`, which does not exist"):
        gripper.to_xml_string()
    with pytest.raises(mjcf.MjcfError, match="which `gripper` cannot refer to"):
        gripper.find_all("geom")[0].dclass = arm.default.add("default", dclass="red")


def test_without_a_joint_no_body_is_added(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    assert frame.name == "gripper/" and frame.full_identifier == "gripper/" and frame.root is arm
    assert frame.parent is arm.find("body", "fore")
    assert arm.find("body", "gripper/") is None and "gripper/" not in [b.name for b in arm.find_all("body")]
    model = compiled(arm)
    assert model.nbody == 7 and model.body("gripper/palm").parentid == model.body("fore").id


def test_a_joint_makes_the_frame_a_body(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    bare = frame.add("joint", axis=[0, 0, 1], range=[-1, 1])
    named = frame.add("joint", name="tilt", axis=[1, 0, 0])
    assert arm.find("body", "gripper/") is frame and arm.find("joint", "gripper/") is bare
    assert arm.find("joint", "gripper/tilt") is named and frame.find_all("joint")[:2] == [bare, named]
    assert (named.name, named.full_identifier, bare.full_identifier) == ("tilt", "gripper/tilt", "gripper/")
    assert mjcf.get_frame_joints(frame) == [bare, named] == mjcf.get_frame_joints(gripper)
    arm.actuator.add("motor", name="turn", joint=named)
    named.name = "nod"
    model = compiled(arm)
    assert model.actuator("turn").trnid[0] == model.joint("gripper/nod").id
    assert model.joint("gripper/").range.tolist() == [-1, 1]
    assert model.joint("gripper/nod").damping == [2], "the parent's default class reaches it"
    assert model.body("gripper/palm").parentid == model.body("gripper/").id
    named.remove()
    assert mjcf.get_frame_joints(frame) == [bare]


def test_joint_names_of_a_frame_must_be_free(gripper: mjcf.RootElement, frame: mjcf.Element) -> None:
    frame.add("joint")
    for attributes in ({}, {"name": "left"}):
        with pytest.raises(mjcf.MjcfError, match="already"):
            frame.add("joint", **attributes)
    with pytest.raises(mjcf.MjcfError, match="only joint"):
        frame.add("freejoint")
    frame.add("joint", name="x")
    with pytest.raises(mjcf.MjcfError, match="gripper/x"):
        gripper.find("joint", "left").name = "x"  # type: ignore[union-attr]


def test_the_offset_of_a_frame(arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled) -> None:
    frame = arm.find("body", "fore").attach(gripper)  # type: ignore[union-attr]
    frame.pos = [0.1, 0, 0.2]
    frame.euler = [0, 0, np.pi / 2]
    assert frame.pos.tolist() == [0.1, 0, 0.2]
    palm = compiled(arm).body("gripper/palm")
    np.testing.assert_allclose(palm.pos, [0.1, 0, 0.2])
    np.testing.assert_allclose(palm.quat, [0.5**0.5, 0, 0, 0.5**0.5])


@pytest.mark.parametrize("unit", ["degree", "radian"])
def test_angles_of_a_frame_are_in_the_parents_unit(unit: str, gripper: mjcf.RootElement, compiled: Compiled) -> None:
    quarter = 90 if unit == "degree" else np.pi / 2
    base = mjcf.RootElement("base")
    base.compiler.angle = unit
    frame = base.attach(gripper)
    frame.euler = [quarter, 0, 0]
    frame.add("joint", range=[-quarter, quarter])
    model = compiled(base)
    np.testing.assert_allclose(model.joint("gripper/").range, [-np.pi / 2, np.pi / 2])
    np.testing.assert_allclose(model.body("gripper/").quat, [0.5**0.5, 0.5**0.5, 0, 0])


def test_a_free_joint_lets_the_child_float_at_the_place(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    joint = frame.add("freejoint")
    assert mjcf.get_frame_freejoint(frame) is joint is mjcf.get_frame_freejoint(gripper)
    assert arm.find("joint", "gripper/") is joint
    model = compiled(arm)
    assert model.joint("gripper/").type == mujoco.mjtJoint.mjJNT_FREE
    np.testing.assert_allclose(model.body("gripper/").pos, [0, 0, 0.1 + 0.4 + 0.35])


@pytest.mark.parametrize("place", ["worldbody", "site"])
def test_a_free_joint_may_be_spelled_either_way(
    place: str, arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    host = arm.worldbody if place == "worldbody" else arm.find("site", "flange")
    assert host is not None
    joint = host.attach(gripper).add("joint", type="free")
    assert mjcf.get_frame_freejoint(gripper) is joint
    assert compiled(arm).joint("gripper/").type == mujoco.mjtJoint.mjJNT_FREE
    joint.armature = 0.1
    if place == "worldbody":
        assert compiled(arm).joint("gripper/").armature.tolist() == [0.1] * 6
    else:
        with pytest.raises(mjcf.MjcfError, match="can be in the world only"):
            arm.to_xml_string()


def test_a_frame_can_be_mocap(arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled) -> None:
    frame = arm.attach(gripper)
    frame.mocap = True
    assert arm.find("body", "gripper/") is frame
    assert compiled(arm).body("gripper/").mocapid == 0


def test_a_frame_is_no_body_of_any_kind(frame: mjcf.Element) -> None:
    with pytest.raises(mjcf.MjcfError, match="takes joints, got `geom`"):
        frame.add("geom", size=[1])
    with pytest.raises(mjcf.MjcfError, match="no `gravcomp`"):
        frame.gravcomp = 1
    with pytest.raises(mjcf.MjcfError, match="`detach\\(\\)` the model"):
        frame.remove()
    with pytest.raises(mjcf.MjcfError, match="not models"):
        frame.attach(mjcf.RootElement("x"))
    with pytest.raises(mjcf.MjcfError, match="`pso` is not an attribute of"):
        frame.pso = 1


def test_a_reference_to_a_frame_that_is_no_body_is_told(
    arm: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    arm.equality.add("weld", body1=frame, body2="base")
    with pytest.raises(mjcf.MjcfError, match="a body only once it has a joint"):
        arm.to_xml_string()
    frame.add("joint")
    assert compiled(arm).neq == 2


def test_attaching_to_a_place_without_a_name_gives_it_none(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    fore = arm.find("body", "fore")
    assert fore is not None
    fore.site[1].attach(gripper)
    holder = fore.add("frame", pos=[0, 0.5, 0])
    holder.attach(mjcf.from_xml_string("<mujoco model='f'><worldbody><site name='s'/></worldbody></mujoco>"))
    text = arm.to_xml_string()
    assert "attachment-" not in text and fore.site[1].name is None
    model = compiled(arm)
    np.testing.assert_allclose(model.body("gripper/palm").pos, [0.1, 0, 0.1])
    np.testing.assert_allclose(model.site("f/s").pos, [0, 0.5, 0])


def test_detaching_gives_the_child_back(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element, compiled: Compiled
) -> None:
    before = gripper.to_xml_string()
    arm.sensor.add("jointpos", name="s", joint="gripper/left")
    gripper.detach()
    assert gripper.parent_model is None and mjcf.get_attachment_frame(gripper) is None
    assert gripper.find("joint", "left").full_identifier == "left"  # type: ignore[union-attr]
    assert gripper.to_xml_string() == before and arm.find("joint", "gripper/left") is None
    with pytest.raises(mjcf.MjcfError, match="`<jointpos>` `s` refers to the joint `gripper/left`"):
        arm.to_xml_string()
    with pytest.raises(mjcf.MjcfError, match="was removed"):
        frame.pos = [0, 0, 1]
    with pytest.raises(mjcf.MjcfError, match="not attached"):
        gripper.detach()
    arm.attach(gripper)
    assert arm.find("sensor", "s").joint is gripper.find("joint", "left")  # type: ignore[union-attr]


def test_what_cannot_be_attached(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.attach(gripper)
    third = mjcf.RootElement("third")
    gripper.attach(third)
    for host, child, told in (
        (arm, gripper, "is attached already"),
        (arm, arm, "to itself"),
        (gripper, arm, "which is part of it"),
        (third, arm, "which is part of it"),
        (arm, mjcf.RootElement("gripper"), "called `gripper` is attached"),
    ):
        with pytest.raises(mjcf.MjcfError, match=told):
            host.attach(child)
    for element in (arm.find("joint", "shoulder"), arm.actuator, arm.default.add("default", dclass="d").site):
        with pytest.raises(mjcf.MjcfError, match="nothing can be attached"):
            element.attach(mjcf.RootElement("new"))  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match="got `str`"):
        arm.worldbody.attach("gripper")  # type: ignore[arg-type]
    many = arm.worldbody.add("replicate", count=2).add("body", name="many")
    with pytest.raises(mjcf.MjcfError, match="inside a `<replicate>`"):
        many.attach(mjcf.RootElement("new"))
    assert arm.attached_models == [gripper] and gripper.attached_models == [third]


def test_names_clash_across_models(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    arm.worldbody.add("geom", name="gripper/palm", size=[1])
    with pytest.raises(mjcf.MjcfError, match="`gripper/palm` in `arm`, which would have two"):
        arm.attach(gripper)
    gripper.model = "hand"
    arm.attach(gripper)
    with pytest.raises(mjcf.MjcfError, match="which would have two"):
        gripper.model = "gripper"
    with pytest.raises(mjcf.MjcfError, match="geom is already called `hand/left_pad`"):
        arm.worldbody.add("geom", name="hand/left_pad")
    arm.worldbody.add("geom", name="hand/new", size=[1])
    with pytest.raises(mjcf.MjcfError, match="geom is already called `hand/new`"):
        gripper.worldbody.add("geom", name="new")
    assert gripper.model == "hand"


def test_models_attached_to_attached_models(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, compiled: Compiled
) -> None:
    cell = mjcf.RootElement("cell")
    cell.compiler.angle = "radian"
    cell.worldbody.add("body", name="table", pos=[1, 0, 0]).attach(arm)
    tool = mjcf.RootElement("tool")
    tool.worldbody.add("geom", name="tip", size=[0.01])
    gripper.find("site", "pinch").attach(tool)  # type: ignore[union-attr]
    cell.find("site", "arm/flange").attach(gripper)  # type: ignore[union-attr]
    tip = cell.find("geom", "arm/gripper/tool/tip")
    assert tip is tool.find("geom", "tip") is gripper.find("geom", "tool/tip") and tip is not None
    assert tip.full_identifier == "arm/gripper/tool/tip"
    arm.sensor.add("jointpos", name="left", joint="gripper/left")
    cell.sensor.add("framepos", name="tip", objtype="geom", objname=tip)
    model = compiled(cell)
    assert model.geom("arm/gripper/tool/tip").bodyid == model.body("arm/gripper/right").id
    assert model.sensor("arm/left").objid == model.joint("arm/gripper/left").id
    arm.model = "robot"
    gripper.model = "hand"
    assert compiled(cell).sensor("tip").objid == compiled(cell).geom("robot/hand/tool/tip").id
    assert compiled(arm).sensor("left").objid == compiled(arm).joint("hand/left").id


def test_a_model_hangs_in_the_world_of_one_that_hangs(compiled: Compiled) -> None:
    outer, middle, inner = (mjcf.RootElement(name) for name in ("outer", "middle", "inner"))
    inner.worldbody.add("body", name="b", pos=[0, 0, 1]).add("geom", size=[1])
    middle.attach(inner).pos = [0, 1, 0]
    frame = outer.attach(middle)
    frame.quat = [0, 0, 0, 1]
    np.testing.assert_allclose(compiled(outer).body("middle/inner/b").pos, [0, -1, 1])
    inner.find("body", "b").add("freejoint")  # type: ignore[union-attr]
    assert compiled(outer).njnt == 1
    frame.add("joint")
    with pytest.raises(mjcf.MjcfError, match="free joint at its root"):
        outer.to_xml_string()
    inner.find("body", "b").freejoint[0].remove()  # type: ignore[union-attr]
    model = compiled(outer)
    assert model.body("middle/inner/b").parentid == model.body("middle/").id
    np.testing.assert_allclose(model.body("middle/inner/b").pos, [0, 1, 1])


def test_the_frame_of_an_element(arm: mjcf.RootElement, gripper: mjcf.RootElement, frame: mjcf.Element) -> None:
    assert mjcf.get_attachment_frame(gripper) is frame
    assert mjcf.get_attachment_frame(gripper.find("geom", "palm")) is frame  # type: ignore[arg-type]
    assert mjcf.get_attachment_frame(arm) is None
    assert mjcf.get_frame_joints(arm) == [] and mjcf.get_frame_freejoint(frame) is None


def test_the_free_joint_of_a_body() -> None:
    model = mjcf.from_xml_string(
        "<mujoco><default><default class='f'><joint type='free'/></default></default><worldbody>"
        "<body name='a'><freejoint name='a'/></body><body name='b'><joint name='b' type='free'/></body>"
        "<body name='c'><frame><joint name='c' class='f'/></frame></body>"
        "<body name='d' childclass='f'><joint name='d'/></body><body name='e'><joint name='e'/></body>"
        "</worldbody></mujoco>"
    )
    found = [mjcf.get_freejoint(body) for body in model.find_all("body")]
    assert [joint and joint.name for joint in found] == ["a", "b", "c", "d", None]


def test_a_frame_that_is_gone_is_shown_without_a_name(arm: mjcf.RootElement, gripper: mjcf.RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)
    assert repr(frame) == '<body name="gripper/"/>'
    gripper.detach()
    assert repr(frame) == "<body/>"


@pytest.mark.parametrize(
    "become_body", [lambda frame: frame.add("joint", name="turn"), lambda frame: setattr(frame, "mocap", True)]
)
def test_a_frame_that_becomes_a_body_needs_its_name(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, become_body: Callable[[mjcf.Element], object]
) -> None:
    arm.worldbody.add("body", name="gripper/")
    frame = arm.attach(gripper)
    before = str(arm)
    with pytest.raises(mjcf.MjcfError, match="another body is already called `gripper/`"):
        become_body(frame)
    assert str(arm) == before and not frame.all_children()


@pytest.mark.parametrize(("tag", "name"), [("body", "hand/"), ("joint", "hand/turn")])
def test_a_new_model_name_must_leave_room_for_the_frame(
    arm: mjcf.RootElement, gripper: mjcf.RootElement, tag: str, name: str
) -> None:
    arm.attach(gripper).add("joint", name="turn")
    arm.find("body", "fore").add(tag, name=name)  # type: ignore[union-attr]
    with pytest.raises(mjcf.MjcfError, match=f"there is a {tag} `{name}` in `arm`"):
        gripper.model = "hand"
    assert gripper.model == "gripper"


def _ball(name: str) -> mjcf.RootElement:
    model = mjcf.RootElement(name)
    body = model.worldbody.add("body", name="b", pos=[0, 0, 1])
    body.add("joint", name="j")
    body.add("geom", name="g", size=[0.1])
    body.add("site", name="s")
    return model


def _scene() -> tuple[mjcf.RootElement, list[mjcf.RootElement]]:
    """Two models beside each other, and a third one on the second, which refers to the first."""
    root = mjcf.RootElement("scene")
    models = [_ball(name) for name in ("one", "two", "three")]
    root.attach(models[0])
    root.attach(models[1])
    models[1].find("body", "b").attach(models[2])
    return root, models


def _ids(model: mujoco.MjModel, sensor: str) -> tuple[int, int]:
    row = model.sensor(sensor)
    return int(row.objid[0]), int(row.refid[0])


def test_models_beside_one_another_refer_to_each_other(compiled: Compiled) -> None:
    root, (one, two, three) = _scene()
    for child, other in ((one, two), (two, one), (three, one), (one, three), (three, two)):
        body = other.find("body", "b")
        site = child.find("site", "s")
        sensor = child.sensor.add(
            "framepos", name=f"to_{other.model}", objtype="body", objname=body, reftype="site", refname=site
        )
        assert sensor.objname is body and sensor.refname is site
    one.contact.add("exclude", body1=one.find("body", "b"), body2=three.find("body", "b"))
    two.equality.add("joint", joint1=two.find("joint", "j"), joint2=one.find("joint", "j"))
    one.actuator.add("motor", name="push", site=one.find("site", "s"), refsite=three.find("site", "s"))
    model = compiled(root)
    for child, other in (("one/", "two/"), ("two/", "one/"), ("two/three/", "one/"), ("one/", "two/three/")):
        ids = _ids(model, f"{child}to_{other.split('/')[-2]}")
        assert ids == (model.body(f"{other}b").id, model.site(f"{child}s").id)
    assert model.actuator("one/push").trnid.tolist() == [model.site("one/s").id, model.site("two/three/s").id]
    assert copy.deepcopy(root).to_xml_string() == root.to_xml_string()
    assert pickle.loads(pickle.dumps(root)).to_xml_string() == root.to_xml_string()


def test_what_is_referred_to_from_beside_may_be_renamed_and_removed(compiled: Compiled) -> None:
    root, (one, _two, three) = _scene()
    site = three.find("site", "s")
    sensor = one.sensor.add("framepos", name="there", objtype="site", objname=site)
    three.model = "third"
    site.name = "renamed"
    assert sensor.objname is site and 'objname="../two/third/renamed"' in repr(sensor)
    model = compiled(root)
    assert _ids(model, "one/there")[0] == model.site("two/third/renamed").id
    one.model = "first"
    assert 'objname="two/third/renamed"' in root.to_xml_string()
    site.remove(cascade=True)
    assert one.find("sensor", "there") is None
    sensor = one.sensor.add("framepos", name="there", objtype="body", objname=three.find("body", "b"))
    three.detach()
    with pytest.raises(mjcf.MjcfError, match="which does not exist"):
        root.to_xml_string()
    root.attach(three)
    sensor.objname = three.find("body", "b")
    assert 'objname="third/b"' in root.to_xml_string()


def test_references_follow_in_a_process_that_made_none_of_them(tmp_path: Path) -> None:
    root, (one, _two, three) = _scene()
    one.sensor.add("framepos", name="there", objtype="site", objname=three.find("site", "s"))
    (tmp_path / "model.pickle").write_bytes(pickle.dumps(root))
    program = (
        "import pickle, sys\nroot = pickle.load(open(sys.argv[1], 'rb'))\n"
        "root.find('site', 'two/three/s').name = 'renamed'\n"
        "assert 'objname=\"two/three/renamed\"' in root.to_xml_string()\n"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path / "model.pickle")], check=True)


def test_what_is_referred_to_may_be_attached_later(compiled: Compiled) -> None:
    root = mjcf.RootElement("scene")
    walker = _ball("walker")
    ball = _ball("ball")
    body = ball.find("body", "b")
    sensor = walker.sensor.add("framepos", name="s", objtype="body", objname=body)
    assert sensor.objname is body
    with pytest.raises(mjcf.MjcfError, match="`objname` to `<body>` `b` of the model `ball`, which is not attached"):
        walker.to_xml_string()
    root.attach(walker)
    body.name = "moved"
    ball.model = "other"
    root.attach(_ball("ball"))  # it has the names that the other one had
    assert sensor.objname is body
    with pytest.raises(mjcf.MjcfError, match="which is not attached"):
        root.to_xml_string()
    root.attach(ball)
    model = compiled(root)
    assert sensor.objname is body and _ids(model, "walker/s")[0] == model.body("other/moved").id


def test_a_body_between_has_the_least_mass_that_its_parent_asks_for(compiled: Compiled) -> None:
    root = mjcf.RootElement("scene")
    child = _ball("walker")
    root.compiler.boundmass = 2e-5
    root.compiler.boundinertia = 1e-6
    root.attach(child).add("joint", name="x", type="slide")
    model = compiled(root)
    assert model.body("walker/").mass[0] == 2e-5 and model.body("walker/").inertia.tolist() == [1e-6] * 3
    alone = mujoco.MjModel.from_xml_string(child.to_xml_string())
    assert model.body("walker/b").mass[0] == alone.body("b").mass[0]


def test_an_equality_with_the_world_moves_with_its_model(compiled: Compiled) -> None:
    """What MuJoCo's own attach leaves behind: the child would be pulled back to where it stands in its own file."""
    child = mjcf.from_xml_string(
        '<mujoco model="c"><worldbody><body name="b" pos="0 0 1"><freejoint/><geom size=".1"/></body></worldbody>'
        '<equality><weld body1="b" anchor="0 .1 0"/><connect body1="world" body2="b" anchor="0 .2 1"/></equality></mujoco>'
    )
    parent = mjcf.RootElement()
    parent.worldbody.add("site", name="s", pos=[3, 0, 0], euler=[0, 0, 90]).attach(child)
    model = compiled(parent)
    assert model.eq_data[0, :3] == pytest.approx([2.9, 0, 0])
    assert model.eq_data[1, :3] == pytest.approx([2.8, 0, 1])
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert np.abs(data.efc_pos).max() < 1e-9


def test_below_a_body_the_world_of_a_model_is_that_body(arm: mjcf.RootElement, compiled: Compiled) -> None:
    child = mjcf.from_xml_string(
        '<mujoco model="c"><worldbody><body name="b"><joint/><geom size=".1"/></body></worldbody>'
        '<equality><weld body1="b"/></equality></mujoco>'
    )
    arm.find("site", "flange").attach(child)
    model = compiled(arm)
    assert model.body(model.eq_obj2id[0]).name == "fore"
    child.detach()
    unnamed = arm.find("body", "fore").add("body")
    unnamed.attach(child)
    with pytest.raises(mjcf.MjcfError, match="has no name"):
        arm.to_xml_string()
    unnamed.name = "x"
    model = compiled(arm)
    assert model.body(model.eq_obj2id[0]).name == "x"

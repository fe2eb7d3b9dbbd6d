from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.base.limits import allow
from mjcompose.mjcf import MjcfError, Physics, RootElement

PENDULUM = """
<mujoco model="pendulum"><worldbody><camera name="eye"/>
  <body name="pole" pos="0 0 1"><joint name="hinge" axis="0 1 0"/><geom name="bob" pos="0.1 0 0" size="0.05"/></body>
</worldbody><actuator><motor name="motor" joint="hinge"/></actuator>
<keyframe><key name="up" time="3" qpos="1.5"/><key qpos="0.5"/></keyframe></mujoco>
"""


@pytest.fixture
def root() -> RootElement:
    return mjcf.from_xml_string(PENDULUM)


@pytest.fixture
def swing(root: RootElement) -> Physics:
    return root.compile_model()


def test_it_holds_mujocos_own_objects_after_a_first_forward(root: RootElement, swing: Physics) -> None:
    assert isinstance(swing.model, mujoco.MjModel)
    assert isinstance(swing.data, mujoco.MjData)
    assert swing.bind(root.find("geom", "bob")).xpos.tolist() == [0.1, 0, 1]
    assert repr(swing) == "<Physics nq=1, nv=1, nu=1, nbody=2, time=0>"


def test_step_and_time(swing: Physics) -> None:
    theirs = mujoco.MjData(swing.model)
    for _ in range(5):
        mujoco.mj_step(swing.model, theirs)
    swing.step(2)
    swing.step(3)
    assert swing.data.qpos[0] == theirs.qpos[0] != 0
    assert swing.time == pytest.approx(5 * swing.timestep)
    swing.time = 7
    swing.timestep = 0.01
    swing.step()
    assert swing.time == 7.01


def test_forward_computes_what_follows_from_the_state(root: RootElement, swing: Physics) -> None:
    swing.bind(root.find("joint", "hinge")).qpos = np.pi / 2
    swing.forward()
    assert swing.bind(root.find("geom", "bob")).xpos == pytest.approx([0, 0, 0.9])


def test_reset(root: RootElement, swing: Physics) -> None:
    swing.step(10)
    swing.reset()
    assert (swing.time, swing.data.qpos[0]) == (0, 0)
    up = root.find("key", "up")
    for keyframe in (0, "up", up):
        swing.step()
        swing.reset(keyframe)
        assert (swing.time, swing.data.qpos[0]) == (3, 1.5)
    assert swing.bind(root.find("geom", "bob")).xpos[2] == pytest.approx(1 - 0.1 * np.sin(1.5))
    swing.reset(root.find_all("key")[1])
    assert swing.data.qpos[0] == 0.5


@pytest.mark.parametrize("keyframe", ["down", 2, -1, True])
def test_a_keyframe_that_is_not_there(keyframe: object, swing: Physics) -> None:
    with pytest.raises(MjcfError, match=f"the compiled model has no key `{keyframe}`") as caught:
        swing.reset(keyframe)  # type: ignore[arg-type]
    assert "keys that exist: up, 1" in str(caught.value)


def test_a_keyframe_by_a_number_of_numpy(swing: Physics) -> None:
    swing.reset("up")
    expected = swing.data.qpos.copy()
    swing.reset()
    swing.reset(np.argmax([1, 0]))
    assert swing.data.qpos.tolist() == expected.tolist()


def test_an_element_that_is_no_keyframe(root: RootElement, swing: Physics) -> None:
    with pytest.raises(MjcfError, match="expects a key, got `<geom>` `bob`"):
        swing.reset(root.find("geom", "bob"))


def test_copies_share_nothing(root: RootElement, swing: Physics) -> None:
    swing.step(3)
    for twin in (swing.copy(), copy.copy(swing), copy.deepcopy(swing)):
        assert twin.time == swing.time and twin.data.qpos[0] == swing.data.qpos[0]
        hinge = twin.bind(root.find("joint", "hinge"))
        hinge.qpos = 2
        hinge.damping = 5
        assert swing.data.qpos[0] != 2 and swing.model.dof_damping[0] == 0
        twin.step()
        assert twin.time > swing.time


def test_a_copy_has_one_model(swing: Physics) -> None:
    for twin in (swing.copy(), pickle.loads(pickle.dumps(swing))):
        assert twin.data.model is twin.model is not swing.model


def test_a_pickle_is_model_and_state_and_binds_by_name(root: RootElement, swing: Physics) -> None:
    swing.bind(root.find("joint", "hinge")).damping = 5
    swing.step(3)
    twin, other = pickle.loads(pickle.dumps((swing, root)))
    assert (twin.time, twin.data.qpos[0]) == (swing.time, swing.data.qpos[0])
    for tree in (root, other, mjcf.from_xml_string(PENDULUM)):
        assert twin.bind(tree.find("joint", "hinge")).damping == [5]
    twin.step()
    swing.step()
    assert twin.data.qpos[0] == swing.data.qpos[0]
    twin.bind(other.find("joint", "hinge")).damping = 1
    assert swing.model.dof_damping[0] == 5


def test_binding_twice_gives_the_same(root: RootElement, swing: Physics) -> None:
    hinge = root.find("joint", "hinge")
    assert swing.bind(hinge) is swing.bind(hinge)
    assert swing.bind([hinge]) is swing.bind((hinge,))
    assert swing.bind([hinge]) is not swing.bind(hinge)
    assert swing.bind(each for each in [hinge]).qpos.shape == (1,)


def test_what_was_edited_since_is_bound_to_what_it_was(root: RootElement, swing: Physics) -> None:
    hinge = root.find("joint", "hinge")
    hinge.name = "other"
    root.worldbody.insert("geom", 0, size=[1])
    assert swing.bind(hinge).element_id == 0
    assert swing.bind(root.find("geom", "bob")).element_id == 0
    again = root.compile_model()
    assert again.bind(root.find("geom", "bob")).element_id == 1
    assert again.model.joint("other").id == again.bind(hinge).element_id


def test_what_came_after_is_told(root: RootElement, swing: Physics) -> None:
    late = root.worldbody.add("geom", name="late", size=[1])
    with pytest.raises(MjcfError, match="`<geom>` `late` came after the model was compiled") as caught:
        swing.bind(late)
    assert caught.value.diagnostics[0].help == "compile it again"
    hand = mjcf.RootElement("hand")
    geom = hand.worldbody.add("geom", name="bob", size=[1])
    root.worldbody.attach(hand)
    with pytest.raises(MjcfError, match="`bob` is of the model `hand`, which was not compiled here"):
        swing.bind(geom)


def test_what_was_removed_is_told(root: RootElement, swing: Physics) -> None:
    bob = root.find("geom", "bob")
    swing.bind(bob)
    bob.remove()
    with pytest.raises(MjcfError, match="`<geom>` was removed from its model"):
        swing.bind(bob)


def test_attached_and_detached_models(arm: RootElement, gripper: RootElement) -> None:
    frame = arm.find("site", "flange").attach(gripper)
    slide = frame.add("joint", type="slide")
    named = frame.add("joint", name="turn")
    physics = arm.compile_model()
    assert physics.bind(frame).element_id == physics.model.body("gripper/").id
    assert physics.bind(slide).element_id == physics.model.joint("gripper/").id
    assert physics.bind(named).element_id == physics.model.joint("gripper/turn").id
    left = gripper.find("joint", "left")
    for element in (left, arm.find("joint", "gripper/left")):
        assert physics.bind(element).qposadr == physics.model.joint("gripper/left").qposadr[0]
    gripper.detach()
    assert physics.bind(left).element_id == physics.model.joint("gripper/left").id
    alone = gripper.compile_model()
    assert alone.bind(left).element_id == 0
    gripper.model = "hand"
    arm.worldbody.attach(gripper)
    assert physics.bind(left).element_id == physics.model.joint("gripper/left").id
    assert arm.compile_model().bind(left).element_id != physics.bind(left).element_id


def test_a_frame_without_a_joint_is_no_body(arm: RootElement, gripper: RootElement) -> None:
    frame = arm.worldbody.attach(gripper)
    with pytest.raises(MjcfError, match="the frame of `gripper/` is not a body of the compiled model"):
        arm.compile_model().bind(frame)


def test_the_world_of_what_is_attached_is_no_body(arm: RootElement, gripper: RootElement) -> None:
    arm.worldbody.attach(gripper)
    with pytest.raises(MjcfError, match="`gripper` is attached, so its world is not a body of the compiled model"):
        arm.compile_model().bind(gripper.worldbody)


def test_nothing_is_not_bound(arm: RootElement) -> None:
    with pytest.raises(MjcfError, match="`find` returns None if no such element exists"):
        arm.compile_model().bind(arm.find("joint", "wirst"))


@pytest.mark.parametrize("number", [-1, 2**40])
def test_a_number_of_steps_that_cannot_be(arm: RootElement, number: int) -> None:
    with pytest.raises(MjcfError, match="is a number of steps"):
        arm.compile_model().step(number)


def test_text_that_is_none() -> None:
    with pytest.raises(MjcfError, match="is not Unicode text"):
        Physics.from_xml_string("<mujoco model='\ud800'/>")


def test_what_is_copied_together_stays_together(arm: RootElement, gripper: RootElement) -> None:
    """An environment that keeps a tree, its physics and bindings: copied, pickled, sent to another process."""
    arm.find("site", "flange").attach(gripper)
    physics = arm.compile_model()
    elements = [*gripper.find_all("joint"), arm.find("joint", "shoulder")]
    environment = {
        "root": arm,
        "physics": physics,
        "one": physics.bind(elements[0]),
        "scattered": physics.bind(elements),
        "none": physics.bind([]),
        "elements": elements,
    }
    environment["one"].qpos = 0.02
    for copied in (copy.deepcopy, lambda each: pickle.loads(pickle.dumps(each))):
        twin = copied(environment)
        assert twin["one"].qpos == 0.02 and twin["none"].qpos.shape == (0,)
        twin["scattered"].qpos = [0.01, 0.03, 0.5]
        assert twin["one"].qpos == 0.01 and environment["one"].qpos == 0.02
        assert twin["physics"].bind(twin["elements"]).qpos.tolist() == [0.01, 0.03, 0.5]
        assert twin["physics"].bind(twin["elements"][0].root.find_all("geom")[1]).size.tolist()
        assert np.shares_memory(twin["one"].qpos, twin["physics"].data.qpos)
        assert np.shares_memory(twin["one"].range, twin["physics"].model.jnt_range)
        assert repr(twin["scattered"]) == repr(environment["scattered"])


def test_an_attached_model_compiles_alone(arm: RootElement, gripper: RootElement) -> None:
    arm.find("site", "flange").attach(gripper)
    physics = gripper.compile_model()
    assert physics.model.joint("left").id == physics.bind(gripper.find("joint", "left")).element_id
    with pytest.raises(MjcfError, match="of the model `arm`, which was not compiled here"):
        physics.bind(arm.find("joint", "shoulder"))


def test_the_world_is_a_body(root: RootElement, swing: Physics) -> None:
    assert swing.bind(root.worldbody).element_id == 0
    assert swing.bind(root.find_all("body")).xpos.tolist() == [[0, 0, 1]]


def test_what_is_no_object_of_a_compiled_model(root: RootElement, swing: Physics) -> None:
    frame = root.worldbody.add("frame")
    for element in (root, root.option, frame, root.default.geom):
        with pytest.raises(MjcfError, match="is not an object of a compiled model"):
            swing.bind(element)


def test_what_cannot_be_bound_together_or_at_all(root: RootElement, swing: Physics) -> None:
    hinge = root.find("joint", "hinge")
    bob = root.find("geom", "bob")
    with pytest.raises(MjcfError, match="one kind are bound together, got the joint `<joint>` `hinge` and the geom"):
        swing.bind([hinge, bob])
    for wrong in ("hinge", None, 3, [hinge, None]):
        with pytest.raises(MjcfError, match="elements are bound, or sequences of them, got"):
            swing.bind(wrong)  # type: ignore[arg-type]


def test_physics_of_text_binds_by_name(root: RootElement, tmp_path: Path) -> None:
    (tmp_path / "model.xml").write_text(PENDULUM)
    mujoco.mj_saveModel(root.compile_model().model, str(tmp_path / "model.mjb"), None)
    for physics in (
        Physics.from_xml_string(PENDULUM),
        Physics.from_path(tmp_path / "model.xml"),
        Physics.from_path(str(tmp_path / "model.mjb")),
    ):
        physics.bind(root.find("joint", "hinge")).qpos = 0.5
        assert physics.data.qpos[0] == 0.5
        assert physics.bind(root.find_all("key")[1]).qpos[0] == 0.5
        stranger = mjcf.from_xml_string('<mujoco><worldbody><site name="eye"/></worldbody></mujoco>')
        with pytest.raises(MjcfError, match="the compiled model has no site `eye`"):
            physics.bind(stranger.find("site", "eye"))


def test_physics_of_text_that_is_wrong(tmp_path: Path) -> None:
    with pytest.raises(MjcfError, match="size 0 must be positive"):
        Physics.from_xml_string('<mujoco><worldbody><geom size="0"/></worldbody></mujoco>')
    with pytest.raises(MjcfError, match="the file .* does not exist"):
        Physics.from_path(tmp_path / "nowhere.xml")
    (tmp_path / "bad.xml").write_text("<mujoco><worldbdy/></mujoco>")
    with pytest.raises(MjcfError, match="worldbdy|unrecognized"):
        Physics.from_path(tmp_path / "bad.xml")


def test_physics_of_mujocos_objects(root: RootElement) -> None:
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    data = mujoco.MjData(model)
    data.qpos[0] = 0.75
    physics = Physics(model, data)
    assert physics.model is model and physics.data is data
    assert physics.bind(root.find("joint", "hinge")).qpos[0] == 0.75


def test_only_a_model_is_compiled(root: RootElement) -> None:
    with pytest.raises(MjcfError, match="what is compiled is a `RootElement`, got `Worldbody`"):
        Physics.from_mjcf_model(root.worldbody)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda physics: physics.step(1.5), "`n` expects an integer, got `1.5`"),
        (lambda physics: physics.step("2"), "`n` expects an integer, got `'2'`"),
        (lambda physics: physics.step(-1), "`n` is a number of steps, got `-1`"),
        (lambda physics: setattr(physics, "time", "now"), "`time` expects a number of seconds, got `'now'`"),
        (lambda physics: setattr(physics, "time", math.nan), "`time` expects a number of seconds, got `nan`"),
        (lambda physics: setattr(physics, "timestep", 0), "`timestep` must be greater than zero"),
        (lambda physics: setattr(physics, "timestep", math.inf), "`timestep` expects a number of seconds"),
        (lambda physics: mjcf.Physics(None), "`model` expects an `MjModel`, got `NoneType`"),
        (lambda physics: mjcf.Physics(physics.model, 3), "`data` expects an `MjData`, got `int`"),
        (lambda physics: mjcf.Physics.from_xml_string(None), "`xml_string` expects text, got `NoneType`"),
        (lambda physics: mjcf.Physics.from_xml_string("<mujoco/>", [1]), "`assets` expects bytes by path"),
        (lambda physics: mjcf.Physics.from_path(None), "`path` expects a path, got `NoneType`"),
    ],
)
def test_what_is_no_argument_is_told_at_the_call(call: Callable[[Physics], None], said: str, swing: Physics) -> None:
    before = (swing.time, swing.timestep)
    with pytest.raises(mjcf.MjcfError) as caught:
        call(swing)
    (fault,) = caught.value.diagnostics
    assert said in fault.message and fault.span is not None and fault.span.file == __file__
    assert (swing.time, swing.timestep) == before


def test_a_legacy_step_leaves_positions_and_sensors_up_to_date() -> None:
    text = """<mujoco><worldbody><body name="b"><freejoint/><geom size=".1"/></body></worldbody>
    <sensor><framepos objtype="body" objname="b"/></sensor></mujoco>"""
    plain = Physics.from_xml_string(text)
    legacy = Physics.from_xml_string(text)
    legacy.legacy_step = True
    copies = (legacy.copy(), copy.deepcopy(legacy), pickle.loads(pickle.dumps(legacy)))
    for each in (plain, legacy, *copies):
        each.step(3)
        assert np.array_equal(each.data.qpos, plain.data.qpos)
        assert np.array_equal(each.data.sensordata, each.data.qpos[:3]) == (each is not plain)


def test_what_a_model_reads_is_confined_on_request(tmp_path: Path) -> None:
    shapes = tmp_path / "elsewhere" / "deep"
    model = tmp_path / "robot" / "mjcf" / "arm.xml"
    for file in (shapes / "m.obj", model):
        file.parent.mkdir(parents=True)
    (tmp_path / "robot" / ".git").mkdir()
    (shapes / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n")
    model.write_text(
        f"""<mujoco><asset><mesh name="m" file="{shapes}/m.obj"/></asset>
        <worldbody><geom type="mesh" mesh="m"/></worldbody></mujoco>"""
    )
    text = model.read_text()
    assert mjcf.from_path(model).compile_model().model.nmesh == 1
    assert mjcf.from_xml_string(text).compile_model().model.nmesh == 1
    assert Physics.from_path(model).model.nmesh == 1
    assert Physics.from_path(model, confine_to=[tmp_path]).model.nmesh == 1
    for read in (mjcf.from_path, Physics.from_path):
        with pytest.raises(MjcfError, match=r"confine_to=\[…, '.*deep'\]"):
            read(model, confine_to=[model.parent]).assets  # noqa: B018
    with model.open() as file, pytest.raises(MjcfError, match="all that `confine_to` names"):
        mjcf.from_file(file, confine_to=[]).assets  # noqa: B018


def test_an_error_about_a_limit_says_what_a_program_writes(tmp_path: Path) -> None:
    with allow(elements=3), pytest.raises(MjcfError) as caught:
        mjcf.from_xml_string("<mujoco><worldbody><body/><body/><body/></worldbody></mujoco>")
    (help,) = {each.help for each in caught.value.diagnostics}
    assert (
        help is not None
        and "`with mjcompose.base.limits.allow(elements=" in help
        and "--limit" not in str(caught.value)
    )

from __future__ import annotations

import copy
import os
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree
from mjcompose import mjcf
from mjcompose.mjcf import RootElement
from sampling import without_meshes

Differences = Callable[[mujoco.MjModel, mujoco.MjModel], list[str]]
Check = Callable[[RootElement], None]

CLASSES = """
<mujoco><compiler angle="degree"/>
<default>
  <geom friction="1 0.02 0.003" rgba="1 0 0 1" quat="0 1 0 0"/>
  <joint damping="2" solreflimit="0.1 0.9"/>
  <position kp="7"/>
  <default class="soft"><geom friction="0.5" euler="90 0 0"/><joint damping="3" range="-10 10"/><tendon width="0.1"/>
    <default class="softer"><geom friction="0.25"/><motor gear="5"/></default></default>
</default>
<worldbody>
  <geom name="plain" size="1"/>
  <geom name="own" size="1" friction="9" euler="0 0 10"/>
  <body name="b" childclass="soft">
    <joint name="j"/><joint name="k" class="softer" axis="0 1 0" damping="8"/>
    <frame childclass="softer"><geom name="inner" size="1"/></frame>
    <geom name="soft" size="1"/><site name="s"/><site name="t" pos="1 0 0"/>
  </body>
</worldbody>
<tendon><spatial name="te" class="soft"><site site="s"/><site site="t"/></spatial></tendon>
<actuator><position name="p" joint="j"/><motor name="m" joint="k"/><motor name="x" joint="k" class="softer"/></actuator>
</mujoco>
"""


def _same(model: RootElement) -> None:
    before = model.compile_model(conflict="base").model
    mjcf.commit_defaults(model)
    after = model.compile_model(conflict="base").model
    fields = before._all_fields if hasattr(before, "_all_fields") else dir(before)
    for name in fields:
        array = getattr(before, name)
        if isinstance(array, np.ndarray):
            np.testing.assert_array_equal(array, getattr(after, name), name)


@pytest.fixture
def model() -> RootElement:
    return mjcf.from_xml_string(CLASSES)


def test_the_compiled_model_does_not_change(model: RootElement) -> None:
    _same(model)


def test_values_stand_on_the_elements(model: RootElement) -> None:
    mjcf.commit_defaults(model)
    plain, own, soft, inner = (model.find("geom", name) for name in ("plain", "own", "soft", "inner"))
    assert plain.friction.tolist() == [1, 0.02, 0.003] and plain.quat.tolist() == [0, 1, 0, 0]
    assert own.friction.tolist() == [9, 0.02, 0.003]
    assert own.quat is None and own.euler.tolist() == [0, 0, 10]
    assert soft.friction.tolist() == [0.5, 0.02, 0.003]
    assert soft.quat is None and soft.euler.tolist() == [90, 0, 0]
    assert inner.friction.tolist() == [0.25, 0.02, 0.003] and inner.rgba.tolist() == [1, 0, 0, 1]
    assert (model.find("joint", "j").damping, model.find("joint", "k").damping) == (3, 8)
    assert model.find("joint", "k").range.tolist() == [-10, 10]
    assert model.find("tendon", "te").width == 0.1
    assert model.find("actuator", "p").kp == 7


def _of_actuators(classes: str, actuator: str) -> RootElement:
    return mjcf.from_xml_string(
        f'<mujoco><default>{classes}</default><worldbody><body><joint name="j"/><geom size="1"/>'
        f'<site name="s"/></body></worldbody><actuator>{actuator}</actuator></mujoco>'
    )


@pytest.fixture
def needs_no_class(differences: Differences) -> Callable[[RootElement], None]:
    def check(model: RootElement) -> None:
        expected = model.compile_model().model
        mjcf.commit_defaults(model)
        assert differences(expected, model.compile_model().model) == []
        assert differences(expected, _without_classes(model)) == []

    return check


@pytest.mark.parametrize(
    ("classes", "actuator"),
    [
        ('<general biastype="affine" ctrlrange="-2 2"/><position forcerange="-3 3"/>', '<position joint="j" kv="2"/>'),
        ('<general biastype="affine"/><position forcerange="-3 3"/>', '<general joint="j" gainprm="3"/>'),
        ('<position kp="7"/><motor gear="5"/>', '<position joint="j"/>'),
        ('<muscle range="0.1 0.9"/>', '<muscle joint="j" scale="100" lengthrange="0.1 1"/>'),
        ('<damper kv="3"/>', '<damper joint="j" ctrlrange="0 1"/>'),
        ('<cylinder diameter="0.5"/>', '<cylinder joint="j" area="2"/>'),
        ('<position kv="3"/>', '<position joint="j" dampratio="1"/>'),
    ],
)
def test_what_actuators_are_given_can_be_written_on_them(classes: str, actuator: str, needs_no_class: Check) -> None:
    model = _of_actuators(classes, actuator)
    before = model.actuator.all_children()[0].tag
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        needs_no_class(model)
    assert model.actuator.all_children()[0].tag == before


def test_what_the_tag_cannot_say_makes_it_a_general(needs_no_class: Check) -> None:
    model = _of_actuators('<position kp="7"/><general gainprm="3"/>', '<position name="p" joint="j" ctrlrange="0 1"/>')
    actuator = model.find("position", "p")
    joint = model.find("joint", "j")
    with pytest.warns(mjcf.MjcfWarning, match=r"`<position>` `p` is written as a `general`"):
        needs_no_class(model)
    assert model.find("position") is None and model.find("general", "p") is actuator
    assert actuator.tag == "general" and actuator.gainprm[0] == 3 and actuator.biasprm[1] == -3
    assert actuator.joint is joint
    joint.name = "k"
    assert actuator.joint is joint and actuator.ctrlrange.tolist() == [0, 1]


def test_a_crank_length_is_written_where_there_is_a_crank() -> None:
    """MuJoCo lets a class give it to any actuator, where nothing looks at it, and refuses it on the element."""
    model = _of_actuators('<position cranklength="3"/>', '<position name="p" joint="j" kp="4"/>')
    _same(model)
    assert model.find("position", "p").cranklength is None


def test_a_class_of_an_attached_model_gives_what_it_says() -> None:
    model = _of_actuators("", '<position name="p" joint="j"/>')
    child = mjcf.RootElement("child")
    model.default.geom.rgba = [1, 0, 0, 1]
    model.default.position.kp = 3
    child.default.geom.rgba = [0, 1, 0, 1]
    strong = child.default.add("default", dclass="strong")
    strong.add("position", kp=7)
    strong.add("motor", gear=[5])
    child.worldbody.add("body", name="palm").add("geom", size=[1])
    model.attach(child)
    geom = model.find("geom")
    actuator = model.find("actuator", "p")
    geom.dclass = child.default
    actuator.dclass = strong
    assert (geom._node.get("class"), actuator._node.get("class")) == ("child/", "child/strong")
    _same(model)
    assert geom.rgba.tolist() == [0, 1, 0, 1] and actuator.gear.tolist() == [5]
    assert actuator._node.get("class") == "child/strong"


def test_an_actuator_that_goes_on_needing_its_class_is_told() -> None:
    model = _of_actuators('<position inheritrange="0.5" gear="2"/>', '<motor name="m" joint="j"/>')
    with pytest.warns(mjcf.MjcfWarning, match=r"`<motor>` `m` still needs its default class"):
        _same(model)
    assert model.find("motor", "m").gear.tolist() == [2]


def test_an_actuator_that_a_class_only_names_stays_one(needs_no_class: Check) -> None:
    """What is in a default class counts even where it says nothing but a tag."""
    model = _of_actuators('<position kp="7"/><motor/>', '<position joint="j"/>')
    assert mujoco.MjModel.from_xml_string(model.to_xml_string()).actuator_gainprm[0, 0] == 1
    needs_no_class(model)
    other = _of_actuators('<position kp="7"/>', '<position joint="j"/>')
    assert other.default.motor is not None, "only looked at"
    assert mujoco.MjModel.from_xml_string(other.to_xml_string()).actuator_gainprm[0, 0] == 7
    other.default.add("motor")
    assert mujoco.MjModel.from_xml_string(other.to_xml_string()).actuator_gainprm[0, 0] == 1


@pytest.mark.parametrize(
    ("classes", "body"),
    [
        ('<camera sensorsize="1 2" focal="1 1" resolution="4 4"/>', '<camera fovy="20"/>'),
        ('<camera fovy="20"/>', '<camera sensorsize="1 2" focal="1 1" resolution="4 4"/>'),
        ('<light directional="true"/>', '<light type="spot"/>'),
        ('<light type="point"/>', '<light directional="true"/>'),
    ],
)
def test_of_two_ways_to_say_a_thing_one_is_written(classes: str, body: str, needs_no_class: Check) -> None:
    needs_no_class(mjcf.from_xml_string(f"<mujoco><default>{classes}</default><worldbody>{body}</worldbody></mujoco>"))


def test_an_empty_reference_takes_back_what_a_class_above_gives(needs_no_class: Check) -> None:
    needs_no_class(
        mjcf.from_xml_string("""<mujoco>
          <default><geom material="m"/><default class="bare"><geom material=""/></default></default>
          <asset><material name="m" rgba="1 0 0 1"/></asset>
          <worldbody><geom size="1"/><geom size="1" class="bare"/><geom size="1" material=""/></worldbody></mujoco>""")
    )


def test_one_length_of_a_spring_stands_for_both() -> None:
    model = mjcf.from_xml_string(CLASSES)
    model.default.tendon.springlength = [0.1, 0.2]
    model.find("tendon", "te").springlength = [0.3]
    _same(model)
    assert model.find("tendon", "te").springlength.tolist() == [0.3]


def _class_wins_over_no_texture() -> bool:
    compiled = mujoco.MjModel.from_xml_string(
        '<mujoco><default><material texture="t"/></default><asset>'
        '<texture name="t" type="2d" builtin="flat" width="8" height="8"/><material texture="" name="m"/></asset></mujoco>'
    )
    return bool(compiled.mat_texid.max() == 0)


@pytest.mark.parametrize(
    ("classes", "material"),
    [
        ('<material texture="t"/>', '<material name="m"/>'),
        ('<material texture="t"/>', '<material name="m" texture="u"/>'),
        ('<material texture="t"/>', '<material name="m" texture=""/>'),
        ('<material texture="t"/>', '<material name="m"><layer texture="u" role="roughness"/></material>'),
        ('<material texture="t"/>', '<material name="m"><layer texture="u" role="rgb"/></material>'),
        ('<material><layer texture="t" role="orm"/></material>', '<material name="m" texture="u"/>'),
        ('<material><layer texture="t" role="orm"/></material>', '<material name="m"/>'),
        ('<material><layer texture="t" role="orm"/></material>', '<material name="m" texture=""/>'),
    ],
)
def test_textures_of_materials_by_role(classes: str, material: str, needs_no_class: Check) -> None:
    texture = 'type="2d" builtin="flat" width="8" height="8"'
    model = mjcf.from_xml_string(
        f'<mujoco><default>{classes}</default><asset><texture name="t" {texture}/><texture name="u" {texture}/>'
        f"{material}</asset></mujoco>"
    )
    if 'texture=""' in material and _class_wins_over_no_texture():
        pytest.skip("this MuJoCo takes an empty texture for none given: 3.12 does")
    needs_no_class(model)
    model.find("texture", "t").name = "other"
    assert '"t"' not in model.to_xml_string()


def test_one_element_and_what_is_below_it(model: RootElement) -> None:
    mjcf.commit_defaults(model.find("body", "b"))
    assert model.find("geom", "soft").rgba is not None
    assert model.find("geom", "plain").rgba is None
    mjcf.commit_defaults(model.find("geom", "plain"))
    assert model.find("geom", "plain").rgba is not None


def test_some_attributes_alone(model: RootElement) -> None:
    expected = copy.deepcopy(model)
    mjcf.commit_defaults(expected)
    before = model.compile_model().model
    mjcf.commit_defaults(model, attributes=["friction", "damping", "kp"])
    for tag in ("geom", "joint", "actuator"):
        for element in model.find_all(tag):
            whole = expected.find(tag, element.name).get_attributes()  # type: ignore[union-attr]
            for name in ("friction", "damping", "kp"):
                assert str(element.get(name)) == str(whole.get(name)), (element, name)
    soft = model.find("geom", "soft")
    assert soft is not None and soft.euler is None and soft.rgba is None
    after = model.compile_model().model
    assert before.geom_friction.tobytes() == after.geom_friction.tobytes()
    assert before.geom_quat.tobytes() == after.geom_quat.tobytes()


def test_some_attributes_of_an_actuator_whose_class_speaks_of_others() -> None:
    """It stays what it is, without a warning: it was not asked to do without its class."""
    model = mjcf.from_xml_string(
        '<mujoco><default><general forcerange="-1 1"/><motor gear="3"/><velocity kv="4"/></default>'
        '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
        '<actuator><motor name="m" joint="j"/></actuator></mujoco>'
    )
    before = model.compile_model().model
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mjcf.commit_defaults(model, attributes=("forcerange",))
    motor = model.find("actuator", "m")
    assert motor is not None and motor.get_attributes().keys() == {"name", "joint", "forcerange"}
    after = model.compile_model().model
    for name in ("actuator_gear", "actuator_forcerange", "actuator_gainprm", "actuator_biasprm"):
        assert getattr(before, name).tobytes() == getattr(after, name).tobytes()


def test_an_attribute_that_no_class_gives_is_reported(model: RootElement) -> None:
    before = model.to_xml_string()
    with pytest.raises(mjcf.MjcfError, match="default classes give no element an attribute `frction`") as caught:
        mjcf.commit_defaults(model, attributes=["rgba", "frction"])
    assert caught.value.diagnostics[0].help == "did you mean `friction`?"
    with pytest.raises(mjcf.MjcfError, match="`attributes` expects a list of names"):
        mjcf.commit_defaults(model, attributes="rgba")
    assert model.to_xml_string() == before


def test_classes_stay(model: RootElement) -> None:
    before = model.default.geom.rgba.tolist()
    mjcf.commit_defaults(model)
    assert model.default.geom.rgba.tolist() == before and model.default.geom.pos is None


def test_references_that_a_class_gives_follow_a_new_name() -> None:
    model = mjcf.from_xml_string(
        '<mujoco><default><geom material="m"/></default><asset><material name="m"/></asset>'
        '<worldbody><geom name="g" size="1"/></worldbody></mujoco>'
    )
    mjcf.commit_defaults(model)
    model.find("material", "m").name = "other"
    assert model.find("geom", "g").material is model.find("material", "other")


def test_attached_models_and_the_joints_between(arm: RootElement, gripper: RootElement) -> None:
    joint = arm.find("site", "flange").attach(gripper).add("joint", type="hinge")
    _same(arm)
    assert joint.damping == 2
    assert gripper.find("geom", "palm").friction.tolist() == [0.9, 0.01, 0.001]
    assert gripper.find("joint", "left").range.tolist() == [0, 0.03]


@pytest.mark.parametrize(
    "name", ["franka_emika_panda/panda.xml", "wonik_allegro/left_hand.xml", "mujoco_model/humanoid/humanoid.xml"]
)
def test_robots(name: str, corpus: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        _same(mjcf.from_path(corpus / "models" / name))


def _without_classes(model: RootElement) -> mujoco.MjModel:
    root = etree.fromstring(model.to_xml_string().encode())
    for section in root.findall("default"):
        root.remove(section)
    for node in root.iter("*"):
        for attribute in ("class", "childclass"):
            node.attrib.pop(attribute, None)
    return mujoco.MjModel.from_xml_string(etree.tostring(root, encoding="unicode"), model.assets)


def _folders() -> list[str]:
    """The folders of the corpus: of models one by one, so that none takes long; none where there is no corpus."""
    corpus = Path(os.environ.get("MJCOMPOSE_CORPUS", "nowhere"))
    models = [f"models/{folder.name}" for folder in corpus.glob("models/*") if folder.is_dir()]
    cases = [f"feature-cases/{folder.name[0]}*" for folder in corpus.glob("feature-cases/*")]
    return sorted({*models, *cases})


def _read(path: Path) -> tuple[mujoco.MjModel, RootElement] | None:
    try:
        return mujoco.MjModel.from_xml_path(str(path)), mjcf.from_path(path)
    except ValueError:
        return None


@pytest.mark.slow
@pytest.mark.parametrize("folder", _folders())
def test_no_class_is_needed_afterwards(folder: str, corpus: Path, differences: Differences, tmp_path: Path) -> None:
    """Of every model that MuJoCo reads; `mjx_panda` and its scenes have gains of two tags in one class."""
    if folder.startswith("models"):
        shutil.copytree(corpus / folder, tmp_path / folder, copy_function=without_meshes)
    for path in sorted(path for each in corpus.glob(folder) for path in each.rglob("*.xml")):
        if (read := _read(tmp_path / path.relative_to(corpus)) or _read(path)) is None:
            continue
        expected, model = read
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mjcf.commit_defaults(model)
        committed = mujoco.MjModel.from_xml_string(model.to_xml_string(), model.assets)
        assert differences(expected, committed) == differences(expected, _without_classes(model)) == [], path

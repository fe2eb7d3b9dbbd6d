from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import numpy as np
import pytest
from lxml import etree

from composer import mjcf
from composer.mjcf import RootElement

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
    before = model.compile_model(conflict="warning").model
    mjcf.commit_defaults(model)
    after = model.compile_model(conflict="warning").model
    for name in before._all_fields if hasattr(before, "_all_fields") else dir(before):
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


def test_of_mixed_classes_actuators_take_what_all_of_them_have(model: RootElement) -> None:
    model.default.add("general", ctrlrange=[-2, 2], gainprm=[3])
    mjcf.commit_defaults(model)
    x, p = model.find("actuator", "x"), model.find("actuator", "p")
    assert x.gear.tolist() == [5] and x.ctrlrange.tolist() == p.ctrlrange.tolist() == [-2, 2]
    assert p.kp is None


def test_one_element_and_what_is_below_it(model: RootElement) -> None:
    mjcf.commit_defaults(model.find("body", "b"))
    assert model.find("geom", "soft").rgba is not None
    assert model.find("geom", "plain").rgba is None
    mjcf.commit_defaults(model.find("geom", "plain"))
    assert model.find("geom", "plain").rgba is not None


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
    "name",
    ["franka_emika_panda/panda.xml", "wonik_allegro/left_hand.xml", "mujoco_model/humanoid/humanoid.xml"],
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


@pytest.mark.slow
def test_no_class_is_needed_afterwards(corpus: Path) -> None:
    """What a class says of another tag's gains is an exception that none of these has."""
    robots = ["franka_emika_panda/panda.xml", "wonik_allegro/left_hand.xml", "kuka_iiwa_14/iiwa14.xml"]
    paths = [corpus / "models" / name for name in robots] + sorted(
        (corpus / "feature-cases").glob("*/child.xml")
    )
    tried = 0
    for path in paths:
        try:
            expected = mujoco.MjModel.from_xml_path(str(path))
        except ValueError:
            continue
        model = mjcf.from_path(path)
        mjcf.commit_defaults(model)
        committed = mujoco.MjModel.from_xml_string(model.to_xml_string(), model.assets)
        for found in (committed, _without_classes(model)):
            for name in dir(expected):
                value = getattr(expected, name)
                if isinstance(value, np.ndarray) and "path" not in name and not name.startswith("_"):
                    np.testing.assert_array_equal(value, getattr(found, name), f"{path} {name}")
        tried += 1
    assert tried > 50

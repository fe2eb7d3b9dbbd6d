"""Facts of a compiled model, read in this process."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from composer.engine import facts

mujoco = pytest.importorskip("mujoco")


def model(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


def test_every_kind_of_name_is_the_one_mujoco_gives() -> None:
    text = """<mujoco><asset><texture name="t" builtin="flat" type="2d" width="8" height="8"/>
      <material name="m" texture="t"/><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/></asset>
      <worldbody><light name="l"/><camera name="c"/><body name="b"><joint name="j"/><geom name="g" size="1"/>
      <site name="s"/></body></worldbody>
      <contact><exclude name="e" body1="world" body2="b"/><pair name="p" geom1="g" geom2="g"/></contact>
      <tendon><fixed name="f"><joint joint="j" coef="1"/></fixed></tendon>
      <equality><joint name="q" joint1="j"/></equality><actuator><motor name="a" joint="j"/></actuator>
      <sensor><clock name="z"/></sensor><keyframe><key name="k"/></keyframe>
      <custom><numeric name="n" data="1"/><text name="x" data="y"/>
      <tuple name="u"><element objtype="body" objname="b"/></tuple></custom></mujoco>"""
    compiled = model(text.replace('<pair name="p" geom1="g" geom2="g"/>', ""))
    objects = {
        "body": "BODY", "joint": "JOINT", "geom": "GEOM", "site": "SITE", "camera": "CAMERA",
        "light": "LIGHT", "texture": "TEXTURE",
        "material": "MATERIAL", "hfield": "HFIELD", "exclude": "EXCLUDE",
        "tendon": "TENDON", "equality": "EQUALITY", "actuator": "ACTUATOR", "sensor": "SENSOR", "key": "KEY",
        "numeric": "NUMERIC", "text": "TEXT", "tuple": "TUPLE",
    }  # fmt: skip
    found = facts.all_names(compiled)
    for kind, word in objects.items():
        kind_id = getattr(mujoco.mjtObj, f"mjOBJ_{word}")
        assert found[kind], kind
        assert found[kind] == [mujoco.mj_id2name(compiled, kind_id, row) for row in range(len(found[kind]))]
    assert found["mesh"] == []


def test_every_table_of_names_is_an_attribute_of_the_model() -> None:
    compiled = model("<mujoco/>")
    assert [name for name in facts.NAME_ADDRESSES.values() if not hasattr(compiled, name)] == []


def test_a_version_that_counts_no_actuators_apart_from_controls() -> None:
    old = SimpleNamespace(nq=0, nu=2, names=b"a\0b\0", name_actuatoradr=[0, 2], actuator_actadr=[-1, 0])
    old.actuator_actnum = [0, 1]
    old.actuator_dyntype = [int(mujoco.mjtDyn.mjDYN_MUSCLE)] * 2
    old.actuator_ctrllimited, old.actuator_ctrlrange = [1, 0], [[0, 2], [0, 0]]
    old.actuator_actlimited = old.actuator_forcelimited = [0, 0]
    assert facts.sizes(old) == {"nq": 0, "nu": 2, "nactuator": 2}
    free = {"unit": "1", "act_range": None, "force_range": None}
    assert facts._actuators(old, mujoco) == [
        {"name": "a", "ctrl": [0, 1], "act": [-1, 0], "ctrl_ranges": [[0, 2]], **free},
        {"name": "b", "ctrl": [1, 1], "act": [0, 1], "ctrl_ranges": [None], **free},
    ]


def test_types_of_sensors_are_the_tags_of_mjcf() -> None:
    text = """<mujoco><worldbody><body name="b"><joint name="j" range="0 1"/><geom name="g" size="1"/>
      <site name="s"/></body><geom name="h" size="1"/><camera name="c" resolution="9 9"/></worldbody>
      <tendon><fixed name="t" range="0 1" limited="true"><joint joint="j" coef="1"/></fixed></tendon>
      <sensor>{}</sensor></mujoco>"""
    lines = {
        "camprojection": 'site="s" camera="c"', "jointactuatorfrc": 'joint="j"',
        "tendonactuatorfrc": 'tendon="t"', "jointlimitpos": 'joint="j"',
        "tendonlimitfrc": 'tendon="t"', "distance": 'geom1="g" geom2="h"',
        "normal": 'geom1="g" geom2="h"', "fromto": 'geom1="g" geom2="h"', "e_potential": "", "clock": "",
        "insidesite": 'site="s" objtype="body" objname="b"', "user": 'dim="2"', "subtreecom": 'body="b"',
        "framexaxis": 'objtype="geom" objname="g"', "velocimeter": 'site="s"', "contact": 'geom1="g"',
    }  # fmt: skip
    sensors = "".join(f"<{tag} {attributes}/>" for tag, attributes in lines.items())
    index = facts.index(model(text.format(sensors)), mujoco)
    assert [sensor["type"] for sensor in index["sensors"]] == list(lines)

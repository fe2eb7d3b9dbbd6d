"""Facts of a compiled model, read in this process."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from mjcompose.mujoco import attributes

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
        "body": "BODY",
        "joint": "JOINT",
        "geom": "GEOM",
        "site": "SITE",
        "camera": "CAMERA",
        "light": "LIGHT",
        "texture": "TEXTURE",
        "material": "MATERIAL",
        "hfield": "HFIELD",
        "exclude": "EXCLUDE",
        "tendon": "TENDON",
        "equality": "EQUALITY",
        "actuator": "ACTUATOR",
        "sensor": "SENSOR",
        "key": "KEY",
        "numeric": "NUMERIC",
        "text": "TEXT",
        "tuple": "TUPLE",
    }
    found = attributes.NameTable(compiled).names
    for kind, word in objects.items():
        kind_id = getattr(mujoco.mjtObj, f"mjOBJ_{word}")
        assert found[kind], kind
        assert found[kind] == [mujoco.mj_id2name(compiled, kind_id, row) for row in range(len(found[kind]))]
    assert found["mesh"] == []


def test_a_version_that_counts_no_actuators_apart_from_controls() -> None:
    assert attributes.sizes(SimpleNamespace(nq=0, nu=2)) == {"nq": 0, "nu": 2, "nactuator": 2}

from __future__ import annotations

import json
from dataclasses import asdict
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
from mjcompose.mujoco.index import (
    CompiledActuator,
    CompiledCamera,
    CompiledIndex,
    CompiledJoint,
    CompiledKeyframe,
    CompiledSensor,
    _actuators,
    index,
)


def model(text: str) -> Any:
    return mujoco.MjModel.from_xml_string(text)


def test_it_is_made_from_what_the_child_sends() -> None:
    made = CompiledIndex(
        joints=(CompiledJoint("j", "ball", 7, 4, 6, 3, True, (0, 1), "b"),),
        actuators=(CompiledActuator("a", 2, 3, 4, 5, "rad", (None, (0, 1), None), None, (-1, 1), 8.0, "j"),),
        sensors=(CompiledSensor("s", "gyro", 8, 3, "rad/s"),),
        keyframes=(CompiledKeyframe("k", 0.5),),
        cameras=(CompiledCamera("c", "b", 45, "deg", (4, 3)),),
        bodies=("world", "b"),
    )
    assert CompiledIndex.from_data(json.loads(json.dumps(asdict(made)))) == made


def test_a_version_in_which_an_actuator_has_one_control() -> None:
    old = SimpleNamespace(nq=0, nu=2, names=b"a\0b\0", name_actuatoradr=[0, 2], actuator_actadr=[-1, 0])
    old.name_jntadr = []
    old.actuator_actnum = [0, 1]
    old.actuator_dyntype = [int(mujoco.mjtDyn.mjDYN_MUSCLE)] * 2
    old.actuator_ctrllimited = [1, 0]
    old.actuator_ctrlrange = [[0, 2], [0, 0]]
    old.actuator_trntype = [3, 3]
    old.actuator_trnid = np.array([[0, -1], [0, -1]])
    old.actuator_actlimited = old.actuator_forcelimited = [0, 0]
    assert list(_actuators(old, mujoco)) == [
        CompiledActuator("a", 0, 1, -1, 0, "1", ((0.0, 2.0),)),
        CompiledActuator("b", 1, 1, 0, 1, "1", (None,)),
    ]


def test_types_of_sensors_are_the_tags_of_mjcf() -> None:
    text = """<mujoco><worldbody><body name="b"><joint name="j" range="0 1"/><geom name="g" size="1"/>
      <site name="s"/></body><geom name="h" size="1"/><camera name="c" resolution="9 9"/></worldbody>
      <tendon><fixed name="t" range="0 1" limited="true"><joint joint="j" coef="1"/></fixed></tendon>
      <sensor>{}</sensor></mujoco>"""
    lines = {
        "camprojection": 'site="s" camera="c"',
        "jointactuatorfrc": 'joint="j"',
        "tendonactuatorfrc": 'tendon="t"',
        "jointlimitpos": 'joint="j"',
        "tendonlimitfrc": 'tendon="t"',
        "distance": 'geom1="g" geom2="h"',
        "normal": 'geom1="g" geom2="h"',
        "fromto": 'geom1="g" geom2="h"',
        "e_potential": "",
        "clock": "",
        "insidesite": 'site="s" objtype="body" objname="b"',
        "user": 'dim="2"',
        "subtreecom": 'body="b"',
        "framexaxis": 'objtype="geom" objname="g"',
        "velocimeter": 'site="s"',
        "contact": 'geom1="g"',
    }
    sensors = "".join(f"<{tag} {attributes}/>" for tag, attributes in lines.items())
    found = index(model(text.format(sensors)), mujoco)
    assert [sensor.type for sensor in found.sensors] == list(lines)

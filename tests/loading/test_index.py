from __future__ import annotations

import mujoco
import numpy as np
import pytest

from composer import engine
from composer.bundle.manifest_index import index_of
from composer.compiled.index import index as index_data
from composer.compiled.kinds import names
from composer.loading.index import Index

MODEL = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="a"><joint name="ball" type="ball" range="0 1"/><geom size="0.1"/>
      <body name="b"><joint name="slide" type="slide" range="0 2"/><joint name="hinge"/><geom size="0.1"/>
        <site name="s"/></body>
    </body>
    <body name="c"><freejoint/><geom size="0.1"/></body>
  </worldbody>
  <actuator>
    <motor name="push" joint="slide" ctrlrange="-3 3"/>
    <velocity name="spin" joint="hinge" kv="2"/>
    <intvelocity name="creep" joint="slide" kp="2" actrange="0 1"/>
    <motor name="geared" joint="hinge" gear="5"/>
    <general name="servo" joint="hinge" gainprm="4" biastype="affine" biasprm="0 -4 -1"/>
  </actuator>
  <sensor>
    <gyro name="gyro" site="s" cutoff="7"/><jointpos name="pos" joint="slide"/><actuatorfrc name="torque" actuator="spin"/>
  </sensor>
</mujoco>"""


def index(text: str = MODEL) -> Index:
    model = mujoco.MjModel.from_xml_string(text)
    listed = index_of(engine.Index.from_data(index_data(model, mujoco)))
    return Index(listed, lambda kind: names(model, kind))


def test_units_are_those_of_what_mujoco_computes() -> None:
    found = index()
    assert dict(zip(found.ctrl.names, found.ctrl.units(), strict=True)) == {
        "push": "N", "spin": "rad/s", "creep": "m/s", "geared": None, "servo": "rad",
    }  # fmt: skip
    assert found.sensordata.units() == ("rad/s", "rad/s", "rad/s", "m", "N m")
    assert found.qpos.units(["slide", "hinge"]) == ("m", "rad")
    assert found.qvel.units("ball") == ("rad/s",) * 3


def test_limits_are_of_single_numbers() -> None:
    found = index()
    assert found.qpos.limits(["slide", "hinge"]).tolist() == [[0, 2], [-np.inf, np.inf]]
    assert np.isinf(
        found.qpos.limits("ball")
    ).all()  # an angle of the whole, no bound of a quaternion's numbers
    assert found.act.limits("creep").tolist() == [[0, 1]]
    assert found.ctrl.limits("push").tolist() == [[-3, 3]]
    assert found.sensordata.limits("gyro").tolist() == [[-7, 7]] * 3


def test_a_limit_may_be_infinite() -> None:
    """MuJoCo takes `inf`, which JSON has not."""
    found = index(
        MODEL.replace('range="0 2"', 'range="-inf inf"')
        .replace('"-3 3"', '"0 inf"')
        .replace('cutoff="7"', 'cutoff="inf"')
    )
    assert found.qpos.limits("slide").tolist() == [[-np.inf, np.inf]]
    assert found.ctrl.limits("push").tolist() == [[0, np.inf]]
    assert found.sensordata.limits("gyro").tolist() == [[-np.inf, np.inf]] * 3


def test_vectors_are_addressed_as_in_the_model() -> None:
    found = index()
    assert (found.qpos["ball"], found.qpos["slide"], found.qpos.on("c")) == (slice(0, 4), 4, slice(6, 13))
    assert (found.qvel["ball"], found.qvel["hinge"], found.qvel.on("c")) == (slice(0, 3), 4, slice(5, 11))
    assert list(found.act) == ["creep"] and found.act["creep"] == 0
    assert (found.qpos.size, found.qvel.size, found.ctrl.size) == (13, 11, 5)
    assert repr(found) == "<Index: qpos 13, qvel 11, ctrl 5, act 1, sensordata 5>"


def test_a_number_is_no_name() -> None:
    with pytest.raises(TypeError, match="names are asked for"):
        index().qpos[3]  # type: ignore[index]

"""A simulator that does not take a model: the error names what it refuses, and what it says itself."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose.bundle.manifest import IndexedSensor
from mjcompose.tools.worlds.simulators import Simulator, in_scene
from mjcompose.tools.worlds.start import fixed_geoms, of_arrays, starts
from mjcompose.tools.worlds.worlds import Worlds
from tools.worlds.studies import TENDON, arm, made, refused, tables

CYLINDERS = """\
<mujoco>
  <worldbody>
    <geom name="table" type="box" size="1 1 0.1"/>
    <body name="can" pos="0 0 1"><freejoint/><geom type="cylinder" size="0.1 0.1"/></body>
    <body name="jar" pos="1 0 1"><freejoint/><geom name="jar" type="cylinder" size="0.1 0.1"/></body>
  </worldbody>
</mujoco>
"""


def put_model(_model: mujoco.MjModel) -> Any:
    raise NotImplementedError("(mjGEOM_CYLINDER, mjGEOM_BOX) collisions not implemented.")


def taken(study: Worlds) -> Any:
    return Simulator("mjx", put_model).take(study, study.nominal)


def test_the_elements_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.tools.worlds.simulators.version", lambda _: "9.0")
    with pytest.raises(mjcompose.LoadError) as caught:
        taken(made(mujoco.MjModel.from_xml_string(CYLINDERS), body_mass=(1, [1.0, 2.0])))
    help = (
        "in the recipe edit one of the two: `set: {type: capsule}`, or `set: {contype: 0, conaffinity: 0}`,"
        " and build it again; or use `worlds.mujoco`, which takes all that MuJoCo compiles"
    )
    assert str(caught.value).splitlines() == [
        "error[target-cannot]: geom #0 of body `can`: MJX cannot compute contacts of a cylinder with a box",
        "  = note: mujoco-mjx 9.0 says: (mjGEOM_CYLINDER, mjGEOM_BOX) collisions not implemented.",
        "  = note: 1 more like this:",
        "          geom `jar`",
        f"  = help: {help}",
    ]


def test_where_a_sensor_is_written() -> None:
    text = TENDON.replace("</mujoco>", '<sensor><e_kinetic name="heat"/></sensor></mujoco>')
    study = made(mujoco.MjModel.from_xml_string(text), body_mass=(1, [1.0, 2.0]))
    assert study.manifest.index is not None
    sensor = IndexedSensor(name="heat", type="e_kinetic", address=0, size=1, origin="rope.xml:7")
    index = study.manifest.index.model_copy(update={"sensors": (sensor,)})
    with pytest.raises(mjcompose.LoadError) as caught:
        taken(replace(study, manifest=study.manifest.model_copy(update={"index": index})))
    (found,) = caught.value.diagnostics
    assert found.message == "sensor `heat`: MJX has no such sensor"
    assert found.notes[0].message == "it is written in rope.xml:7"


def test_what_is_not_known_has_the_words_of_the_simulator() -> None:
    found = refused(taken, {})
    assert found.message == "MJX does not take the model of the worlds"
    assert "collisions not implemented" in found.notes[0].message


def test_a_model_that_it_takes() -> None:
    study = arm()
    assert Simulator("warp", lambda model: model.nq).take(study, study.nominal) == study.nominal.nq


SCENE = """
<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 .1"/>
    <body name="table" pos="0 0 .2">
      <geom name="top" type="box" size=".5 .5 .02"/>
      <body name="lamp" pos="0 .4 .1"><geom name="shade" size=".05"/></body>
      <body name="door" pos="1 0 0"><joint axis="0 0 1"/><geom name="leaf" size=".1"/></body>
    </body>
    <body name="goal" mocap="true"><geom name="ring" size=".1" contype="0" conaffinity="0"/></body>
    <body name="ball" pos="0 0 1"><freejoint/><geom name="ball" size=".05"/></body>
  </worldbody>
</mujoco>
"""


def test_geoms_that_no_step_of_warp_moves() -> None:
    model = mujoco.MjModel.from_xml_string(SCENE)
    assert [model.geom(number).name for number in fixed_geoms(model)] == ["floor", "top", "shade"]


def test_worlds_start_as_their_own_models() -> None:
    study = tables()
    data = [(each.qpos.copy(), each.geom_xpos.copy()) for each in starts(study.nominal, of_arrays(study.arrays), 3)]
    for world, (qpos, poses) in enumerate(data):
        model = study.model(world)
        model.geom_sameframe[:] = 0
        own = mujoco.MjData(model)
        mujoco.mj_kinematics(model, own)
        assert (qpos == own.qpos).all() and (poses == own.geom_xpos).all()
    assert np.ptp([poses[0, 2] for _, poses in data]) > 0.2


MESHES = """
<mujoco>
  <asset>{more}
    <mesh name="{prefix}a" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><mesh name="{prefix}b" vertex="0 0 0 2 0 0 0 2 0 0 0 2"/>
    <material name="{prefix}red"/><material name="{prefix}blue"/>
  </asset>
  <worldbody><body name="{prefix}part"><geom type="mesh" mesh="{prefix}a" material="{prefix}red"/></body></worldbody>
</mujoco>
"""


def test_assets_have_other_numbers_in_a_scene() -> None:
    own = mujoco.MjModel.from_xml_string(MESHES.format(prefix="", more=""))
    more = '<mesh name="floor" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><material name="floor"/><material name="wall"/>'
    scene = mujoco.MjModel.from_xml_string(MESHES.format(prefix="robot/", more=more))
    study = made(own, geom_dataid=(0, [0, 1, -1]), geom_matid=(0, [1, 0, -1]))
    for name, wanted in (("geom_dataid", [1, 2, -1]), ("geom_matid", [3, 2, -1])):
        values = study.arrays[name].values
        found = in_scene(study, name, np.arange(1), values=values, entity="robot", scene=scene)
        assert found[:, 0].tolist() == wanted
        with pytest.raises(mjcompose.LoadError, match="the scene has no"):
            in_scene(study, name, np.arange(1), values=values, entity="other", scene=scene)

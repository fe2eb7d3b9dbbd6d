from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import MjcfError, RootElement


def test_what_mujoco_refuses_is_told_at_the_element(tmp_path: Path) -> None:
    file = tmp_path / "bad.xml"
    file.write_text('<mujoco>\n<worldbody>\n<body name="b">\n<geom name="g" size="0"/>\n</body></worldbody></mujoco>')
    with pytest.raises(MjcfError, match="MuJoCo rejects the geom `g`: size 0 must be positive") as caught:
        mjcf.from_path(file).compile_model()
    diagnostic = caught.value.diagnostics[0]
    assert diagnostic.span is not None
    assert (diagnostic.span.file, diagnostic.span.line) == (str(file), 4)


def test_what_a_program_added_is_told_at_its_line() -> None:
    model = mjcf.RootElement()
    model.worldbody.add("body", name="b").add("freejoint")
    with pytest.raises(MjcfError, match="mass and inertia of moving bodies") as caught:
        model.compile_model()
    span = caught.value.diagnostics[0].span
    assert span is not None and span.file == __file__


def test_faults_of_the_composition_come_first() -> None:
    model = mjcf.RootElement()
    model.actuator.add("motor", joint="nowhere")
    with pytest.raises(MjcfError, match="refers to the joint `nowhere`, which does not exist"):
        model.compile_model()


def test_it_is_what_the_text_and_the_assets_are(arm: RootElement, gripper: RootElement) -> None:
    arm.find("site", "flange").attach(gripper)
    physics = arm.compile_model()
    written = mujoco.MjModel.from_xml_string(arm.to_xml_string(), arm.assets)
    for field in ("names", "nbuffer"):
        assert getattr(physics.model, field) == getattr(written, field)
    for field in ("body_pos", "body_inertia", "mesh_vert", "jnt_range", "geom_friction", "key_qpos"):
        np.testing.assert_array_equal(getattr(physics.model, field), getattr(written, field))


def test_options_that_disagree(arm: RootElement, gripper: RootElement) -> None:
    arm.option.timestep = 0.002
    gripper.option.timestep = 0.001
    arm.worldbody.attach(gripper)
    with pytest.raises(MjcfError, match="timestep"):
        arm.compile_model()
    with pytest.warns(mjcf.MjcfWarning, match="timestep"):
        assert arm.compile_model(conflict="base").timestep == 0.002


def test_advice_is_for_those_who_write_python() -> None:
    free, moved, nothing, instance = (mjcf.RootElement() for _ in range(4))
    for model, attributes in ((free, {}), (moved, {"mocap": True})):
        body = model.worldbody.add("body")
        body.add("geom", size=[1])
        inner = body.add("body", **attributes)
        inner.add("geom", size=[1])
        if model is free:
            inner.add("freejoint")
    nothing.actuator.add("motor")
    plugin = instance.extension.add("plugin", plugin="mujoco.pid")
    plugin.add("instance", name="i").add("config", key="kp", value="1")
    helps = []
    for model in (free, moved, nothing, instance):
        with pytest.raises(MjcfError) as caught:
            model.compile_model()
        helps.append(str(caught.value.diagnostics[0].help))
    assert [help.partition(":")[0] for help in helps] == [
        "put a body with a free joint into the worldbody",
        "put a mocap body into the worldbody, without joints",
        "name the moved element",
        "give it to an actuator",
    ]
    assert "joint=…" in helps[2] and "add('plugin'" in helps[3]

"""The examples of the documentation, run as they stand."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose import mjcf


def test_the_pendulum() -> None:
    model = mjcf.RootElement()
    pendulum = model.worldbody.add("body", name="pendulum", pos=[0, 0, 1])
    pendulum.add("joint", name="hinge", type="hinge", axis=[0, 1, 0])
    pendulum.add("geom", name="bob", type="sphere", size=[0.05], rgba=[1, 0, 0, 1])
    model.actuator.add("motor", name="motor", joint="hinge", gear=[1])
    physics = model.compile_model()
    hinge_joint = model.find("joint", name="hinge")
    joint_data = physics.bind(hinge_joint)
    assert physics.model.nu == physics.model.njnt == 1
    assert hinge_joint is pendulum.joint[0]
    joint_data.qpos = 0.5
    assert physics.data.qpos.tolist() == joint_data.qpos.tolist() == [0.5]


def test_editing_a_robot(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / "arm" / "arm.xml").read_text().replace('"upper"', '"arm"').replace("meshes", "arm/meshes")
    (tmp_path / "robot.xml").write_text(text)
    mesh = tmp_path / "arm" / "meshes" / "path" / "to" / "mesh.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes((folder / "gripper" / "shell.stl").read_bytes())
    monkeypatch.chdir(tmp_path)

    model = mjcf.from_path("robot.xml")
    arm = model.find("body", name="arm")
    if arm:
        arm.add("site", name="wrist_site", pos=[0, 0, 0.1])
        model.sensor.add("touch", name="wrist_sensor", site="wrist_site")
    model.actuator.add("position", name="new_actuator", joint="elbow_joint", kp=100)

    for _, body in enumerate(model.find_all("body")):
        print(body.name, body.get("mass", "default"))  # noqa: T201
        if body.name:
            body.add("site", name=f"{body.name}_site", pos=[0, 0, 0])
            model.sensor.add("accelerometer", name=f"{body.name}_sensor", site=f"{body.name}_site")
    mjcf.commit_defaults(model)
    assert model.find("joint", "elbow_joint").damping == 2

    model.asset.add("mesh", name="custom_mesh", file="path/to/mesh.stl")
    model.worldbody.add("body", name="custom_body").add("geom", name="mesh_geom", type="mesh", mesh="custom_mesh")
    mjcf.export_with_assets(model, "out/")
    mjcf.export_with_assets_as_zip(model, "out/model.zip")

    assert capsys.readouterr().out.splitlines() == ["base default", "arm default", "fore default"]
    compiled = mujoco.MjModel.from_xml_path("out/model.xml")
    assert (compiled.nsensor, compiled.nu, compiled.nmesh) == (5, 3, 2)
    assert compiled.actuator("new_actuator").gainprm[0] == 100
    assert mujoco.MjSpec.from_zip("out/model.zip").compile().nbody == compiled.nbody == 5

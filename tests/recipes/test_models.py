from __future__ import annotations

import importlib.util
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.sources import license

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "recipes" / "models"
MODELS = sorted(FOLDER.rglob("*.xml"))
MESHES = sorted(path for path in FOLDER.rglob("*") if path.suffix in (".obj", ".stl", ".png"))


def named(path: Path) -> str:
    return path.relative_to(FOLDER).as_posix()


def settled(model: mujoco.MjModel, data: mujoco.MjData, seconds: float) -> mujoco.MjData:
    while data.time < seconds:
        mujoco.mj_step(model, data)
    return data


def test_all_models_are_there() -> None:
    assert {named(path) for path in MODELS} == {
        "arm6/arm6.xml",
        "camera_mount/camera_mount.xml",
        "gripper2/gripper2.xml",
        "props/can.xml",
        "props/cube.xml",
        "scenes/floor.xml",
        "table/table.xml",
    }


# What falls freely is tested on the table.
@pytest.mark.parametrize("path", [path for path in MODELS if path.parent.name != "props"], ids=named)
def test_settles_from_every_pose_it_knows(path: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(path))
    for key in (None, *range(model.nkey)):
        data = mujoco.MjData(model)
        if key is not None:
            mujoco.mj_resetDataKeyframe(model, data, key)
        start = data.qpos.copy()
        settled(model, data, 1.0)
        assert not any(warning.number for warning in data.warning)
        assert np.all(np.abs(data.qvel) < 0.05)
        if key is not None:
            assert np.all(np.abs(data.qpos - start) < 0.05), "a keyframe is a pose that holds"


@pytest.mark.parametrize("path", MODELS, ids=named)
def test_keyframes_touch_nothing(path: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(path))
    for key in range(model.nkey):
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        assert data.ncon == 0


def test_a_cube_comes_to_rest_on_the_table() -> None:
    spec = mujoco.MjSpec.from_file(str(FOLDER / "table" / "table.xml"))
    cube = mujoco.MjSpec.from_file(str(FOLDER / "props" / "cube.xml"))
    spec.attach(cube, frame=spec.worldbody.add_frame(pos=[0.1, 0.1, 0.8]), prefix="cube/")
    model = spec.compile()
    data = settled(model, mujoco.MjData(model), 2.0)
    assert data.body("cube/cube").xpos == pytest.approx([0.1, 0.1, 0.77], abs=2e-3)
    assert np.all(np.abs(data.qvel) < 1e-2)


def test_the_gripper_holds_a_cube_against_gravity() -> None:
    spec = mujoco.MjSpec.from_file(str(FOLDER / "gripper2" / "gripper2.xml"))
    cube = mujoco.MjSpec.from_file(str(FOLDER / "props" / "cube.xml"))
    spec.body("base").quat = [0, 1, 0, 0]
    spec.attach(cube, frame=spec.worldbody.add_frame(pos=[0, 0, -0.162]), prefix="cube/")
    for key in list(spec.keys):
        spec.delete(key)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.joint("pinion").qpos = 1.05
    data.joint("left_finger").qpos = data.joint("right_finger").qpos = 0.021
    model.opt.gravity[2] = 0
    settled(model, data, 0.5)
    model.opt.gravity[2] = -9.81
    settled(model, data, 2.0)
    assert data.body("cube/cube").xpos == pytest.approx([0, 0, -0.142], abs=5e-3)
    assert data.sensor("left_touch").data[0] > 5
    assert data.sensor("right_touch").data[0] > 5
    assert data.joint("left_finger").qpos == pytest.approx(data.joint("right_finger").qpos, abs=1e-3)


@pytest.mark.parametrize("path", MESHES, ids=named)
def test_files_are_small(path: Path) -> None:
    assert path.stat().st_size < 30_000


@pytest.mark.parametrize("path", MODELS, ids=named)
def test_the_license_travels_along(path: Path) -> None:
    assert license.find(path) == (ROOT / "LICENSE",)


def test_the_meshes_are_those_that_the_script_makes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.spec_from_file_location("make_meshes", FOLDER / "make_meshes.py")
    assert found is not None
    assert found.loader is not None
    script = importlib.util.module_from_spec(found)
    found.loader.exec_module(script)
    monkeypatch.setattr(script, "HERE", tmp_path)
    for path in MESHES:
        (tmp_path / path.relative_to(FOLDER)).parent.mkdir(parents=True, exist_ok=True)
    for make in (script.arm, script.gripper, script.camera_mount, script.table):
        make()
    made = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*.*"))
    assert made == sorted(path.relative_to(FOLDER) for path in MESHES)
    for name in made:
        # The last digit may be another one with another numpy.
        assert (tmp_path / name).stat().st_size == pytest.approx((FOLDER / name).stat().st_size, rel=0.01)

"""The example of copies and keys: six cubes that stand where they were put."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

FOLDER = Path(__file__).resolve().parents[2] / "recipes"


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> mujoco.MjModel:
    context = Context(environment={}, folder=FOLDER)
    built = build(ModelRequest(FOLDER / "cubes.yaml", verified=False), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    folder = tmp_path_factory.mktemp("cubes")
    for path, content in built.bundle.files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)
    return mujoco.MjModel.from_xml_path(str(folder / "model.xml"))


def reset(model: mujoco.MjModel, key: str) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    return data


CUBES = [f"cube{row}_{place}/free" for row in range(2) for place in range(3)]


@pytest.mark.parametrize("key", ["home", "open", "reach"])
def test_the_cubes_do_not_pile_up(model: mujoco.MjModel, key: str) -> None:
    data = reset(model, key)
    places = np.array([data.joint(cube).qpos[:3] for cube in CUBES])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + np.eye(6)
    assert apart.min() > 0.1
    mujoco.mj_forward(model, data)
    assert all(contact.dist > -1e-6 for contact in data.contact)


def test_they_stay_on_the_table(model: mujoco.MjModel) -> None:
    data = reset(model, "home")
    before = np.array([data.joint(cube).qpos[:3] for cube in CUBES])
    while data.time < 1:
        mujoco.mj_step(model, data)
    after = np.array([data.joint(cube).qpos[:3] for cube in CUBES])
    assert np.abs(after - before).max() < 2e-3


def test_what_the_key_says(model: mujoco.MjModel) -> None:
    data = reset(model, "reach")
    assert data.joint("arm/elbow").qpos[0] == pytest.approx(np.radians(80))
    assert data.joint("arm/flange_roll").qpos[0] == 0.5
    assert data.joint("arm/shoulder_lift").qpos[0] == 0.3  # of the key `home` of the part
    assert data.joint("arm/gripper/left_finger").qpos[0] == 0.04  # of the key `open` of the part's part
    assert data.joint("cube1_2/free").qpos.tolist() == [0.3, 0.12, 0.85, 1, 0, 0, 0]
    assert data.actuator("arm/elbow").ctrl[0] == pytest.approx(np.radians(80))

"""One model's states are recorded from its memory as array by array."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from mjcompose.mujoco import varying
from mjcompose.mujoco.varying import MEANS, Differences, Recorder, arrays, flat

MODEL = """<mujoco><asset><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset><worldbody><light/>
  <body><joint type="ball"/><geom type="mesh" mesh="m"/><body><joint/><geom name="g" size="0.1"/></body></body>
</worldbody><keyframe><key qpos="1 0 0 0 0"/></keyframe></mujoco>"""


@pytest.fixture
def model(monkeypatch: pytest.MonkeyPatch) -> mujoco.MjModel:
    monkeypatch.setattr(varying, "_BLOCK", 8)
    return mujoco.MjModel.from_xml_string(MODEL)


def test_all_numbers_that_differ_are_recorded_and_the_model_is_restored(model: mujoco.MjModel) -> None:
    random = np.random.default_rng(4)
    worlds = 40
    names = [name for name in arrays(model) if "." not in name and flat(model, name).size]
    nominal = {name: flat(model, name).copy() for name in names}
    expected = Differences(model, worlds)
    found = Recorder(model)
    for world in range(worlds):
        for name in random.choice(names, size=world % 7, replace=False):
            numbers = flat(model, name)
            numbers[random.integers(numbers.size)] += 1
        if world % 3 == 0:
            model.geom_rgba[1, 0] = random.choice([0.25, np.nan])
            model.stat.meaninertia += 1
            model.stat.meanmass += world
        expected.take(world, model)
        found.take()
        assert all(np.array_equal(flat(model, name), nominal[name]) for name in names)
    ours = list(found.found())
    theirs = list(expected.found())
    assert [name for name, _, _ in ours] == [name for name, _, _ in theirs]
    assert {name for name, _, _ in ours} >= {*MEANS}
    for (name, index, values), (_, same, numbers) in zip(ours, theirs, strict=True):
        assert (index.tolist(), values.dtype) == (same.tolist(), numbers.dtype), name
        assert np.array_equal(values, numbers, equal_nan=values.dtype.kind == "f"), name


def test_nan_and_the_sign_of_zero_are_no_differences(model: mujoco.MjModel) -> None:
    model.geom_rgba[1, 0] = np.nan
    model.geom_rgba[1, 1] = 0.0
    found = Recorder(model)
    model.geom_rgba[1, 0] = -np.nan
    model.geom_rgba[1, 1] = -0.0
    found.take()
    assert list(found.found()) == []


def test_assets_are_compared_in_the_first_worlds(model: mujoco.MjModel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(varying, "_LARGE", model.mesh_vert.size - 1)
    found = Recorder(model)
    for world in range(12):
        model.mesh_vert[0] = world if world >= 3 else model.mesh_vert[0]
        model.body_pos[1, 0] = world
        found.take()
    recorded = {name: values[:, 0].tolist() for name, _, values in found.found()}
    assert recorded["mesh_vert"][3:] == list(range(3, 12))
    assert recorded["body_pos"] == list(range(12))


def test_an_option_that_changes_is_no_world(model: mujoco.MjModel) -> None:
    for change in (lambda: setattr(model.opt, "timestep", 0.5), lambda: model.opt.gravity.__setitem__(2, 1)):
        found = Recorder(model)
        change()
        with pytest.raises(RuntimeError, match="option"):
            found.take()

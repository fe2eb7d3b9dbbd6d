"""Worlds are the samples that are really built: every array of mjModel, and what becomes of them when they are stepped."""

from __future__ import annotations

import json
import shutil
import zipfile
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from click.testing import CliRunner
from mjcompose import worlds
from mjcompose.base.report import MjcomposeError
from mjcompose.bundle.staging import write_folder
from mjcompose.cli.main import main
from mjcompose.pipeline.stages import Built, ModelRequest, build
from mjcompose.sources.context import Context
from tools.worlds.studies import RESTING, differing, stepped, tables

MODEL = """\
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.002"/>
  <worldbody>
    <camera name="top" pos="0 0 1" fovy="50"/>
    <light name="lamp" pos="0 0 3" diffuse="0.5 0.5 0.5"/>
    <geom type="plane" size="1 1 1"/>
    <body name="arm" pos="0 0 1">
      <joint name="hinge" axis="0 1 0" range="-1 1" damping="0.5" armature="0.1" ref="0.2"/>
      <geom name="link" type="capsule" size="0.05 0.2" mass="1"/>
      <geom name="pad" size="0.06" mass="0"/>
      <camera name="wrist" pos="0 0 0.3" mode="trackcom"/>
      <body name="hand" pos="0 0 0.3">
        <joint name="slide" type="slide" axis="1 0 0" stiffness="3" springref="0.1"/>
        <geom type="box" size="0.05 0.02 0.03" mass="0.2"/>
        <site name="tip"/>
      </body>
    </body>
    <body name="cube" pos="1 0 0.2">
      <freejoint name="cube"/>
      <geom name="cube" type="box" size="0.05 0.05 0.05" density="700"/>
    </body>
    <body name="goal" mocap="true" pos="0 1 0"><site name="goal"/></body>
  </worldbody>
  <tendon><spatial name="rope" stiffness="5"><site site="tip"/><site site="goal"/></spatial></tendon>
  <actuator>
    <position name="servo" joint="hinge" kp="20" kv="2" ctrlrange="-1 1"/>
    <motor name="push" joint="slide" gear="2"/>
  </actuator>
  <equality><connect name="pin" active="false" body1="cube" body2="hand" anchor="0 0 0"/></equality>
  <keyframe><key name="home"/><key name="far" qpos="0.1 0 2 0 0.2 1 0 0 0" mpos="3 0 0"/></keyframe>
</mujoco>
"""
FIELDS = [
    'friction: {select: {geom: "**"}, attr: "friction[0]", scale: {uniform: [0.5, 2]}}',
    "damping: {select: {joint: hinge}, attr: damping, scale: {loguniform: [0.5, 2]}}",
    "armature: {select: {joint: hinge}, attr: armature, offset: {lognormal: {mean: -3, std: 1}}}",
    "stiffness: {select: {joint: slide}, attr: stiffness, truncnormal: {mean: 3, std: 1, min: 1, max: 5}}",
    'mass: {select: {body: "{arm,hand,cube}"}, attr: mass, scale: {loguniform: [0.5, 2]}}',
    "hand: {select: {body: hand}, attr: pos, offset: {normal: {std: 0.01}}}",
    "cube: {select: {body: cube}, attr: pos, offset: {uniform: [[-0.1, -0.1, 0], [0.1, 0.1, 0]]}}",
    "goal: {select: {body: goal}, attr: pos, offset: {normal: {std: 0.1}}}",
    "camera: {select: {camera: top}, attr: pos, offset: {normal: {std: 0.01}}}",
    "light: {select: {light: lamp}, attr: diffuse, per: sample, uniform: [0.2, 0.9]}",
    "kp: {select: {actuator: servo}, attr: kp, scale: {uniform: [0.5, 2]}}",
    "gear: {select: {actuator: push}, attr: 'gear[0]', choice: [1, 2, 3]}",
    "rope: {select: {tendon: rope}, attr: stiffness, scale: {uniform: [0.5, 2]}}",
]
SAMPLES = 80


def recipe(folder: Path, fields: list[str] = FIELDS, samples: int = SAMPLES, model: str = MODEL) -> Path:
    (folder / "model.xml").write_text(model)
    lines = "".join(f"    {field}\n" for field in fields)
    text = f"recipe: 1\nname: m\nbase: ./model.xml\nrandomize:\n  seed: 7\n  samples: {samples}\n  fields:\n{lines}"
    path = folder / "r.yaml"
    path.write_text(text)
    return path


def built(path: Path, sample: int | None = None, verified: bool = True) -> tuple[Built | None, Context]:
    context = Context(folder=path.parent, environment={})
    request = ModelRequest(path, sample=sample or 0, verified=verified, worlds=sample is None)
    return build(request, context), context


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("worlds")
    made, context = built(recipe(found))
    assert made is not None, [(each.message, each.notes) for each in context.sink.diagnostics]
    write_folder(made.bundle, found / "out")
    return found


@pytest.fixture(scope="module")
def study(folder: Path) -> worlds.Worlds:
    return worlds.load(folder / "out")


def sample(folder: Path, number: int) -> mujoco.MjModel:
    """The sample as a build makes it."""
    made, context = built(folder / "r.yaml", number, verified=False)
    assert made is not None, context.sink.diagnostics
    out = folder / f"sample{number}"
    write_folder(made.bundle, out)
    try:
        return mujoco.MjModel.from_xml_path(str(out / "model.xml"))
    finally:
        shutil.rmtree(out)


def test_every_array_of_32_worlds_is_that_of_the_sample(folder: Path, study: worlds.Worlds) -> None:
    seen: set[str] = set()
    for world in Random(3).sample(range(SAMPLES), 32):
        wanted = sample(folder, world + 1)
        assert differing(study.model(world), wanted) == set()
        seen |= differing(study.nominal, wanted)
    assert seen == set(study.arrays)
    assert {
        "qpos0",
        "key_qpos",
        "key_mpos",
        "body_subtreemass",
        "dof_invweight0",
        "actuator_acc0",
        "tendon_length0",
        "cam_pos0",
        "stat.meaninertia",
        "stat.meanmass",
    } <= seen


def test_a_model_of_its_own(study: worlds.Worlds) -> None:
    before = study.nominal.body_mass.copy()
    study.model(3).body_mass[:] = 0
    assert (study.nominal.body_mass == before).all() and study.model(3).body_mass[1] > 0
    assert differing(study.model(-1), study.model(SAMPLES - 1)) == set()
    assert len(list(study.models([1, 2]))) == 2 and len(study) == SAMPLES
    with pytest.raises(IndexError, match="world 80 does not exist: there are 80"):
        study.model(SAMPLES)


def test_values_of_all_worlds(study: worlds.Worlds) -> None:
    masses = study.values("body_mass")
    assert masses.shape == (SAMPLES, study.nominal.nbody)
    assert (masses[5] == study.model(5).body_mass).all()
    assert (study.values("geom_size") == study.nominal.geom_size).all()
    with pytest.raises(AttributeError):
        study.values("no_such_array")


def test_a_batch_steps_as_the_samples_do(folder: Path, study: worlds.Worlds) -> None:
    pytest.importorskip("mujoco.batch", reason="MuJoCo 3.17")
    batch = worlds.mujoco(study, nthread=1)
    before = {name: batch.expand(name).copy() for name in study.arrays if "." not in name}
    batch.set_const()
    for name, numbers in before.items():
        assert np.allclose(batch.expand(name), numbers, rtol=1e-12, atol=1e-12), name
    worlds_stepped = Random(4).sample(range(SAMPLES), 4)
    batch.reset()
    batch.step(nstep=100)
    for world in worlds_stepped:
        # Of a mass that is scaled a build rounds the last digit otherwise, which contacts enlarge.
        for model, tolerance in ((study.model(world), 1e-12), (sample(folder, world + 1), 1e-5)):
            data = mujoco.MjData(model)
            mujoco.mj_step(model, data, 100)
            assert np.allclose(batch.qpos[world], data.qpos, rtol=0, atol=tolerance)
    assert np.ptp(batch.qpos, axis=0).max() > 0.01


def test_balls_rest_on_tables_of_each_world() -> None:
    pytest.importorskip("mujoco.batch", reason="MuJoCo 3.17")
    study = tables()
    batch = worlds.mujoco(study, nthread=1)
    batch.reset()
    batch.step(nstep=200)
    assert (batch.qpos == stepped(study, 200)).all() and np.allclose(batch.qpos[:, 2], RESTING, atol=1e-3)


def test_the_same_worlds_whatever_their_number(folder: Path, study: worlds.Worlds, tmp_path: Path) -> None:
    made, _ = built(recipe(tmp_path, samples=5))
    assert made is not None
    write_folder(made.bundle, tmp_path / "out")
    few = worlds.load(tmp_path / "out")
    for world in range(5):
        assert differing(few.model(world), study.model(world)) == set()


# -- models that were built one by one -------------------------------------------------------------------------

MATRIX = """\
recipe: 1
name: m
base: ./model.xml
params: {step: 0.002, height: 0.3}
option: {timestep: "${step}"}
edit: [{select: {body: hand}, set: {pos: [0, 0, "${height}"]}}]
matrix: {axes: {step: [0.002, 0.004]}, include: [{tool: lamp}]}
variants: {tool: {none: {}, lamp: {add: [{to: world, light: {name: second}}]}}}
randomize: {seed: 7, samples: 3, fields: {height: {param: height, scale: {uniform: [0.5, 2]}}}}
"""


@pytest.fixture(scope="module")
def matrix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("matrix")
    (folder / "model.xml").write_text(MODEL)
    (folder / "r.yaml").write_text(MATRIX)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        result = CliRunner().invoke(main, ["build", "r.yaml", "--all", "-o", "out/{name}/"])
    assert result.exit_code == 0, result.output
    return folder / "out"


def test_models_are_gathered(matrix: Path, tmp_path: Path) -> None:
    """What a matrix sets and parameters that are drawn: numbers that only a build makes."""
    found = worlds.gather(matrix, where="step > 0")
    listed = list(mjcompose.load_many(matrix, where="step > 0"))
    assert len(found) == len(listed) == 8 and {"opt.timestep", "body_pos", "qpos0"} - found.arrays.keys() == {"qpos0"}
    found.save(tmp_path / "study.npz")
    for study in (found, worlds.load(listed[0].path, tmp_path / "study.npz")):
        for world, each in enumerate(listed):
            wanted = each.load().model
            model = study.model(world)
            assert {name for name in differing(model, wanted) if not name.startswith("name")} == set()
            assert model.opt.timestep == wanted.opt.timestep == study.values("opt.timestep")[world]
    with pytest.raises(MjcomposeError, match="is one of the files that this model is built from"):
        worlds.load(listed[0].path, tmp_path / "study.npz").take([0]).save(tmp_path / "study.npz")
    if find_spec("mujoco.batch"):
        batch = worlds.mujoco(found, nthread=1)
        assert (batch.expand("opt.timestep").reshape(-1) == found.values("opt.timestep")).all()


@pytest.mark.parametrize(
    ("where", "said"),
    [(None, "it has the light `second`"), ("step > 9", "no model in"), ("step >", "the expression ends")],
)
def test_models_that_are_no_worlds(matrix: Path, where: str | None, said: str) -> None:
    with pytest.raises(mjcompose.LoadError, match=said):
        worlds.gather(matrix, where)


def test_a_file_that_does_not_exist(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(mjcompose.LoadError, match="cannot be read"):
        worlds.load(folder / "out", tmp_path / "gone.npz")


def test_where_no_file_can_be(study: worlds.Worlds, tmp_path: Path) -> None:
    with pytest.raises(MjcomposeError, match="cannot write"):
        (tmp_path / "x.npz").mkdir()
        study.save(tmp_path / "x.npz")


# -- what cannot be --------------------------------------------------------------------------------------------


def test_what_a_build_makes_otherwise_is_an_error(tmp_path: Path) -> None:
    model = MODEL.replace('ctrlrange="-1 1"', 'inheritrange="1"')
    field = "range: {select: {joint: hinge}, attr: range, offset: {normal: {std: 2deg}}}"
    found, context = built(recipe(tmp_path, [field], model=model))
    assert found is None
    (told,) = context.sink.diagnostics
    assert told.code == "draw-at-run-time" and "`actuator_ctrlrange`" in told.message


def test_a_bundle_without_worlds(folder: Path, tmp_path: Path) -> None:
    made, _ = built(folder / "r.yaml", 0)
    assert made is not None
    write_folder(made.bundle, tmp_path / "out")
    with pytest.raises(mjcompose.LoadError, match="has no worlds"):
        worlds.load(tmp_path / "out")
    with pytest.raises(mjcompose.LoadError, match="nowhere"):
        worlds.load(tmp_path / "nowhere")


def _rewritten(folder: Path, name: str, content: bytes) -> None:
    """The file, and its hash in the manifest: as if a build had written it so."""
    import hashlib

    (folder / name).write_bytes(content)
    manifest = json.loads((folder / "manifest.json").read_text())
    for each in manifest["files"]:
        if each["path"] == name:
            each["sha256"] = hashlib.sha256(content).hexdigest()
            each["size"] = len(content)
    (folder / "manifest.json").write_text(json.dumps(manifest))


@pytest.mark.parametrize(
    ("content", "said"), [(b"no archive", "cannot be read"), (None, "are not of its model: `body_mass`")]
)
def test_worlds_that_are_not_of_the_model(folder: Path, tmp_path: Path, content: bytes | None, said: str) -> None:
    out = tmp_path / "out"
    shutil.copytree(folder / "out", out)
    if content is None:
        arrays: dict[str, Any] = {"body_mass/index": np.array([99]), "body_mass/values": np.ones((SAMPLES, 1))}
        np.savez(tmp_path / "other.npz", **arrays)
        with zipfile.ZipFile(tmp_path / "other.npz", "a") as archive:
            archive.writestr("about.json", json.dumps({"worlds": 1, "samples": SAMPLES, "seed": 7}))
        content = (tmp_path / "other.npz").read_bytes()
    _rewritten(out, "worlds.npz", content)
    with pytest.raises(mjcompose.LoadError, match=said):
        worlds.load(out)


def test_without_a_batch(study: worlds.Worlds, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "mujoco.batch", None)
    with pytest.raises(mjcompose.LoadError, match=r"has no `mujoco.batch`"):
        worlds.mujoco(study)

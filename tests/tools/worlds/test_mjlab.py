"""Worlds in mjlab, which pins an older MuJoCo, on the CPU: alone, and as an entity of a scene with others."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import mjcompose
import mujoco
import numpy as np
import pytest
from mjcompose import worlds
from tools.worlds.studies import ARM, RESTING, arm, stepped, tables

ROOT = Path(__file__).resolve().parents[3]

pytest.importorskip("mjlab", reason="mjlab is not installed")


def simulation(study: worlds.Worlds, entity: str | None, term: Any, **cfg: Any) -> Any:
    from mjlab.entity import EntityCfg
    from mjlab.scene import Scene, SceneCfg
    from mjlab.sim.sim import Simulation, SimulationCfg

    model = study.nominal
    if entity is not None:
        robot = EntityCfg(spec_fn=lambda: mujoco.MjSpec.from_file(str(ARM / "bundle" / "model.xml")))
        scene = SceneCfg(num_envs=study.count, entities={"first": robot, "second": robot}, spec_fn=apart)
        model = Scene(scene, "cpu").compile()
    sim = Simulation(cfg.get("envs", study.count), SimulationCfg(), model=model, device="cpu")
    sim.expand_model_fields(term.func.model_fields)
    term.func(SimpleNamespace(sim=sim), None)
    if term.func.recompute:
        sim.recompute_constants(term.func.recompute)
    return sim


def apart(spec: mujoco.MjSpec) -> None:
    """Both arms stand at the same place: they do not collide."""
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0


@pytest.mark.parametrize("entity", [None, "second"])
def test_worlds_step_as_in_mujoco(entity: str | None) -> None:
    study = arm()
    term = worlds.mjlab(study, entity)["worlds"]
    assert term.mode == "startup"
    assert {"body_mass", "body_inertia", "dof_invweight0", "body_subtreemass"} <= set(term.func.model_fields)
    sim = simulation(study, entity, term)
    for _ in range(100):
        sim.step()
    for name in ("timestep", "integrator", "iterations", "ls_iterations", "tolerance", "cone", "impratio"):
        setattr(study.nominal.opt, name, getattr(sim.mj_model.opt, name))  # mjlab writes its own into the model
    found = sim.data.qpos.cpu().numpy()
    assert np.allclose(found[:, -2:], stepped(study), atol=1e-5)
    if entity is not None:
        nominal = mujoco.MjData(study.nominal)
        mujoco.mj_step(study.nominal, nominal, 100)
        assert np.allclose(found[:, :2], nominal.qpos, atol=1e-5)


def test_balls_rest_on_tables_of_each_world() -> None:
    study = tables()
    sim = simulation(study, None, worlds.mjlab(study)["worlds"])
    for _ in range(500):
        sim.step()
    assert np.allclose(sim.data.qpos.cpu().numpy()[:, 2], RESTING, atol=1e-3)


def test_what_does_not_fit() -> None:
    study = arm()
    with pytest.raises(mjcompose.LoadError, match="there are 4 environments and 8 worlds"):
        simulation(study, None, worlds.mjlab(study)["worlds"], envs=4)
    few = study.take(range(4))
    simulation(few, None, worlds.mjlab(few)["worlds"])
    with pytest.raises(mjcompose.LoadError, match="the scene has no body `third/"):
        simulation(study, "third", worlds.mjlab(study, "third")["worlds"])


def test_an_entity_of_a_recipe(tmp_path: Path) -> None:
    """The program of docs/how-to/open_in_mujoco.md."""
    page = (ROOT / "docs" / "how-to" / "open_in_mujoco.md").read_text(encoding="utf-8")
    for file, text in re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```', page, re.MULTILINE | re.DOTALL):
        (tmp_path / file).write_text(text, encoding="utf-8")
    shutil.copytree(ROOT / "recipes", tmp_path / "recipes")
    done = subprocess.run([sys.executable, "mjlab_cell.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["13"], done.stderr


@pytest.fixture
def go1(tmp_path: Path) -> Path:
    """A recipe next to mjlab's own model of the robot."""
    from mjlab.asset_zoo.robots.unitree_go1.go1_constants import GO1_XML

    shutil.copytree(GO1_XML.parent, tmp_path, dirs_exist_ok=True)
    return Path(shutil.copy(Path(__file__).with_name("go1.yaml"), tmp_path))


def test_actuators_and_collisions_by_pattern(go1: Path) -> None:
    """A recipe with `ctrl: hold` is an entity that moves as mjlab's own."""
    from mjlab.asset_zoo.robots.unitree_go1.go1_constants import get_go1_robot_cfg
    from mjlab.entity import Entity, EntityArticulationInfoCfg, EntityCfg

    theirs = Entity(get_go1_robot_cfg()).spec.compile()
    ours = Entity(
        EntityCfg(spec_fn=partial(mjcompose.spec, go1), articulation=EntityArticulationInfoCfg())
    ).spec.compile()
    for kind in ("actuator", "geom", "jnt", "dof", "body"):
        for name in (each for each in dir(theirs) if each.startswith(f"{kind}_")):
            if name not in ("actuator_ctrlrange", "geom_rgba"):  # mjlab's ranges inform, and limit nothing
                expected = getattr(theirs, name)
                np.testing.assert_allclose(getattr(ours, name), expected, rtol=1e-7, atol=1e-12, err_msg=name)
    home = ours.key("home")
    assert home.ctrl.tolist() == [0.1, 0.9, -0.1, 0.9] * 2 + [-1.8] * 4
    poses = [fallen(model, home) for model in (ours, theirs)]
    assert np.allclose(*poses, atol=1e-9)


def fallen(model: mujoco.MjModel, home: Any) -> Any:
    """The pose after 0.2 s in the air."""
    data = mujoco.MjData(model)
    data.qpos[:] = home.qpos
    data.ctrl[:] = home.ctrl
    mujoco.mj_step(model, data, 100)
    return data.qpos


def test_the_command_line_builds_with_mjlabs_mujoco(go1: Path) -> None:
    for words in (["check", "go1.yaml"], ["build", "go1.yaml", "-o", "out/"]):
        done = subprocess.run(
            [sys.executable, "-m", "mjcompose", *words], cwd=go1.parent, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
    built = mujoco.MjModel.from_xml_path(str(go1.parent / "out" / "model.xml"))
    assert (built.nu, built.nkey) == (12, 1)

"""The fields of `randomize` in recipes and docs: each changes the simulation in at least nine of ten samples."""

from __future__ import annotations

import re
from pathlib import Path

import mjcompose
import mujoco
import numpy as np
import pytest
import yaml
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ROOT = Path(__file__).resolve().parents[2]
RECIPES = ["recipes/randomised.yaml", "recipes/bench.yaml", "docs/examples/keys/randomize.yaml"]
GUIDES = {"docs/how-to/randomize.md": 0}
SECONDS = 0.4
SAMPLES = 10


def state(model: mujoco.MjModel) -> np.ndarray:
    """Where a pushed model is after it has run, its forces and contacts, and what its cameras and lights see and give."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] += 0.2
    for _ in range(round(SECONDS / model.opt.timestep)):
        mujoco.mj_step(model, data)
    frictions = np.sort(data.contact.friction, axis=None) if data.ncon else np.zeros(0)
    looks = (data.cam_xpos, model.cam_fovy, model.light_diffuse, model.mat_rgba, data.sensordata)
    return np.concatenate([np.ravel(each) for each in (data.qpos, data.qvel, data.qfrc_constraint, frictions, *looks)])


def only(recipe: dict[str, object], field: str) -> dict[str, object]:
    randomize = dict(recipe["randomize"])  # type: ignore[call-overload]
    fields = {field: randomize["fields"][field]}
    checks = {name: value for name, value in recipe.items() if name not in ("check", "matrix")}
    return {**checks, "randomize": {**randomize, "samples": SAMPLES, "fields": fields}}


def written(path: str) -> tuple[dict[str, object], Path]:
    text = (ROOT / path).read_text()
    if path.endswith(".md"):
        text = next(each for each in re.findall(r"```yaml[^\n]*\n(.*?)```", text, re.DOTALL) if "seed: 7" in each)
        return yaml.safe_load(text.replace("./recipes/models", "./models")), ROOT / "recipes"
    folder = ROOT / "recipes" if path.startswith("docs") else (ROOT / path).parent
    return yaml.safe_load(text), folder


CASES = [
    (path, field)
    for path in (*RECIPES, *GUIDES)
    for field in written(path)[0]["randomize"]["fields"]  # type: ignore[index]
]


@pytest.mark.slow
@pytest.mark.parametrize(("path", "field"), CASES, ids=[f"{path.split('/')[-1]}-{field}" for path, field in CASES])
def test_a_documented_field_changes_the_simulation(tmp_path: Path, path: str, field: str) -> None:
    recipe, folder = written(path)
    text = yaml.safe_dump(only(recipe, field)).replace("./models", str(folder / "models"))
    (tmp_path / "r.yaml").write_text(text)
    nominal = state(mjcompose.model(tmp_path / "r.yaml"))
    changed = 0
    for sample in range(1, SAMPLES + 1):
        found = state(mjcompose.model(tmp_path / "r.yaml", sample=sample))
        changed += found.shape != nominal.shape or float(np.abs(found - nominal).max()) > 1e-9
    assert changed >= 0.9 * SAMPLES


@pytest.mark.parametrize("path", [*RECIPES, *GUIDES])
def test_no_documented_field_is_without_effect(tmp_path: Path, path: str) -> None:
    recipe, folder = written(path)
    text = yaml.safe_dump(recipe).replace("./models", str(folder / "models"))
    (tmp_path / "r.yaml").write_text(text)
    context = Context(folder=tmp_path)
    build(ModelRequest(tmp_path / "r.yaml"), context)
    assert not [each.message for each in context.sink.diagnostics if each.code == "without-effect"]

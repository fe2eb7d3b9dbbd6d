"""The demanding cell: every model of its matrix builds, its checks hold, and what is in it stands still."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import numpy as np
import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main

RECIPES = Path(__file__).resolve().parents[2] / "recipes"


@pytest.mark.slow
@pytest.mark.parametrize("recipe", ["cell", "menagerie_cell"])
def test_nothing_moves_in_any_of_its_models(
    recipe: str, tmp_path: Path, menagerie_root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MENAGERIE_ROOT", str(menagerie_root))
    out = os.fspath(tmp_path / "{name}/")
    result = CliRunner().invoke(main, ["build", f"{RECIPES}/{recipe}.yaml", "--all", "-o", f"{out}/"])
    assert result.exit_code == 0, result.output
    assert "warning" not in result.output
    models = sorted(tmp_path.glob("*/model.xml"))
    assert [path.parent.name for path in models] == sorted(
        f"{recipe}-{props}-{light}-{payload}g-s000{sample}"
        for props in ("cubes", "cans")
        for light in ("bright", "dim")
        for payload in (50, 200, 500)
        if (props, payload) != ("cans", 500)
        for sample in (0, 1)
    )
    for path in (path for path in models if path.parent.name.endswith("bright-50g-s0001")):  # the checks ask them all
        model = mujoco.MjModel.from_xml_path(str(path))
        props = [body for body in range(model.nbody) if model.body(body).name.startswith("prop")]
        assert len(props) == 6
        _stands_still(model, "home", props)


def _stands_still(model: mujoco.MjModel, key: str, props: list[int]) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    mujoco.mj_forward(model, data)
    before = data.xpos.copy()
    while data.time < 2:
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    assert np.abs(data.qvel).max() < 0.01
    moved = np.abs(data.xpos - before)
    assert moved.max() < 0.02 and moved[props].max() < 0.001

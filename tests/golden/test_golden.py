"""Every folder here is a recipe with its parts, and the text of the model that is built of it.

`UPDATE_EXPECTED=1 pytest tests/golden` writes the models anew; read what changed.
"""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest

from composer.context import Context
from composer.diagnostics import Severity
from composer.pipeline import build

HERE = Path(__file__).resolve().parent
CASES = sorted(path.parent.name for path in HERE.glob("*/recipe.yaml"))
# Something is told of these, and the model is built all the same.
TOLD = {"conflict_merge", "conflict_warning", "fusestatic_on_body", "keyframe_of_edited", "subtree"}
# MuJoCo writes what is read of these, or computes numbers in them, and an older one does so in another way.
WRITTEN_BY_MUJOCO = {"urdf", "compiler_of_base", "compiler_of_parts"}


@pytest.mark.parametrize("case", CASES)
def test_model(case: str, tmp_path: Path) -> None:
    if case in WRITTEN_BY_MUJOCO and not hasattr(mujoco.MjSpec, "fuse_static"):
        pytest.skip("the model was written by a newer MuJoCo")
    context = Context(environment={}, folder=HERE / case)
    built = build(HERE / case / "recipe.yaml", context, verified=False)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    assert {each.severity for each in context.sink.diagnostics} == (
        {Severity.WARNING} if case in TOLD else set()
    )
    text = built.bundle.files["model.xml"].decode()
    file = HERE / case / "model.xml"
    if os.environ.get("UPDATE_EXPECTED"):
        file.write_text(text, encoding="utf-8")
    assert text == file.read_text(encoding="utf-8")
    for path, content in built.bundle.files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes(content)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.nbody >= 1


def test_every_folder_is_a_case() -> None:
    folders = {path.name for path in HERE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(CASES)
    assert len(CASES) >= 15
    assert folders >= TOLD | WRITTEN_BY_MUJOCO

"""Every folder here is a recipe with its parts, and the text of the model that is built of it.

The text is compared, and MuJoCo judges what it means: every part is in the model what it is when compiled alone.

`UPDATE_EXPECTED=1 pytest tests/golden` writes the models anew; read what changed.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import mujoco
import pytest
from mjcompose.base.diagnostic import Severity
from mjcompose.bundle.write import write
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.verify.stored import verify_stored

HERE = Path(__file__).resolve().parent
CASES = sorted(path.parent.name for path in HERE.glob("*/recipe.yaml"))
# Something is told of these, and the model is built all the same.
TOLD = {"conflict_merge", "conflict_warning", "fusestatic_on_body", "keyframe_of_edited", "subtree"}
# MuJoCo writes what is read of these, or computes numbers in them, and an older one does so in another way.
WRITTEN_BY_MUJOCO = {"urdf", "xacro", "compiler_of_base", "compiler_of_parts"}

# Parts that a recipe takes elements from, or whose place has no name. All others must be compared, and unchanged.
NOT_COMPARED = {
    "collision": {"base", "left"},
    "comments": {"second"},
    "edit": {"base", "left"},
    "edit_keys": {"base", "left"},
    "expressions": {"base"},
    "keyframe_of_edited": {"left/one", "left/two"},
    "prefix_empty_with_joint": {"block"},
}


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


@pytest.mark.parametrize("case", CASES)
def test_model(case: str, tmp_path: Path, session: Session) -> None:
    if case in WRITTEN_BY_MUJOCO and not hasattr(mujoco.MjSpec, "fuse_static"):
        pytest.skip("the model was written by a newer MuJoCo")
    if case == "scatter" and mujoco.__version__.startswith("3.11."):
        pytest.skip("MuJoCo 3.11 lets the stones come to rest elsewhere")
    if case == "xacro":
        pytest.importorskip("xacro")
    context = Context(environment={}, folder=HERE / case)
    built = build(ModelRequest(HERE / case / "recipe.yaml", verified=False), context)
    assert built is not None, [each.message for each in context.sink.diagnostics]
    assert {each.severity for each in context.sink.diagnostics} == ({Severity.WARNING} if case in TOLD else set())
    text = built.bundle.files["model.xml"].decode()
    file = HERE / case / "model.xml"
    if os.environ.get("UPDATE_EXPECTED"):
        file.write_text(text, encoding="utf-8")
    assert text == file.read_text(encoding="utf-8")
    write(built.bundle, f"{tmp_path / 'out'}{os.sep}", environment={})
    judged = Context(environment={}, folder=HERE / case)
    stored = verify_stored(tmp_path / "out", judged, session, HERE / case / "recipe.yaml")
    assert stored is not None
    assert stored.compiled is not None
    assert len(stored.parts) == len(built.composed.members)
    told = {each.code for each in judged.sink.diagnostics}
    assert told <= {"part-not-compared", "mujoco-warning"}, [each.message for each in judged.sink.diagnostics]
    assert {each.member.part for each in stored.parts if not each.ok} == NOT_COMPARED.get(case, set())


def test_every_folder_is_a_case() -> None:
    folders = {path.name for path in HERE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(CASES)
    assert len(CASES) >= 15
    assert folders >= TOLD | WRITTEN_BY_MUJOCO | NOT_COMPARED.keys()

"""Each model of the corpus, alone as the part of a recipe, changes only through the journal."""

from __future__ import annotations

import os
from pathlib import Path

import mujoco
import pytest
from link.test_record import audited
from mjcompose.tree.xml_text import root_of

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
MODELS = sorted(
    path.relative_to(CORPUS).as_posix()
    for path in (Path(CORPUS).glob("models/*/*.xml") if CORPUS else ())
    if root_of(path.read_text(encoding="utf-8")) == "mujoco"
)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_every_change_of_a_model_is_recorded(model: str, tmp_path: Path) -> None:
    assert CORPUS is not None
    try:
        mujoco.MjModel.from_xml_path(str(Path(CORPUS, model)))
    except ValueError as refusal:
        pytest.skip(f"it is a piece of other models: {refusal}")
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(
        f"recipe: 1\nattach:\n  part: {{model: {Path(CORPUS, model)}, pos: [0, 0, 1]}}\n", encoding="utf-8"
    )
    audit = audited(recipe)
    assert audit.unrecorded == []
    assert audit.changes


def test_the_corpus_has_models() -> None:
    if CORPUS:
        assert len(MODELS) >= 50

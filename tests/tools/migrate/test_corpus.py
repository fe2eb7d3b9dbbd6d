"""Robots of Menagerie, written for an older MuJoCo, are the same robots for this one; and back."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.sources.context import Context
from mjcompose.tools.migrate.migrate import MigrateRequest, installed, run
from tools.migrate.test_changes import mujoco

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
MODELS = (
    "robotiq_2f85/2f85.xml",
    "shadow_hand/scene_left.xml",
    "skydio_x2/x2.xml",
    "unitree_g1/g1.xml",
    "unitree_go1/go1.xml",
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CORPUS is None, reason="`MJCOMPOSE_CORPUS` names no folder with models"),
]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("before", "after"), [("3.1.6", None), ("3.3.2", None), (None, "3.3.2")])
def test_it_is_the_same_robot(model: str, before: str | None, after: str | None, tmp_path: Path) -> None:
    if installed() == (before or after):
        pytest.skip("this is the MuJoCo of the model")
    path = Path(str(CORPUS)) / "models" / model
    if not path.exists():
        pytest.skip("the corpus does not have it")
    context = Context(environment={}, folder=tmp_path)
    python = mujoco(str(before or after)).python
    result = run(MigrateRequest(str(path), before, after, pythons=(python,)), context, lambda words: None)
    assert result is not None, context.sink.diagnostics
    assert result.proof.outcome is not None and result.proof.outcome.same, result.unexplained
    assert not result.proof.outcome or not result.proof.outcome.apart

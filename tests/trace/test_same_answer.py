"""`explain` gives the same answer in every process, and its last change is the value that MuJoCo has."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
from mjcompose.sources.context import Context
from mjcompose.trace.explanation import AttributeExplained
from mjcompose.trace.traced import trace
from mjcompose.tree.xml_text import to_text

HERE = Path(__file__).resolve().parent
RECORD = HERE / "record"
CASES = [
    "edit_undone",
    "edit_undone_why_not",
    "draw_after_edit",
    "passes_and_edit",
    "written_anew",
    "renamed_twice_by_a_pass",
]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", ["0", "1", "12345"])
def test_other_processes_say_the_same(case: str, seed: str) -> None:
    asked, _, expected = (HERE / "cases" / f"{case}.txt").read_text(encoding="utf-8").partition("\n")
    call = shlex.split(asked.partition(" $ mjcompose ")[2])
    said = subprocess.run(
        [sys.executable, "-m", "mjcompose", *call],
        cwd=RECORD,
        env={**os.environ, "PYTHONHASHSEED": seed},
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    assert said.stdout == expected


@pytest.mark.parametrize(
    ("recipe", "sample", "joint", "attribute", "array"),
    [
        ("undone.yaml", 0, "hinge", "damping", "dof_damping"),
        ("undone.yaml", 0, "hinge", "armature", "dof_armature"),
        ("drawn.yaml", 1, "hinge", "damping", "dof_damping"),
        ("twice.yaml", 0, "a/hinge", "range", "jnt_range"),
    ],
)
def test_the_last_change_is_what_mujoco_has(
    recipe: str, sample: int, joint: str, attribute: str, array: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(RECORD)
    context = Context(environment={}, folder=RECORD)
    traced = trace(Path(recipe), context, sample)
    assert traced is not None, context.sink.diagnostics
    node = next(each for each in traced.model.root.iter("joint") if each.get("name") == joint)
    explained = traced.attribute(node, attribute)
    assert isinstance(explained, AttributeExplained)
    changes = explained.levels[0].changes
    after = changes[-1].after
    model = mujoco.MjModel.from_xml_string(to_text(traced.model.root))
    row = model.joint(joint).id
    assert [*map(float, (after or "0").split())] == pytest.approx(np.atleast_1d(getattr(model, array)[row]))

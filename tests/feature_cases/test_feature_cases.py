"""Every folder here is a small composition for one difficulty, told in the first line of its recipe.

MuJoCo judges: every source is compiled alone and compared with what became of it. A recipe whose first line
says `refused: CODE` must be refused with that code; one that says `told: CODE` builds with that warning. One that
ends in `MuJoCo 4` has what older versions refuse, or have faults of their own in.
"""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import pytest
from feature_cases.judging import judge

HERE = Path(__file__).resolve().parent
CASES = sorted(path.parent.name for path in HERE.glob("*/recipe.yaml"))
MUJOCO_4 = int(mujoco.mj_versionString().partition(".")[0]) >= 4
TOLD = re.compile(r"\b(refused|told): ([a-z-]+)")


@pytest.mark.parametrize("case", CASES)
def test_case(case: str, tmp_path: Path) -> None:
    recipe = HERE / case / "recipe.yaml"
    purpose = recipe.read_text().splitlines()[0]
    if purpose.endswith("MuJoCo 4") and not MUJOCO_4:
        pytest.skip("what it is for needs MuJoCo 4")
    told = TOLD.search(purpose)
    verdict = judge(recipe, tmp_path / "out")
    assert set(verdict.codes) == ({told[2]} if told else set()), verdict.told
    assert (verdict.model is None) == bool(told and told[1] == "refused"), verdict.told
    assert not verdict.differences, "\n".join([*verdict.differences[:20], verdict.text])


def test_every_folder_is_a_case_and_says_what_it_is_for() -> None:
    folders = {path.name for path in HERE.iterdir() if path.is_dir() and path.name != "__pycache__"}
    assert folders == set(CASES)
    assert len(CASES) >= 60
    for case in CASES:
        assert (HERE / case / "recipe.yaml").read_text().startswith("# "), case

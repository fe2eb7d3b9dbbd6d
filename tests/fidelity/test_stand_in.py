"""The harness and its judge on MuJoCo's own attach, whose faults are known."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest
from fidelity import corpus as corpora
from fidelity.building import stand_in
from fidelity.corpus import Composition
from fidelity.decided import NOT_YET
from fidelity.judging import Verdict, judge
from fidelity.table import cells, markdown, totals
from mjcompose.mujoco.compare import Roots
from sampling import rest_slow

FOLDER = os.environ.get("MJCOMPOSE_CORPUS")
QUICK = 0.3
"""Seconds that composing may have taken when the corpus was made."""
QUICKEST = (
    "dev-iiwa+2f85",
    "dev-iiwa+allegroL",
    "dev-scene+stretchURDF",
    "dev-scene+cradle",
    "dev-scene+slidercrank",
    "dev-scene+balloons",
    "dev-scene+motorfinger",
)

pytestmark = pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus")

FAILS = {"12-strippath", "53-size-memory-nuser", "89-two-unnamed-keys"}
CHANGES_PARTS = {
    "34-flexcomp",  # what is pinned to the part's world stays behind when the part is moved
    "44-settotalmass-child",
    "47-fitaabb",
    "48-fusestatic-child",
    "68-chain",
    "84-urdf-child",
    "86-lengthrange-options",
}


def _quick_pairs() -> list[tuple[Composition, bool]]:
    """Pairs that compose quickly, and whether the corpus says that attach leaves their parts unchanged.

    A damping that follows from a ratio is counted as a change there, and not here.
    """
    if not FOLDER:
        return []
    results = {p["id"]: p["result"] for p in json.loads(Path(FOLDER, "pairs.json").read_text())["pairs"]}
    found = []
    for pair in corpora.pairs(Path(FOLDER)):
        result = results[pair.id]
        if not pair.refused and result["compose_s"] < QUICK:
            changed = {place.split(":")[1] for place in result["differences"]}
            found.append((pair, not changed - {"actuator.biasprm"} and not result["count_mismatch"]))
    return found


def _judged(composition: Composition) -> Verdict:
    return judge(composition, builder=stand_in, roots=Roots.KEPT)


@pytest.mark.parametrize("expected", rest_slow(_quick_pairs(), QUICKEST, lambda each: each[0].id))
@pytest.mark.mujoco4("the corpus was measured with MuJoCo 4")
def test_attach_is_judged_as_the_corpus_says(expected: tuple[Composition, bool]) -> None:
    pair, unchanged = expected
    verdict = _judged(pair)
    assert verdict.compiled
    assert verdict.like_rival, verdict.rival_differences
    assert verdict.unchanged == unchanged, verdict.first_differences


@pytest.mark.slow
@pytest.mark.mujoco4("the corpus was measured with MuJoCo 4")
def test_attach_changes_the_parts_of_some_feature_cases_and_of_no_other() -> None:
    cases = corpora.cases(Path(FOLDER or ""))
    verdicts = [_judged(replace(case, refused="") if case.id in NOT_YET else case) for case in cases]
    refused = [verdict for verdict in verdicts if verdict.refused]
    assert refused
    assert all(verdict.fine for verdict in refused)
    assert {v.id for v in verdicts if not v.refused and not v.compiled} == FAILS
    assert {v.id for v in verdicts if v.compiled and not v.unchanged} == CHANGES_PARTS
    page = markdown("Cases", ["a"] * 6, map(cells, verdicts), totals(verdicts))
    assert all(f"| {verdict.id} |" in page for verdict in verdicts)

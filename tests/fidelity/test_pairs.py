"""A sample of the corpus's pairs and robots and all its feature cases, built by mjcompose and judged.

The whole sets are for `make fidelity`.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from fidelity import corpus as corpora
from fidelity.building import is_there
from fidelity.corpus import Composition
from fidelity.judging import judge
from sampling import rest_slow

QUICK = ("dev-iiwa+allegroL", "dev-chain-scene+ur5e+2f85", "dev-scene+motorfinger", "dev-floating-on-moving")
SAMPLE = (*QUICK, "dev-ur5e+2f85", "dev-panda-hand+d435i", "dev-g1+allegro2", "dev-scene+cassie")
QUICK_ROBOTS = ("universal_robots_ur5e/ur5e + robotiq_2f85/2f85", "wonik_allegro/left_hand + ufactory_xarm7/hand")
FOLDER = os.environ.get("MJCOMPOSE_CORPUS")
PAIRS = [pair for pair in corpora.pairs(Path(FOLDER)) if pair.id in SAMPLE] if FOLDER else []
CASES = corpora.cases(Path(FOLDER)) if FOLDER else []

pytestmark = [
    pytest.mark.skipif(not FOLDER, reason="MJCOMPOSE_CORPUS names no corpus"),
    pytest.mark.skipif(not is_there(), reason="mjcompose.pipeline.stages cannot be imported"),
]


def _robots() -> list[Composition]:
    """A few ordered pairs from all over."""
    every = list(corpora.robots(Path(FOLDER), 22)) if FOLDER else []
    return every[::67]


def test_the_sample_is_in_the_corpus() -> None:
    assert sorted(pair.id for pair in PAIRS) == sorted(SAMPLE)


@pytest.mark.parametrize("pair", rest_slow(PAIRS, QUICK, lambda pair: pair.id))
def test_pair(pair: Composition) -> None:
    verdict = judge(pair)
    assert verdict.fine, "\n".join(verdict.first_differences)


@pytest.mark.parametrize("pair", rest_slow(_robots(), QUICK_ROBOTS, lambda pair: pair.id))
def test_robots_side_by_side(pair: Composition) -> None:
    verdict = judge(pair)
    assert verdict.fine, "\n".join(verdict.first_differences)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
@pytest.mark.mujoco4("the corpus was measured with MuJoCo 4")
def test_feature_case(case: Composition) -> None:
    verdict = judge(case)
    assert verdict.fine, "\n".join(verdict.first_differences)

"""The linter on real models: it is quick, it has no tracebacks, and it finds the faults that people have reported."""

from __future__ import annotations

import json
import os
import time
from collections import Counter
from pathlib import Path

import pytest
from cli.shell import run

CORPUS = os.environ.get("MJCOMPOSE_CORPUS")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not CORPUS, reason="MJCOMPOSE_CORPUS does not name the folder of the corpus"),
]
REPORTED = (
    ("unitree_g1/g1_with_hands.xml", "key-out-of-range", "left_hand_thumb_1_joint"),  # mujoco_menagerie#296
    ("gymnasium_mujoco/humanoid.xml", "key-out-of-range", "right_knee"),  # Gymnasium-Robotics#311, #312
    ("wonik_allegro/left_hand.xml", "actuator-order", "mfa0"),  # as mujoco_menagerie#148
)
"""Parts of findings that must be there: file, rule, and a word of the message."""


def test_real_models() -> None:
    start = time.monotonic()
    result = run("lint", str(Path(str(CORPUS), "models")), "--output-format", "json")
    seconds = time.monotonic() - start
    found = [json.loads(line) for line in result.stdout.splitlines()]
    assert result.exit_code == 1
    counts = Counter(each["code"] for each in found if each["severity"] == "warning")
    assert len(counts) > 15, counts
    for file, code, word in REPORTED:
        assert any(
            each["code"] == code and each["span"]["file"].endswith(file) and word in each["message"] for each in found
        ), (file, code, word)
    assert seconds < 120, f"{seconds:.0f} s"  # 36 s on two idle cores

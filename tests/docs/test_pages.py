"""The tutorial, the guides and the explanations, carried out as they stand.

`UPDATE_PICTURES=1` takes the pictures that they show anew.
"""

from __future__ import annotations

import os
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from docs.replay import NotHere, Replay
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
HOW_TO = (
    "combine",
    "urdf",
    "split",
    "keyframes",
    "scale",
    "actuators",
    "troubleshooting",
    "train",
    "randomize",
    "open_in_mujoco",
    "python",
    "repeat",
    "simulators",
    "ros2",
    "teams",
    "from_mjspec",
    "lint",
    "interface",
)
PAGES = [
    *sorted((ROOT / "docs" / "tutorials").glob("*.md")),
    *(ROOT / "docs" / "how-to" / f"{name}.md" for name in HOW_TO),
    *(ROOT / "docs" / "explanation" / f"{name}.md" for name in ("composition", "verification")),
]
DIFFERENT = 1.0
"""How much a picture may differ from that of the page, on average, of 255: drivers draw edges and shadows in their own ways."""

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_is_true(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    replay = Replay(page, tmp_path)
    try:
        replay.whole()
    except NotHere as reason:
        pytest.skip(str(reason))
    for shown, made in replay.pictures.items():
        if os.environ.get("UPDATE_PICTURES"):
            shown.write_bytes(made)
        ours, now = (np.asarray(Image.open(BytesIO(each)).convert("RGB"), float) for each in (shown.read_bytes(), made))
        assert ours.shape == now.shape and np.abs(ours - now).mean() < DIFFERENT, shown
    if replay.lacking:
        pytest.skip(f"ran all but what needs {', '.join(sorted(replay.lacking))}")

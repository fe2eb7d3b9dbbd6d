"""The models that are composed: a corpus's where there is one, else the project's own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
RECIPE = REPOSITORY / "recipes" / "arm_gripper.yaml"
SITE = "attachment_site"


@dataclass(frozen=True, slots=True)
class Models:
    """An arm with the site `attachment_site`, a hand for it, and a model with many unnamed geoms.

    `to_lxml` is how many times as long as lxml's parse and tostring of both files attaching may take.
    """

    name: str
    arm: Path
    hand: Path
    humanoid: Path | None
    to_lxml: float | None


def models() -> Models:
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    if corpus:
        folder = Path(corpus) / "models"
        humanoid = folder / "mujoco_model" / "humanoid" / "humanoid.xml"
        return Models(
            "kuka iiwa 14 + allegro hand",
            folder / "kuka_iiwa_14" / "iiwa14.xml",
            folder / "wonik_allegro" / "left_hand.xml",
            humanoid if humanoid.is_file() else None,
            3.0,
        )
    own = REPOSITORY / "recipes" / "models"
    # Half as long as the others and in different units of angle: the fixed costs weigh more, no limit is set.
    return Models("arm6 + gripper2", own / "arm6" / "arm6.xml", own / "gripper2" / "gripper2.xml", None, None)

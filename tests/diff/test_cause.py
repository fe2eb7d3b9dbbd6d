"""The line that `diff` names is the line that was changed: for every value of the recipes and models shipped here."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from diff.changing import values_of
from diff.sweeping import Sweep

from composer.engine import Session

RECIPES = Path(__file__).parents[2] / "recipes"
MODELS = {
    "demo": ("table/table", "props/cube", "scenes/floor", "camera_mount/camera_mount"),
    "arm_gripper": ("arm6/arm6", "gripper2/gripper2"),
}
ALL = [
    *((recipe, f"{recipe}.yaml") for recipe in (
        "arm_gripper", "cell", "cubes", "demo", "gantry", "hoist", "payload_study", "randomised", "soft_arm", "two_arms",
    )),
    *((recipe, f"models/{model}.xml") for recipe, models in MODELS.items() for model in models),
]  # fmt: skip
SAMPLE = [("gantry", "gantry.yaml", 9), ("payload_study", "payload_study.yaml", 4), ("cubes", "cubes.yaml", 12),
          ("arm_gripper", "models/arm6/arm6.xml", 60)]  # fmt: skip


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    with Session() as session:
        yield session


@pytest.mark.parametrize(("recipe", "file", "step"), SAMPLE, ids=[file for _, file, _ in SAMPLE])
def test_the_line_of_some_values(recipe: str, file: str, step: int, session: Session, tmp_path: Path) -> None:
    _sweep(recipe, file, step, session, tmp_path)


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(("recipe", "file"), ALL, ids=[file for _, file in ALL])
def test_the_line_of_every_value(recipe: str, file: str, session: Session, tmp_path: Path) -> None:
    _sweep(recipe, file, 1, session, tmp_path)


def _sweep(recipe: str, file: str, step: int, session: Session, folder: Path) -> None:
    sweep = Sweep(folder, RECIPES / f"{recipe}.yaml", session)
    values = values_of(sweep.a / file)[step // 2 :: step]
    named = [found for found in map(sweep.of, values) if found is not None]
    assert len(named) > len(values) / 3  # others do not build, or make no difference
    assert not [str(each) for each in named if not each.is_right]

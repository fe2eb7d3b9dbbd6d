"""The line that `diff` names is the line that was changed: for values of each kind in the recipes and models shipped here."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff
from tools.diff.changing import Value, values_of
from tools.diff.sweeping import Sweep

RECIPES = Path(__file__).parents[3] / "recipes"
MODELS = {
    "demo": ("table/table", "props/cube", "scenes/floor", "camera_mount/camera_mount"),
    "arm_gripper": ("arm6/arm6", "gripper2/gripper2"),
}
ALL = [
    *(
        (recipe, f"{recipe}.yaml")
        for recipe in (
            "arm_gripper",
            "cell",
            "cubes",
            "demo",
            "gantry",
            "hoist",
            "payload_study",
            "randomised",
            "soft_arm",
            "two_arms",
        )
    ),
    *((recipe, f"models/{model}.xml") for recipe, models in MODELS.items() for model in models),
]
SAMPLE = [
    ("gantry", "gantry.yaml", 9),
    ("payload_study", "payload_study.yaml", 4),
    ("cubes", "cubes.yaml", 12),
    ("arm_gripper", "models/arm6/arm6.xml", 60),
]


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
def test_the_line_of_each_kind_of_value(recipe: str, file: str, session: Session, tmp_path: Path) -> None:
    """Of values of one attribute in elements of one kind, or of one key, the last: it comes after others like it."""
    sweep = Sweep(tmp_path, RECIPES / f"{recipe}.yaml", session)
    kinds = {re.sub(r"^.*?([^/.]*/?[^/.]+)$", r"\1", each.path): each for each in values_of(sweep.a / file)}
    _check(sweep, [*kinds.values()])


ARM = """<mujoco><worldbody><body name="link" pos="0 0 1"><joint name="j"/><geom size="0.1"/>
<site name="end" pos="0 0 0.2"/>
<site name="side" pos="0.1 0 0.2"/></body></worldbody></mujoco>
"""
HAND = """<mujoco><worldbody><body name="palm" pos="0 0 0.1"><geom size="0.05"/></body>
<body name="shell" pos="0 0.3 0"><geom size="0.05" mass="0"/></body></worldbody></mujoco>
"""


@pytest.mark.parametrize("made", ["sense: [force]", "joint: {type: hinge, axis: [0, 0, 1]}", "pos: [0, 0, 0.1]"])
@pytest.mark.parametrize(
    ("file", "old", "new", "line"),
    [
        ("recipe.yaml", "site: end", "site: side", 5),
        ("arm.xml", 'end" pos="0 0 0.2"', 'end" pos="0 0 0.3"', 2),
        ("arm.xml", 'end" pos="0 0 0.2"', 'end" pos="0 0 0.2" euler="90 0 0"', 2),
        ("hand.xml", 'pos="0 0.3 0"', 'pos="0 0.4 0"', 2),
    ],
)
def test_the_body_that_an_attachment_makes_has_the_line_of_its_place(
    made: str, file: str, old: str, new: str, line: int, session: Session, tmp_path: Path
) -> None:
    recipe = f"recipe: 1\nbase: arm.xml\nattach:\n  hand:\n    site: end\n    model: hand.xml\n    {made}\n"
    texts = {"recipe.yaml": recipe, "arm.xml": ARM, "hand.xml": HAND}
    for end in "ab":
        (tmp_path / end).mkdir()
        for name, text in texts.items():
            (tmp_path / end / name).write_text(text)
    comment = "# another line" if file == "recipe.yaml" else "<!-- another line -->"
    (tmp_path / "b" / file).write_text(f"{texts[file].replace(old, new)}{comment}\n")
    found = diff("a/recipe.yaml", "b/recipe.yaml", Context(folder=tmp_path), session)
    assert found is not None and found.groups
    for group in found.groups:
        span = None if group.cause is None else group.cause.after
        assert span is not None, group.changes
        assert (Path(span.file).name, span.line) == (file, line), group.changes


def _sweep(recipe: str, file: str, step: int, session: Session, folder: Path) -> None:
    sweep = Sweep(folder, RECIPES / f"{recipe}.yaml", session)
    _check(sweep, values_of(sweep.a / file)[step // 2 :: step])


def _check(sweep: Sweep, values: list[Value]) -> None:
    named = [found for found in map(sweep.of, values) if found is not None]
    assert len(named) > len(values) / 3  # others do not build, or make no difference
    assert not [str(each) for each in named if not each.is_right]

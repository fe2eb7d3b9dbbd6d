"""Three files of robosuite that MuJoCo refuses alone, each imported as a recipe that corrects it."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from foreign.fetching import Unavailable, fetched
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.importing.recover import corrected_recipe, corrections_of

ASSETS = "robosuite/models/assets"


@pytest.fixture(scope="module")
def robosuite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    try:
        return fetched("robosuite", tmp_path_factory.mktemp("packages"))
    except Unavailable as unavailable:
        pytest.skip(str(unavailable))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "lines"),
    [
        ("grippers/xarm7_gripper.xml", ["edit: [{select: {default: xarm7_hand}, set: {group: null}}]"]),
        ("grippers/robotiq_gripper_85.xml", ['drop: [{mesh: robotiq_arg2f_base_link, where: "${index > 0}"}]']),
        (
            "bases/rethink_minimal_mount.xml",
            ["edit: [{select: {geom: pedestal_collision}, set: {material: null}}]"],
        ),
    ],
)
def test_the_recipe_of_the_import_corrects_the_file(
    robosuite: Path, tmp_path: Path, file: str, lines: list[str]
) -> None:
    part = robosuite / ASSETS / file
    with pytest.raises(ValueError, match="unrecognized attribute|repeated name|unknown material|not found"):
        mujoco.MjModel.from_xml_path(str(part))
    context = Context(environment={}, folder=tmp_path)
    corrections = corrections_of(part, context)
    assert [each.text for each in corrections] == lines
    recipe = tmp_path / "part.yaml"
    recipe.write_text(corrected_recipe(part, recipe, corrections))
    result = build(ModelRequest(recipe), context)
    assert context.sink.errors == [] and result is not None

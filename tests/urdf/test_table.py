"""The table of what a URDF has, and what of it is in the model: in the manifest of a build, and as `import` prints it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mjcompose.compose.load import Library
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.tools.importing.propose import of_urdf, table
from urdf.parts import ARM, joint, link, robot

URDF = robot(
    *ARM,
    link("tip"),
    joint("hand", "fore", "tip", '<calibration rising="0.1"/>'),
    "<gazebo><static>1</static></gazebo>",
)
MJCF = '<mujoco><worldbody><body name="stand"><geom size="0.1"/></body></worldbody></mujoco>'


def manifest(folder: Path, recipe: str, library: Library | None = None) -> dict[str, Any]:
    context = Context(environment={"MJCOMPOSE_CACHE": str(folder / "cache")}, folder=folder, fetching=Fetching())
    (folder / "recipe.yaml").write_text(recipe, encoding="utf-8")
    made = build(ModelRequest(folder / "recipe.yaml"), context, library=library)
    assert made is not None, context.sink.errors
    return dict(json.loads(made.bundle.files["manifest.json"]))


def test_the_manifest_says_what_became_of_each_urdf(tmp_path: Path) -> None:
    (tmp_path / "stand.xml").write_text(MJCF)
    (tmp_path / "arms").mkdir()
    (tmp_path / "arms" / "arm.urdf").write_text(URDF)
    (tmp_path / "arms" / "arm.yaml").write_text("recipe: 1\nbase: {model: ./arm.urdf, allow: [urdf-unread]}\n")
    attach = "{left: {model: ./arms/arm.urdf, allow: [urdf-unread]}, right: {model: ./arms/arm.yaml, pos: [0, 1, 0]}}"
    found = manifest(tmp_path, f"recipe: 1\nbase: ./stand.xml\nattach: {attach}\n")
    stand, left, right = found["inputs"]
    assert "urdf" not in stand
    assert left["urdf"] == right["urdf"]
    rows = {row["what"]: row for row in left["urdf"]}
    assert rows["joint/limit"] == {
        "what": "joint/limit",
        "count": 3,
        "became": "range and actuatorfrcrange",
        "why": None,
        "origin": "arms/arm.urdf:5",
    }
    calibration = rows["joint/calibration"]
    assert (
        calibration["became"] is None and "encoder" in calibration["why"] and calibration["origin"] == "arms/arm.urdf:8"
    )
    assert rows["gazebo/static"]["why"] == "MJCF has no words for it"


def test_a_file_that_was_read_for_another_cell_has_its_table(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    library: Library = {}
    one, other = (manifest(tmp_path, "recipe: 1\nbase: ./arm.urdf\n", library)["inputs"] for _ in range(2))
    assert len(library) == 1 and one == other and one[0]["urdf"]


def test_import_prints_the_same_rows(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    recipe = "recipe: 1\nbase: {model: ./arm.urdf, urdf: {visuals: keep}, allow: [urdf-unread]}\n"
    rows = manifest(tmp_path, recipe)["inputs"][0]["urdf"]
    found = of_urdf(tmp_path / "arm.urdf", tmp_path / "new.yaml", Context(folder=tmp_path))
    assert found is not None
    assert [(row.what, row.count, row.became, row.why, f"arm.urdf:{row.span.line}") for row in found.rows] == [
        (row["what"], row["count"], row["became"] or "", row["why"] or "", row["origin"]) for row in rows
    ]
    assert "mujoco" not in {row.what for row in found.rows}  # mjcompose adds it, the file has none
    assert any("`<joint><limit>` `velocity` (3)" in line for line in table(found.rows))

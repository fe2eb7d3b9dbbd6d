"""What a target cannot express is told where it is written; the manifest lists it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Severity
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from targets.models import RECIPES, SELDOM
from targets.writing import codes, losses, written

SENSORS = SELDOM.replace(
    "<keyframe>", '<sensor><jointpos name="a" joint="turn"/><jointvel joint="spin"/></sensor><keyframe>'
)
BALL = (
    "<mujoco><worldbody><body name='b'><joint name='swing' type='ball'/><geom size='.1'/></body></worldbody></mujoco>"
)
TOUCHING = """<mujoco><worldbody>
  <body><freejoint/><geom type="cylinder" size=".1 .1"/></body>
  <body pos="1 0 0"><freejoint/><geom name="brick" type="box" size=".1 .1 .1"/></body>
</worldbody></mujoco>"""


def test_a_loss_is_a_warning_at_its_line(tmp_path: Path) -> None:
    bundle, context = written(SENSORS, "drake", tmp_path)
    assert bundle is not None
    (warning,) = context.sink.diagnostics
    assert warning.code == "target-loss" and warning.severity is Severity.WARNING and warning.span is not None
    place = losses(context)["Drake ignores 2 sensors: `a`"]
    file, line, _ = place.rsplit(":", 2)
    assert file.endswith("model.xml") and "jointpos" in SENSORS.splitlines()[int(line) - 1]
    about = json.loads(bundle.files["manifest.json"])["target"]
    assert about["name"] == "drake"
    sensors = [each for each in about["left_out"] if each["feature"] == "sensors"]
    assert [(each["tag"], each["count"], each["names"]) for each in sensors] == [("jointpos", 2, ["a"])]


def test_what_would_be_another_model_is_refused(tmp_path: Path) -> None:
    bundle, context = written(BALL, "urdf", tmp_path)
    assert bundle is None and codes(context) == ["target-cannot"]
    (found,) = context.sink.errors
    assert found.message == "joint `swing`: URDF has no ball joints" and found.span is not None


def test_contacts_that_mjx_lacks(tmp_path: Path) -> None:
    bundle, context = written(TOUCHING, "mjx", tmp_path)
    assert bundle is None
    assert [each.message for each in context.sink.errors] == [
        "geom: MJX cannot compute contacts of a cylinder with a box"
    ]
    apart = TOUCHING.replace('name="brick"', 'name="brick" contype="0" conaffinity="0"')
    (tmp_path / "apart").mkdir()
    assert written(apart, "mjx", tmp_path / "apart")[0] is not None


def test_losses_are_allowed_or_errors(tmp_path: Path) -> None:
    written(SENSORS, "drake", tmp_path)
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(recipe.read_text().replace("[license-missing]", "[license-missing, target-loss]"))
    context = Context(folder=tmp_path)
    assert build(ModelRequest(recipe, target="drake"), context) is not None and codes(context) == []


def test_what_mujoco_reads_back_as_another_model_is_an_error(tmp_path: Path) -> None:
    text = BALL.replace("swing", "left&#9;hip")
    bundle, context = written(text, "plain", tmp_path)
    assert bundle is None and codes(context) == ["target-failed"]
    assert "reads the plain text of the model back as a different model: `names`" in context.sink.errors[0].message


@pytest.mark.parametrize("target", [None, "mjx", "warp"])
def test_the_demo_builds_without_a_warning(target: str | None, tmp_path: Path) -> None:
    """Also where nothing above its folder has a license."""
    shutil.copytree(RECIPES / "models", tmp_path / "far" / "away" / "from" / "here" / "models")
    recipe = shutil.copy(RECIPES / "demo.yaml", tmp_path / "far" / "away" / "from" / "here")
    context = Context(folder=tmp_path)
    assert build(ModelRequest(Path(recipe), target=target), context) is not None and codes(context) == []


def test_no_target_changes_nothing(tmp_path: Path) -> None:
    bundle, _ = written(SELDOM, None, tmp_path)
    assert bundle is not None and "target" not in json.loads(bundle.files["manifest.json"])

"""The target of `docs/contributing/extending.md`, added to a copy of the package and used."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from docs.test_extending_recipe import ROOT, extend, run

pytestmark = pytest.mark.slow

TITLE = "Add a target"
MODEL = """<mujoco>
  <worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody>
  <sensor><jointpos name="angle" joint="j"/></sensor>
</mujoco>
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "composer", tmp_path / "composer", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "schemas", tmp_path / "schemas")
    shutil.copytree(ROOT / "docs" / "how-to", tmp_path / "docs" / "how-to")
    (tmp_path / "recipe.yaml").write_text("recipe: 1\nbase: ./model.xml\n", encoding="utf-8")
    (tmp_path / "model.xml").write_text(MODEL, encoding="utf-8")
    return tmp_path


def test_the_target_works(package: Path) -> None:
    extend(package, TITLE)
    built = run(package, "build", "recipe.yaml", "--target", "sapien", "-o", "out/")
    assert built.returncode == 0, built.stderr
    assert "model.xml:3:11: warning[target-loss]: SAPIEN ignores 1 sensor: `angle`" in built.stderr
    about = json.loads((package / "out" / "manifest.json").read_text(encoding="utf-8"))["target"]
    assert about["name"] == "sapien"


@pytest.mark.parametrize(
    "forgotten", ["composer/mjcompose/language/target_names.py", "composer/mjcompose/targets/table.py"]
)
def test_a_forgotten_row_fails_at_import(package: Path, forgotten: str) -> None:
    extend(package, TITLE, but=forgotten)
    done = run(package, "build", "recipe.yaml", "--target", "plain", "-o", "out/")
    assert done.returncode and "sapien" in done.stderr

"""What `docs/contributing/extending.md` says of linker passes, carried out in a copy of the package."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/contributing/extending.md").read_text(encoding="utf-8").partition("## Add a linker pass")[2]
BLOCKS = re.findall(r"^```(?:python|text)\n(.*?)^```", PAGE.partition("\n## ")[0], re.MULTILINE | re.DOTALL)
ABOVE = "    _pass(sections,"
BELOW = "    _pass(compiler,"


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package with the file of the walk-through, and a recipe."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "composer", folder / "composer", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "schemas", folder / "schemas")
    (folder / "composer/mjcompose/link/part_files.py").write_text(BLOCKS[0], encoding="utf-8")
    (folder / "arm.xml").write_text('<mujoco><worldbody><site name="tool"/></worldbody></mujoco>')
    (folder / "hand.xml").write_text("<mujoco/>")
    (folder / "recipe.yaml").write_text("recipe: 1\nbase: arm.xml\nattach:\n  hand: {model: hand.xml, site: tool}\n")
    return folder


def add_row(folder: Path, row: str, *, above: str = ABOVE) -> None:
    text = (ROOT / "composer/mjcompose/link/link.py").read_text(encoding="utf-8")
    text = text.replace("from mjcompose.link.agreement", f"{BLOCKS[1]}from mjcompose.link.agreement")
    assert text.count(above) == 1
    row = textwrap.indent(row.rstrip(), "    ") + ",\n"
    (folder / "composer/mjcompose/link/link.py").write_text(text.replace(above, row + above), encoding="utf-8")


def command(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(folder / "composer"), "MJCOMPOSE_CACHE": str(folder / "store")}
    return subprocess.run(
        [sys.executable, "-P", "-m", "mjcompose", *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_pass_runs_and_explain_has_its_words(copied: Path) -> None:
    add_row(copied, BLOCKS[2])
    built = command(copied, "build", "recipe.yaml", "-o", "out/")
    assert built.returncode == 0, built.stderr
    (model,) = (copied / "out").glob("*.xml")
    assert '<text name="hand/file" data="hand.xml"/>' in model.read_text(encoding="utf-8")
    explained = command(copied, "explain", "recipe.yaml", "text hand/file")
    assert explained.returncode == 0, explained.stderr
    assert "names the file that the part was read from" in explained.stdout


def test_a_wrong_order_fails_at_import_with_the_sentence_of_the_page(copied: Path) -> None:
    add_row(copied, BLOCKS[2], above=BELOW)
    failed = command(copied, "build", "recipe.yaml", "-o", "other/")
    assert failed.returncode
    assert BLOCKS[3].strip() in failed.stderr
    assert not (copied / "other").exists()


def test_a_row_without_words_fails_at_import(copied: Path) -> None:
    add_row(copied, re.sub(r'"names the file.*?",', '"",', BLOCKS[2]))
    failed = command(copied, "build", "recipe.yaml", "-o", "other/")
    assert "the pass `part_files` has no words for `mjcompose explain`" in failed.stderr
    add_row(copied, re.sub(r' "names the file.*?",', "", BLOCKS[2]))
    assert "missing 1 required positional argument" in command(copied, "build", "recipe.yaml").stderr

"""What README.md, docs/reference/recipe.md and docs/reference/commands.md show works as it stands."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import click
import mujoco
import pytest
from mjcompose.base.report import render
from mjcompose.contrast.text import render as render_diff
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)")
FAULT = """\
recipe: 1
base: ./models/arm6/arm6.xml

attach:
  gripper:
    model: ./models/gripper2/gripper2.xml
    site: atachment_site

option: {cone: elliptic, impratio: 10}
"""
GUIDES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def blocks(name: str, kind: str) -> list[str]:
    text = (ROOT / name).read_text(encoding="utf-8")
    return [content for language, content in BLOCK.findall(text) if language == kind]


def recipes_of(name: str) -> list[str]:
    return [text for text in blocks(name, "yaml") if text.startswith("recipe:")]


def context(folder: Path, menagerie: Path) -> Context:
    return Context(folder=folder, environment={**os.environ, "MENAGERIE_ROOT": str(menagerie)})


def test_every_command_is_in_the_list() -> None:
    from mjcompose.cli.main import main

    page = (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
    names = main.list_commands(click.Context(main))
    assert names
    assert [name for name in names if not re.search(rf"(mjcompose |`){name}\b", page)] == []


@pytest.mark.parametrize("guide", GUIDES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(guide: Path) -> None:
    for target in LINK.findall(guide.read_text(encoding="utf-8")):
        assert "://" in target or (guide.parent / target).exists(), target


RECIPES = [
    (name, number, text)
    for name in ("README.md", "docs/reference/recipe.md")
    for number, text in enumerate(recipes_of(name))
]


@pytest.mark.parametrize(("name", "number", "text"), RECIPES, ids=[f"{name}-{n}" for name, n, _ in RECIPES])
def test_a_recipe_builds_without_a_word(
    name: str, number: int, text: str, tmp_path: Path, menagerie_root: Path
) -> None:
    if "franka" in text and not os.environ.get("MJCOMPOSE_CORPUS"):
        pytest.skip("MJCOMPOSE_CORPUS names no corpus")
    (tmp_path / "models").symlink_to(ROOT / "recipes" / "models")
    (tmp_path / "r.yaml").write_text(text, encoding="utf-8")
    told = context(tmp_path, menagerie_root)
    assert build(ModelRequest(tmp_path / "r.yaml"), told) is not None
    assert told.sink.diagnostics == []


def test_the_fault_of_the_readme_is_told_as_it_shows(tmp_path: Path, menagerie_root: Path) -> None:
    (tmp_path / "models").symlink_to(ROOT / "recipes" / "models")
    (tmp_path / "arm.yaml").write_text(FAULT, encoding="utf-8")
    told = context(tmp_path, menagerie_root)
    assert build(ModelRequest(tmp_path / "arm.yaml"), told) is None
    (fault,) = told.sink.diagnostics
    shown = next(text for text in blocks("README.md", "text") if "error[" in text)
    assert render(fault, lambda file: FAULT) == shown.rstrip("\n")
    assert shown in blocks("docs/reference/commands.md", "text")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="the commands are of a POSIX shell")
def test_the_list_of_commands_runs(tmp_path: Path) -> None:
    commands = next(text for text in blocks("docs/reference/commands.md", "sh") if "mjcompose new model.yaml" in text)
    commands = "".join(
        line
        for line in commands.splitlines(True)
        if not re.search(" (import|migrate|upgrade|diff|view|lsp|mcp|plugin) ", line)
    )  # of files of one's own, or with an editor at the other end
    # A page that is served is served until the user ends it.
    served = f"timeout 5 {shlex.quote(sys.executable)} -m mjcompose view model.yaml --no-open || [ $? = 124 ]"
    commands = commands.replace("mjcompose view model.yaml  ", f"{served}  ", 1)
    script = f'set -e\nmjcompose() {{ {shlex.quote(sys.executable)} -m mjcompose "$@"; }}\n{commands}'
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    subprocess.run(["bash", "-c", script], cwd=tmp_path, env=environment, check=True, timeout=240)
    assert (tmp_path / "build" / "model.zip").is_file()
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "model.xml")).nq == 1
    assert mujoco.MjModel.from_binary_path(str(tmp_path / "model.mjb")).nq == 1


@pytest.mark.skipif(sys.platform == "win32", reason="the commands are of a POSIX shell")
@pytest.mark.skipif(shutil.which("git") is None or shutil.which("perl") is None, reason="needs git and perl")
def test_the_diff_of_the_demo_is_what_its_edits_give(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "recipes", tmp_path / "recipes")
    author = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    for words in (["init", "-q"], ["add", "."], [*author, "commit", "-q", "-m", "first"]):
        subprocess.run(["git", *words], cwd=tmp_path, check=True)
    edits = next(text for text in blocks("docs/how-to/review.md", "sh") if "perl" in text)
    subprocess.run(["bash", "-e", "-c", edits], cwd=tmp_path, check=True)
    shown = next(text for text in blocks("docs/how-to/review.md", "text") if text.startswith("$ mjcompose diff"))
    command, expected = shown.split("\n", 1)
    with Session() as session:
        found = diff(*command.split()[3:], Context(folder=tmp_path), session)
    assert found is not None
    assert render_diff(found) == expected.rstrip("\n")

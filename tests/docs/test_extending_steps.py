"""Chapters of `docs/contributing/extending.md` with their commands, carried out in a copy of the repository."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from docs.test_extending_recipe import ROOT, chapter, extend

pytestmark = pytest.mark.slow

COPIED = ("composer", "docs", "recipes", "schemas", "tests", ".ci")
BIN = Path(sys.executable).parent
LINTERS = (
    [str(BIN / "ruff"), "check"],
    [str(BIN / "ruff"), "format", "--check"],
    [str(BIN / "lint-imports"), "--no-logo", "--no-cache"],
)
"""The parts of `make lint-style` that judge code; the others would judge the whole repository again."""


def steps(title: str) -> list[str]:
    return [
        line
        for block in re.findall(r"^```sh\n(.*?)^```", chapter(title), re.DOTALL | re.MULTILINE)
        for line in block.splitlines()
    ]


TITLES = ("Add a rule of the linter",)


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    ignored = shutil.ignore_patterns("__pycache__", "node_modules", "pictures")
    for name in COPIED:
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored, symlinks=True)
    for path in ROOT.iterdir():
        if path.is_file():
            shutil.copy2(path, tmp_path)
    (tmp_path / "build").mkdir()
    return tmp_path


def run(repository: Path, *command: str) -> None:
    environment = {**os.environ, "PYTHONPATH": str(repository / "composer"), "PYTHONSAFEPATH": "1"}
    done = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{shlex.join(command)}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


def carry_out(repository: Path, line: str) -> None:
    """Carry out a line as a reader would, with the environment of these tests."""
    words = shlex.split(line)
    if line == "make lint-style":
        for command in LINTERS:
            run(repository, *command)
    elif words[0] == "make":
        ready = f"--old-file={BIN.parent}/.ready"
        run(repository, "make", ready, f"VENV={BIN.parent}", *words[1:])
    elif words[0] == ".venv/bin/python":
        run(repository, sys.executable, *words[1:], "-q", "-p", "no:cacheprovider", "-m", "not slow")
    else:
        run(repository, "bash", "-ec", line)


@pytest.mark.parametrize("title", TITLES)
def test_a_chapter_can_be_followed(title: str, repository: Path) -> None:
    extend(repository, title)
    for line in steps(title):
        carry_out(repository, line)

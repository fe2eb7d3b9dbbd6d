"""The chapters of `docs/contributing/extending.md` with commands, each carried out in a copy of the repository."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from docs.test_extending_recipe import PAGE, ROOT, chapter, extend, files

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="the commands are of a POSIX shell"),
    pytest.mark.skipif(shutil.which("git") is None, reason="`.ci/english` needs git"),
]

COPIED = ("composer", "docs", "recipes", "schemas", "tests", ".ci", "bench", "editors")
UNCOPIED = shutil.ignore_patterns("node_modules", "pictures", ".pytest_cache")
"""Bytecode is copied: the copies of the files are as old as the files, so Python takes it."""
BIN = Path(sys.executable).parent
LINTERS = (
    [str(BIN / "ruff"), "check"],
    [str(BIN / "ruff"), "format", "--check"],
    [str(BIN / "lint-imports"), "--no-logo", "--no-cache"],
)
"""The parts of `make lint-style` that judge the whole repository fast."""
NPM = ROOT / "build" / "npm"
"""Where `make lint-page` installs what checks and builds the page of `view`."""


def steps(title: str) -> list[str]:
    return [
        line
        for block in re.findall(r"^```sh\n(.*?)^```", chapter(title), re.DOTALL | re.MULTILINE)
        for line in block.splitlines()
    ]


TITLES = [title for title in re.findall(r"^## (.*)", PAGE, re.MULTILINE) if steps(title)]


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the repository has, without the environment and without git's data, which belong to another folder."""
    folder = tmp_path_factory.mktemp("original")
    for name in COPIED:
        shutil.copytree(ROOT / name, folder / name, ignore=UNCOPIED, symlinks=True)
    for path in ROOT.iterdir():
        if path.is_file() and path.name != ".git":
            shutil.copy2(path, folder)
    (folder / "build").mkdir()
    subprocess.run(["git", "init", "--quiet"], cwd=folder, check=True)
    return folder


@pytest.fixture
def repository(original: Path, tmp_path: Path) -> Iterator[Path]:
    folder = tmp_path / "repository"
    shutil.copytree(original, folder, symlinks=True)
    yield folder
    shutil.rmtree(folder)


def run(repository: Path, *command: str) -> None:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    environment |= {"PYTHONPATH": str(repository / "composer"), "PYTHONSAFEPATH": "1"}
    done = subprocess.run(command, cwd=repository, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{shlex.join(command)}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


def lint_style(repository: Path, written: list[str]) -> None:
    """Judge the code of the repository, and the words and the safety of the written files."""
    for command in LINTERS:
        run(repository, *command)
    if written:
        run(repository, str(BIN / "codespell"), *written)
        run(repository, sys.executable, ".ci/english", *written)
    if code := [path for path in written if path.endswith(".py")]:
        run(repository, str(BIN / "bandit"), "--quiet", "--configfile", "pyproject.toml", *code)


def install_page(repository: Path) -> None:
    """Take what `make lint-page` installed: npm would download it again."""
    if shutil.which("npm") is None or not (NPM / "installed.json").exists():
        pytest.skip("`make lint-page` has not installed what builds the page")
    (repository / "build" / "npm").symlink_to(NPM)
    (repository / "composer" / "viewer" / "node_modules").symlink_to(NPM / "node_modules")


def carry_out(repository: Path, line: str, written: list[str]) -> None:
    """Carry out a line as a reader would, with the environment of these tests."""
    words = shlex.split(line)
    if line == "make lint-style":
        lint_style(repository, written)
    elif words[0] == "make":
        ready = f"--old-file={BIN.parent}/.ready"
        run(repository, "make", ready, f"VENV={BIN.parent}", *words[1:])
    elif words[0] == ".venv/bin/python":
        run(repository, sys.executable, *words[1:], "-q", "-p", "no:cacheprovider")
    elif "npm ci && " in line:
        install_page(repository)
        run(repository, "bash", "-ec", line.replace("npm ci && ", ""))
    else:
        raise AssertionError(f"no way to carry out {line}")


def test_chapters_with_files_in_the_repository_have_commands() -> None:
    assert {"Add a recipe section", "Add a verb of `edit`", "Add a check", "Add a rule of the linter"} <= {*TITLES}
    assert {"Add a target", "Add a tool of the page of `view`"} <= {*TITLES}
    lines = {title: steps(title) for title in TITLES}
    assert [title for title, line in lines.items() if "-m pytest" not in line[-1]] == []


@pytest.mark.parametrize("title", TITLES)
def test_a_chapter_can_be_followed(title: str, repository: Path) -> None:
    extend(repository, title)
    for line in steps(title):
        carry_out(repository, line, [*files(title)])

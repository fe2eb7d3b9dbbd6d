"""What is in the working folder is in the repository, and so in every clone and wheel."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.skipif(shutil.which("git") is None or not (ROOT / ".git").exists(), reason="no clone of a repository")
def test_no_module_is_ignored() -> None:
    files = [path.relative_to(ROOT).as_posix() for path in (ROOT / "composer").rglob("*.py")]
    # Without the index: a file that is tracked may be ignored all the same, and a new one beside it is lost.
    command = ["git", "check-ignore", "--no-index", "--stdin"]
    found = subprocess.run(command, cwd=ROOT, input="\n".join(files), capture_output=True, text=True, check=False)
    assert files and found.returncode in (0, 1), found.stderr
    assert found.stdout.split() == []


def test_whatever_checks_recipes_for_a_team_checks_every_cell() -> None:
    hooks = (ROOT / ".pre-commit-hooks.yaml").read_text()
    assert "entry: mjcompose check\n  args: [--all]" in hooks
    written = ("action.yml", "composer/mjcompose/tools/project/pre-commit-config.yaml", "docs/how-to/teams.md")
    for path in written:
        commands = re.findall(r"(?:run:|entry:) mjcompose check.*|^mjcompose check.*", (ROOT / path).read_text(), re.M)
        assert commands and all("--all" in each for each in commands), path


@pytest.mark.skipif(shutil.which("git") is None or not (ROOT / ".git").exists(), reason="no clone of a repository")
def test_no_package_and_no_very_large_file_is_kept() -> None:
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    files = [ROOT / name for name in listed.split("\0") if name]
    kept = [path for path in files if path.is_file()]
    assert kept and not [path.name for path in kept if path.suffix in (".whl", ".egg", ".gz")]
    assert max(path.stat().st_size for path in kept) < 2 << 20

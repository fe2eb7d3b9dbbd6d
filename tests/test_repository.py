"""What is in the working folder is in the repository, and so in every clone and wheel."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.skipif(
    shutil.which("git") is None or not (ROOT / ".git").exists(), reason="no clone of a repository"
)
def test_no_module_is_ignored() -> None:
    files = [path.relative_to(ROOT).as_posix() for path in (ROOT / "composer").rglob("*.py")]
    # Without the index: a file that is tracked may be ignored all the same, and a new one beside it is lost.
    command = ["git", "check-ignore", "--no-index", "--stdin"]
    found = subprocess.run(
        command, cwd=ROOT, input="\n".join(files), capture_output=True, text=True, check=False
    )
    assert files and found.returncode in (0, 1), found.stderr
    assert found.stdout.split() == []

"""`python -OO` removes docstrings and assertions: the main commands say the same without them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
COMMANDS = """
import sys
from pathlib import Path
from click.testing import CliRunner
from mjcompose.base.codes import CODES
from mjcompose.cli.main import main
from mjcompose.lint.rule import rules

out = sys.argv[1]
recipe = "recipes/demo.yaml"
model = "recipes/models/table/table.xml"
calls = [
    ["--help"],
    *([command, "--help"] for command in sorted(main.list_commands(None)) if command not in ("mcp",)),
    ["cache", "prune", "--help"],
    ["plan", recipe],
    ["build", recipe, "-o", f"{out}/demo.zip"],
    ["check", recipe],
    ["lint", model],
    ["explain", recipe, "body world"],
    ["explain", "tests/golden/edit/recipe.yaml", "*"],
    ["explain", "file-not-found"],
    ["explain", "unused-mesh"],
    ["names", recipe],
    ["build", "nowhere.yaml"],
    ["schema"],
]
for call in calls:
    result = CliRunner().invoke(main, call, prog_name="mjcompose")
    print(">", *call, result.exit_code, result.output, sep="\\n")
for rule in rules().values():
    print(rule.code, rule.summary, CODES[rule.code])
"""


def _said(tmp_path: Path, *flags: str) -> str:
    tmp_path.mkdir()
    done = subprocess.run(
        [sys.executable, *flags, "-c", COMMANDS, str(tmp_path)],
        cwd=REPOSITORY,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "100"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.replace(str(tmp_path), "OUT")


@pytest.mark.slow
def test_commands_say_the_same_without_docstrings(tmp_path: Path) -> None:
    plain = _said(tmp_path / "plain")
    assert len(plain) > 20_000
    assert _said(tmp_path / "optimized", "-OO") == plain

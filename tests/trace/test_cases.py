"""Every file in `cases` is a call of `mjcompose explain`, its folder in front, and what it prints.

`UPDATE_EXPECTED=1 pytest tests/trace` writes the answers anew; read what changed.
"""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest
from cases import uncounted
from click.testing import CliRunner
from mjcompose.cli.main import main

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
CASES = sorted(path.stem for path in (HERE / "cases").glob("*.txt"))


@pytest.mark.parametrize("case", CASES)
def test_answer(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    file = HERE / "cases" / f"{case}.txt"
    asked, _, expected = file.read_text(encoding="utf-8").partition("\n")
    folder, _, call = asked.partition(" $ mjcompose ")
    monkeypatch.chdir(REPOSITORY / folder)
    result = CliRunner().invoke(main, shlex.split(call), prog_name="mjcompose")
    told = uncounted(result.output if result.exit_code == 0 else f"{result.output}exit code {result.exit_code}\n")
    if os.environ.get("UPDATE_EXPECTED"):
        file.write_text(f"{asked}\n{told}", encoding="utf-8")
    else:
        assert told == expected


def test_there_are_cases() -> None:
    assert len(CASES) >= 25

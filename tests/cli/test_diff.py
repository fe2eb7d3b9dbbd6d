from __future__ import annotations

import json
from pathlib import Path

from cli.shell import RECIPE, run, snapshot


def _changed(folder: Path) -> None:
    (folder / "new.yaml").write_text(RECIPE + "option: {timestep: 0.001}\n")


def test_exit_codes(folder: Path) -> None:
    _changed(folder)
    before = snapshot(folder)
    result = run("diff", "cell.yaml", "cell.yaml")
    assert result.exit_code == 0 and "the same" in result.stdout
    result = run("diff", "cell.yaml", "new.yaml")
    assert result.exit_code == 1 and result.stderr == ""
    assert "new.yaml:8\n" in result.stdout
    assert "option timestep: 0.002 s → 0.001 s (−50 %)" in result.stdout
    result = run("diff", "cell.yaml", "wrong.yaml")
    assert result.exit_code == 2 and "error[attach-place]" in result.stderr and result.stdout == ""
    assert run("diff", "cell.yaml").exit_code == 2
    assert run("diff", "cell.yaml", "new.yaml", "--only", "bodi").exit_code == 2
    assert run("diff", "cell.yaml", "new.yaml", "--set", "x").exit_code == 2
    assert run("diff", "cell.yaml", "new.yaml", "--only", "body").exit_code == 0
    assert snapshot(folder) == before


def test_formats(folder: Path) -> None:
    _changed(folder)
    told = json.loads(run("diff", "cell.yaml", "new.yaml", "--json").stdout)
    assert told["groups"][0]["changes"][0]["field"] == "timestep"
    assert run("diff", "cell.yaml", "new.yaml", "--format", "markdown").stdout.startswith("### `cell.yaml`")
    told = json.loads(run("diff", "cell.yaml", "wrong.yaml", "--json").stdout)
    assert told["code"] == "attach-place"

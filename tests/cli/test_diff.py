from __future__ import annotations

import json
from pathlib import Path

import pytest
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


def test_exit_codes_of_breaking(folder: Path) -> None:
    for name, change, code, level in (
        ("minor.yaml", "option: {timestep: 0.001}\n", 1, "minor"),
        ("major.yaml", "actuator: {push: {type: motor, joint: shoulder}}\n", 2, "major"),
        ("patch.yaml", "visual: {headlight: {ambient: [1, 1, 1]}}\n", 0, "patch"),
        ("same.yaml", "", 0, None),
    ):
        (folder / name).write_text(RECIPE + change)
        result = run("diff", "--breaking", "cell.yaml", name)
        assert (result.exit_code, result.stderr) == (code, "")
        assert result.stdout.splitlines()[2].startswith(level or "the same")
        data = json.loads(run("diff", "--breaking", "cell.yaml", name, "--output-format", "json").stdout)
        assert data["level"] == level and list(data["levels"]) == ([level] if level else [])
        comments = [
            run("diff", "--breaking", "cell.yaml", name, "--output-format", form).stdout
            for form in ("github", "markdown")
        ]
        assert comments[0] == comments[1] and comments[0].startswith("### `cell.yaml` → ")
    assert run("diff", "--breaking", "cell.yaml", "wrong.yaml").exit_code == 2


def test_computed_numbers_are_listed_when_asked_for(folder: Path) -> None:
    (folder / "new.yaml").write_text(RECIPE.replace("site: flange", "site: flange, pos: [0, 0, 0.1]"))
    assert "--computed lists them" in run("diff", "cell.yaml", "new.yaml").stdout
    assert "--computed" not in run("diff", "cell.yaml", "new.yaml", "--computed").stdout
    result = run("diff", "cell.yaml", "new.yaml", "--all")
    assert result.exit_code == 2 and "'--computed'" in result.stderr and result.stdout == ""


@pytest.mark.parametrize("option", ["--tolerance", "--timeout"])
@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e999", "-1"])
def test_what_is_no_amount_is_a_usage_error(folder: Path, option: str, value: str) -> None:
    result = run("diff", "cell.yaml", "cell.yaml", f"{option}={value}")
    assert result.exit_code == 2 and option in result.stderr and result.stdout == ""


def test_formats(folder: Path) -> None:
    _changed(folder)
    told = json.loads(run("diff", "cell.yaml", "new.yaml", "--output-format", "json").stdout)
    assert told["groups"][0]["changes"][0]["field"] == "timestep"
    assert run("diff", "cell.yaml", "new.yaml", "--output-format", "markdown").stdout.startswith("### `cell.yaml`")
    told = json.loads(run("diff", "cell.yaml", "wrong.yaml", "--output-format", "json").stdout)
    assert told["code"] == "attach-place"


def test_a_cell_of_the_matrix(folder: Path) -> None:
    matrix = "params: {load: 1}\nmatrix: {axes: {load: [1, 2]}, name: 'cell-${load}'}\n"
    (folder / "a.yaml").write_text(RECIPE + matrix)
    (folder / "b.yaml").write_text(RECIPE + matrix + "option: {timestep: '${0.002 if load == 1 else 0.001}'}\n")
    narrow = "compared at its defaults; `--pick CELL` compares one of the 2 cells of the matrix"
    result = run("diff", "a.yaml", "b.yaml")
    assert (result.exit_code, result.stdout.splitlines()[3]) == (0, narrow)
    markdown = run("diff", "a.yaml", "b.yaml", "--output-format", "markdown").stdout
    assert f"<sub>C{narrow[1:]}</sub>" in markdown
    result = run("diff", "a.yaml", "b.yaml", "--pick", "cell-2")
    assert result.exit_code == 1
    assert result.stdout.startswith("A a.yaml: cell-2\nB b.yaml: cell-2\ndifferent: ")
    told = json.loads(run("diff", "a.yaml", "b.yaml", "--pick", "cell-1", "--output-format", "json").stdout)
    assert (told["same"], told["a"]["cell"]) == (True, "cell-1")
    result = run("diff", "a.yaml", "b.yaml", "--pick", "cell-3")
    assert result.exit_code == 2
    assert "error[unknown-name]: the matrix of `a.yaml` has no cell `cell-3`" in result.stderr
    result = run("diff", "a.yaml", "cell.yaml", "--pick", "cell-1")
    assert result.exit_code == 2 and "there are no cells" in result.stderr
    result = run("diff", "a.yaml", "b.yaml", "--pick", "cell-1", "--set", "load=2")
    assert result.exit_code == 2 and "is an axis of the matrix" in result.stderr


def test_a_sample(folder: Path) -> None:
    """One sample of either recipe is compared with the same of the other."""
    draw = "{select: {joint: '**'}, attr: damping, uniform: [1, 2]}"
    draws = f"randomize: {{seed: SEED, samples: 2, fields: {{damping: {draw}}}}}\n"
    (folder / "a.yaml").write_text(RECIPE + draws.replace("SEED", "1"))
    (folder / "b.yaml").write_text(RECIPE + draws.replace("SEED", "2"))
    assert run("diff", "a.yaml", "b.yaml").exit_code == 0
    assert "damping of joint" in run("diff", "a.yaml", "b.yaml", "--sample", "1").stdout
    result = run("diff", "a.yaml", "b.yaml", "--sample", "3")
    assert result.exit_code == 2 and "sample 3 does not exist" in result.stderr
    result = run("diff", "models/arm.xml", "models/arm.xml", "--sample", "1")
    assert result.exit_code == 2 and "neither `models/arm.xml`" in result.stderr


def test_a_page_of_both(folder: Path) -> None:
    _changed(folder)
    result = run("diff", "cell.yaml", "new.yaml", "--html", "out/diff.html")
    assert result.exit_code == 1 and result.stderr == "wrote out/diff.html: open it in a browser\n"
    assert (folder / "out" / "diff.html").read_text("utf-8").count("class=model") == 2
    (folder / "file").write_text("")
    result = run("diff", "cell.yaml", "new.yaml", "--html", "file/diff.html")
    assert result.exit_code == 2 and "error[output-unwritable]" in result.stderr and result.stdout == ""

"""What `mjcompose identify` may replace."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli.shell import run
from tools.identify import robots

RECIPE = """recipe: 1
allow: [license-missing]
base: ./arm.xml
identify: {fields: {damping: {select: {joint: elbow}, attr: damping, range: [0, 20]}}}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.xml").write_text(robots.MODEL.format(**robots.RECIPE))
    (tmp_path / "fit.yaml").write_text(RECIPE)
    robots.write_csv(tmp_path / "run.csv", robots.recorded(robots.model(damping=0.9), 1.0))
    return tmp_path


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("other.yaml", "recipe: 1\nmeasured: A12.yaml\nbase: ./arm.xml\n"),
        ("run2.csv", "time,qpos elbow\n0,0\n"),
        ("fit.yaml", None),
        ("run.csv", None),
    ],
)
def test_other_files_are_not_replaced_and_nothing_is_fitted(name: str, text: str | None, folder: Path) -> None:
    if text is not None:
        (folder / name).write_text(text)
    before = (folder / name).read_bytes()
    result = run("identify", "fit.yaml", "run.csv", "-o", name)
    assert result.exit_code == 1
    assert "error[output-unwritable]" in result.output
    assert "simulated steps" not in result.output
    assert (folder / name).read_bytes() == before


def test_an_older_file_of_measurements_is_replaced(folder: Path) -> None:
    for _ in range(2):
        result = run("identify", "fit.yaml", "run.csv", "-o", "A12.yaml")
        assert (result.exit_code, "wrote A12.yaml" in result.output) == (0, True), result.output

"""What `mjcompose identify` writes, and what it may replace."""

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


def test_a_page_of_the_fit(folder: Path) -> None:
    result = run("identify", "fit.yaml", "run.csv", "--name", "A12 <b>", "--report", "pages/fit.html")
    assert result.exit_code == 0, result.output
    assert "wrote pages/fit.html" in result.output
    page = (folder / "pages" / "fit.html").read_text()
    assert "<h1>A12 &lt;b&gt;</h1>" in page
    assert page.count("<figure>") == 2 and "There is no held-out recording" in page, "the recording is too short"
    assert page.count('<path class=recorded d="M0 ') == 2


def test_a_fit_that_is_an_error_has_a_page_and_no_file(folder: Path) -> None:
    robots.write_csv(folder / "other.csv", robots.recorded(robots.model(damping=0.1), 1.0))
    options = ("--hold-out", "other.csv", "-o", "A12.yaml", "--report", "fit.html")
    result = run("identify", "fit.yaml", "run.csv", *options)
    assert result.exit_code == 1 and "error[worse-than-recipe]" in result.output
    assert "Do not use these numbers yet." in (folder / "fit.html").read_text()
    assert not (folder / "A12.yaml").exists()


@pytest.mark.parametrize("name", ["run.csv", "fit.yaml"])
def test_a_page_replaces_no_input(name: str, folder: Path) -> None:
    before = (folder / name).read_bytes()
    result = run("identify", "fit.yaml", "run.csv", "--report", name)
    assert result.exit_code == 1
    assert "error[output-unwritable]" in result.output and "simulated steps" not in result.output
    assert (folder / name).read_bytes() == before


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--plan", "--report", "fit.html"), "--report is the page of a fit"),
        (("--plan", "-o", "A12.yaml"), "-o is the file of a fit"),
        (("-o", "same.yaml", "--report", "./same.yaml"), "the same file"),
    ],
)
def test_options_that_contradict_each_other(options: tuple[str, ...], said: str, folder: Path) -> None:
    result = run("identify", "fit.yaml", "run.csv", *options)
    assert result.exit_code == 2 and said in result.output
    assert not [*folder.glob("*.html"), *folder.glob("same.yaml"), *folder.glob("A12.yaml")]

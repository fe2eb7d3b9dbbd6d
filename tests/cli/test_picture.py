"""`build --picture`."""

from __future__ import annotations

import json
from pathlib import Path
from zipfile import ZipFile

import pytest
from cli.shell import RECIPE, run

PNG = b"\x89PNG\r\n\x1a\n"


def _build(*words: str) -> str:
    result = run("build", *words, "--picture")
    if "no-rendering" in result.stderr:
        pytest.skip("there is no OpenGL")
    assert result.exit_code == 0, result.stderr
    return result.stdout


def test_a_picture_stands_beside_the_bundle_and_in_its_manifest(folder: Path) -> None:
    assert "  picture cell.png\n" in _build("cell.yaml", "-o", "out/arm.zip")
    picture = folder / "out" / "cell.png"
    assert picture.read_bytes().startswith(PNG)
    with ZipFile(folder / "out" / "arm.zip") as bundle:
        assert json.loads(bundle.read("manifest.json"))["picture"] == "cell.png"
    run("build", "cell.yaml", "-o", "out/other.zip")
    with ZipFile(folder / "out" / "other.zip") as bundle:
        assert "picture" not in json.loads(bundle.read("manifest.json"))
    picture.unlink()
    assert json.loads(_build("cell.yaml", "-o", "out/arm.zip", "--output-format", "json"))["picture"] == "cell.png"
    first = picture.read_bytes()
    (folder / "models" / "tool.xml").write_text(
        (folder / "models" / "tool.xml").read_text().replace("0.03 0.03 0.01", "0.3 0.3 0.1")
    )
    _build("cell.yaml", "-o", "out/arm.zip")
    assert picture.read_bytes() != first


@pytest.mark.slow
def test_every_cell_has_its_own(folder: Path) -> None:
    matrix = "params: {load: 1}\nmatrix: {axes: {load: [1, 2]}, name: 'cell-${load}'}\n"
    (folder / "cells.yaml").write_text(RECIPE + matrix)
    _build("cells.yaml", "--all", "-o", "out/{name}/")
    assert sorted(each.name for each in (folder / "out").glob("*.png")) == ["cell-1.png", "cell-2.png"]


@pytest.mark.parametrize("out", ["-", "cell.mjb", "memory://models/cell.zip"])
def test_what_has_no_picture_is_an_error(folder: Path, out: str) -> None:
    result = run("build", "cell.yaml", "-o", out, "--picture")
    assert result.exit_code == 2 and "error[output-kind]" in result.stderr and "--picture" in result.stderr
    assert not (folder / "cell.mjb").exists()


def test_without_opengl_the_bundle_is_written_and_the_fault_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    result = run("build", "cell.yaml", "-o", "cell.zip", "--picture")
    assert result.exit_code == 1 and result.stderr.count("error[") == 1
    assert "error[no-rendering]" in result.stderr
    assert (folder / "cell.zip").is_file() and not (folder / "cell.png").exists()

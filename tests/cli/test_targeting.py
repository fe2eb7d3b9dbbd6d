"""`build --target`."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import pytest
from cli.shell import run


def test_a_folder_for_another_program(folder: Path) -> None:
    result = run("build", "cell.yaml", "--target", "plain", "-o", "out/")
    assert result.exit_code == 0, result.stderr
    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    assert manifest["target"] == {"name": "plain", "left_out": []}
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml"))
    assert [each["name"] for each in manifest["index"]["joints"]] == [
        model.joint(n).name for n in range(model.njnt)
    ]
    assert run("verify", "out").exit_code == 0
    again = run("build", "cell.yaml", "--target", "plain", "-o", "out/")
    assert "up to date" in again.stdout
    assert "up to date" not in run("build", "cell.yaml", "-o", "out/").stdout
    assert "target" not in json.loads((folder / "out" / "manifest.json").read_text())


def test_what_mujoco_does_not_read_is_verified_by_its_files(folder: Path) -> None:
    assert run("build", "cell.yaml", "--target", "urdf", "-o", "cell.zip").exit_code == 0
    assert "cell.zip: ok: " in run("verify", "cell.zip").stdout
    run("build", "cell.yaml", "--target", "urdf", "-o", "out/")
    (folder / "out" / "model.srdf").write_text("<robot/>")
    changed = run("verify", "out")
    assert changed.exit_code == 1 and "error[bundle-changed]" in changed.stderr


def test_mujoco_is_no_target_of_its_own(folder: Path) -> None:
    run("build", "cell.yaml", "-o", "a.zip")
    run("build", "cell.yaml", "--target", "mujoco", "-o", "b.zip")
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


def test_strict_makes_errors_of_losses(folder: Path) -> None:
    lost = run("build", "cell.yaml", "--target", "pinocchio", "-o", "out/")
    assert lost.exit_code == 0 and "warning[target-loss]: Pinocchio ignores 1 sensor: `angle`" in lost.stderr
    refused = run("build", "cell.yaml", "--target", "pinocchio", "-o", "strict/", "--strict")
    assert refused.exit_code == 1 and "error[target-loss]" in refused.stderr
    assert not (folder / "strict").exists()


@pytest.mark.parametrize("out", ["cell.xml", "cell.mjb", "cell.usdz", "-"])
def test_an_output_of_one_file_has_no_room(out: str, folder: Path) -> None:
    result = run("build", "cell.yaml", "--target", "urdf", "-o", out)
    assert result.exit_code == 2 and "error[output-kind]" in result.stderr
    assert "-o build/urdf/" in result.stderr


def test_what_is_not_verified_has_no_target(folder: Path) -> None:
    result = run("build", "cell.yaml", "--target", "plain", "--no-verify", "-o", "out/")
    assert result.exit_code == 2 and "leave `--no-verify` out" in result.stderr


def test_an_unknown_target(folder: Path) -> None:
    result = run("build", "cell.yaml", "--target", "plan", "-o", "out/")
    assert result.exit_code == 2
    words = " ".join(result.stderr.split())
    assert "the target `plan` does not exist. Did you mean `plain`? Targets: mujoco, plain, drake," in words

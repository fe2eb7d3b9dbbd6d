"""`build --target`."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import pytest
from cli.shell import run as run_shell
from click.testing import CliRunner
from mjcompose.base.limits import Limits, in_force
from mjcompose.cli.main import main

MODEL = '<mujoco><worldbody><replicate count="9"><geom size=".1"/></replicate></worldbody></mujoco>'


@pytest.fixture
def recipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "m.xml").write_text(MODEL)
    (tmp_path / "r.yaml").write_text("recipe: 1\nbase: ./m.xml\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    return "r.yaml"


def run(*arguments: str) -> tuple[int, str]:
    done = CliRunner().invoke(main, arguments)
    return done.exit_code, done.output


@pytest.mark.parametrize(
    "command",
    [
        ("build", "r.yaml", "--no-compile", "-o", "out/"),
        ("check", "r.yaml", "--no-compile"),
        ("explain", "r.yaml", "option"),
        ("import", "m.xml", "m.xml", "-o", "new.yaml"),
        ("diff", "m.xml", "m.xml"),
    ],
)
def test_every_command_that_reads_models_takes_limits(recipe: str, command: tuple[str, ...]) -> None:
    code, said = run(*command, "--limit", "expansion=7")
    assert code and "makes 8 elements; 7 are allowed" in said, said
    assert in_force() == Limits()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("expension=7", "the limit `expension` does not exist. Did you mean `expansion`?"),
        ("expansion=many", "`expansion=many` gives no value: write `expansion=50000`."),
        ("memory=-1", "`memory=-1` gives no value: write `memory=2G`."),
        ("time", "`time` gives no value: write `time=600`."),
    ],
)
def test_what_is_no_limit(recipe: str, given: str, said: str) -> None:
    code, output = run("check", recipe, "--limit", given)
    assert code == 2 and said in " ".join(output.split())


@pytest.mark.parametrize("option", [("--timeout", "7"), ("--limit", "time=7")])
def test_the_time_of_mujoco_has_two_names(
    recipe: str, option: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from mjcompose.mujoco.engine import Session

    seen: list[float] = []

    class Seeing(Session):
        def __init__(self, *, remembers: bool) -> None:
            super().__init__(remembers=remembers)
            seen.append(self.limits.seconds)

    monkeypatch.setattr("mjcompose.mujoco.engine.Session", Seeing, raising=False)
    assert run("check", recipe, "--no-compile", *option)[0] == 0
    assert seen == [7]


def test_more_faults_than_are_looked_for(recipe: str, tmp_path: Path) -> None:
    geoms = "".join(f'<geom name="{number}" size=".1" material="m{number}"/>' for number in range(9))
    (tmp_path / "m.xml").write_text(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    code, said = run("check", recipe, "--limit", "faults=5")
    assert code == 1 and "there are more than 5 errors" in said and "`m5`" in said and "`m6`" not in said, said
    code, said = run("check", recipe, "--limit", "faults=5", "--output-format", "json")
    assert code == 1 and said.count('"code": "unknown-name"') == 6, said


def test_more_models_than_one_command_builds(recipe: str, tmp_path: Path) -> None:
    (tmp_path / recipe).write_text(
        "recipe: 1\nbase: ./m.xml\nparams: {a: {default: 1}}\n"
        "randomize: {seed: 1, samples: 9, fields: {a: {param: a, uniform: [0, 1]}}}\n"
    )
    code, said = run("build", recipe, "--all", "--no-compile", "-o", "out/{name}.zip", "--limit", "models=9")
    assert code and "there are more than 9 models in all" in said, said
    assert not (tmp_path / "out").exists()


def test_a_folder_for_another_program(folder: Path) -> None:
    result = run_shell("build", "cell.yaml", "--target", "plain", "-o", "out/")
    assert result.exit_code == 0, result.stderr
    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    assert manifest["target"] == {"name": "plain", "left_out": []}
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml"))
    assert [each["name"] for each in manifest["index"]["joints"]] == [model.joint(n).name for n in range(model.njnt)]
    assert run_shell("verify", "out").exit_code == 0
    again = run_shell("build", "cell.yaml", "--target", "plain", "-o", "out/")
    assert "up to date" in again.stdout
    assert "up to date" not in run_shell("build", "cell.yaml", "-o", "out/").stdout
    assert "target" not in json.loads((folder / "out" / "manifest.json").read_text())


def test_what_mujoco_does_not_read_is_verified_by_its_files(folder: Path) -> None:
    assert run_shell("build", "cell.yaml", "--target", "urdf", "-o", "cell.zip").exit_code == 0
    assert "cell.zip: ok: " in run_shell("verify", "cell.zip").stdout
    run_shell("build", "cell.yaml", "--target", "urdf", "-o", "out/")
    (folder / "out" / "model.srdf").write_text("<robot/>")
    changed = run_shell("verify", "out")
    assert changed.exit_code == 1 and "error[bundle-changed]" in changed.stderr


def test_mujoco_is_no_target_of_its_own(folder: Path) -> None:
    run_shell("build", "cell.yaml", "-o", "a.zip")
    run_shell("build", "cell.yaml", "--target", "mujoco", "-o", "b.zip")
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


def test_strict_makes_errors_of_losses(folder: Path) -> None:
    lost = run_shell("build", "cell.yaml", "--target", "pinocchio", "-o", "out/")
    assert lost.exit_code == 0 and "warning[target-loss]: Pinocchio ignores 1 sensor: `angle`" in lost.stderr
    refused = run_shell("build", "cell.yaml", "--target", "pinocchio", "-o", "strict/", "--strict")
    assert refused.exit_code == 1 and "error[target-loss]" in refused.stderr
    assert not (folder / "strict").exists()


@pytest.mark.parametrize("out", ["cell.xml", "cell.mjb", "cell.usdz", "-"])
def test_an_output_of_one_file_has_no_room(out: str, folder: Path) -> None:
    result = run_shell("build", "cell.yaml", "--target", "urdf", "-o", out)
    assert result.exit_code == 2 and "error[output-kind]" in result.stderr
    assert "-o build/urdf/" in result.stderr


def test_what_is_not_verified_has_no_target(folder: Path) -> None:
    result = run_shell("build", "cell.yaml", "--target", "plain", "--no-compile", "-o", "out/")
    assert result.exit_code == 2 and "remove `--no-compile`" in result.stderr


def test_an_unknown_target(folder: Path) -> None:
    result = run_shell("build", "cell.yaml", "--target", "plan", "-o", "out/")
    assert result.exit_code == 2
    words = " ".join(result.stderr.split())
    assert "the target `plan` does not exist. Did you mean `plain`? Targets: mujoco, plain, drake," in words

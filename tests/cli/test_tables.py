"""Tables from files: `--set-file` of YAML, JSON and CSV."""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path

import mjcompose
import mujoco
import pytest
from cli.shell import run

RECIPE = """
recipe: 1
angle: radian
params:
  motors: {type: table, columns: [kp, range, damping]}
add:
  - {to: world, body: {name: b, geom: {size: [0.1]}, joint: [{name: hip}, {name: knee, axis: [0, 1, 0]}]}}
actuator:
  "${m}": {for: {m: "${motors}"}, type: position, joint: "${m}", kp: "${motors[m].kp}", ctrlrange: "${motors[m].range}"}
edit:
  - {select: {joint: "*"}, set: {damping: "${motors[name].damping}"}}
"""
ROWS = {"hip": {"kp": 20, "range": [-1, 1], "damping": 0.5}, "knee": {"kp": 40, "range": ["-30deg", 0], "damping": 1}}
CSV = 'joint,kp,range,damping\nhip,20,"[-1, 1]",0.5\nknee,40,"[-30deg, 0]",1\n'
FILES = {
    "motors.csv": CSV,
    "motors=far.csv": CSV,
    "values.json": json.dumps({"motors": ROWS}),
    "tabs.json": json.dumps({"motors": ROWS}, indent="\t"),
    "motors=rows.json": json.dumps(ROWS, indent=1),
    "values.yaml": f"motors: {json.dumps(ROWS)}",
}


@pytest.fixture(autouse=True)
def recipe(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("robot.yaml").write_text(RECIPE)


def text_of(*options: str) -> str:
    result = run("build", "robot.yaml", "-o", "robot.zip", *options)
    assert result.exit_code == 0, result.stderr
    with zipfile.ZipFile("robot.zip") as bundle:
        return bundle.read("model.xml").decode()


@pytest.mark.parametrize("named", FILES)
def test_every_form_of_file_gives_the_same_model(named: str) -> None:
    Path(named.partition("=")[2] or named).write_text(FILES[named])
    assert text_of("--set-file", named) == text_of("--set", f"motors={json.dumps(ROWS)}")


def test_python_gives_a_table_too() -> None:
    model = mjcompose.model("robot.yaml", motors=ROWS)
    assert model.actuator("knee").gainprm[0] == 40 and model.joint("hip").damping[0] == 0.5
    assert model.actuator("knee").ctrlrange.tolist() == pytest.approx([-mujoco.mjPI / 6, 0])


def test_a_nested_recipe_takes_a_table_with_its_places() -> None:
    Path("two.yaml").write_text(
        "recipe: 1\nparams: {motors: {type: table}}\nattach: {a: {model: ./robot.yaml, with: {motors: '${motors}'}}}\n"
    )
    Path("motors.csv").write_text(CSV)
    assert run("build", "two.yaml", "-o", "two.zip", "--set-file", "motors.csv").exit_code == 0


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("40", "4k", "motors.csv:3:6: error[wrong-type]: `kp` of position actuator `knee` expects a number, got `4k`"),
        (
            "0.5",
            "high",
            "motors.csv:2:18: error[wrong-type]: `damping` of joint `hip` expects 1 to 3 numbers, got `high`",
        ),
        (
            "damping",
            "dampng",
            "motors.csv:1:16: error[unknown-key]: row `hip` of parameter `motors` has no column `dampng`",
        ),
        ("knee,", "knee,1,", "motors.csv:3:25: error[csv-syntax]: row `knee` has more values than there are columns"),
    ],
)
def test_a_fault_is_told_at_its_place_in_the_file(old: str, new: str, place: str) -> None:
    Path("motors.csv").write_text(CSV.replace(old, new))
    result = run("build", "robot.yaml", "-o", "robot.zip", "--set-file", "motors.csv")
    assert result.exit_code and place in result.stderr


def test_a_file_may_have_an_equals_sign_in_its_name() -> None:
    Path("motors=a.json").write_text(json.dumps({"motors": ROWS}))
    assert "knee" in text_of("--set-file", "motors=a.json")


def test_why_and_depfile_know_the_file() -> None:
    Path("far.csv").write_text(CSV)
    options = ("build", "robot.yaml", "-o", "robot.zip", "--set-file", "motors=far.csv", "--depfile", "o.d")
    assert run(*options).exit_code == 0
    assert f"{os.sep}far.csv" in Path("o.d").read_text()
    Path("far.csv").write_text(CSV.replace("20", "30"))
    assert "`motors=far.csv` changed" in run(*options, "--why").stdout

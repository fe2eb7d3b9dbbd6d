"""A data set's record of its model, and the same model from it."""

from __future__ import annotations

import json
from pathlib import Path

import mjcompose
import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main

BASE = "<mujoco><worldbody><body name='b'><geom name='g' size='.1'/></body></worldbody></mujoco>"
RECIPE = """\
recipe: 1
angle: degree
base: ./base.xml
params: {size: {default: 0.1}, turn: {default: 30, unit: deg}, label: {default: "1.5"}}
variants: {tool: {box: {}, ball: {edit: [{select: {geom: g}, set: {rgba: [1, 0, 0, 1]}}]}}}
edit: [{select: {geom: g}, set: {size: ["${size}"]}}, {select: {body: b}, set: {axisangle: [0, 0, 1, "${turn}"]}}]
"""
SAMPLES = (
    "randomize: {seed: 7, samples: 4, fields: {mass: {select: {body: b}, attr: mass, scale: {uniform: [1, 2]}}}}\n"
)
MATRIX = "matrix: {axes: {tool: [box, ball]}, name: 'm-${tool}'}\n"


def run(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(main, list(words))
    return result.exit_code, result.output


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "base.xml").write_text(BASE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("", []),
        ("", ["--set", "size=0.2", "--set", "turn=10", "--set", "tool=ball"]),
        (SAMPLES, ["--sample", "2"]),
        (MATRIX, ["--pick", "m-ball"]),
        (MATRIX, ["--pick", "m-ball", "--set", "size=0.3"]),
        (SAMPLES.replace("mass: {select: {body: b}, attr: mass,", "drawn: {param: size,"), ["--sample", "2"]),
        (MATRIX + SAMPLES, ["--pick", "m-ball-s0003"]),
        ("", ["--no-compile"]),
        ("", ["--target", "mjx"]),
        (SAMPLES, ["--as", "worlds"]),
        ("", ["--dedup"]),
    ],
)
def test_a_stamp_gives_the_same_bytes(folder: Path, more: str, words: list[str]) -> None:
    (folder / "cell.yaml").write_text(RECIPE + more)
    code, output = run("build", "cell.yaml", "-o", "{name}.zip", *words)
    assert code == 0, output
    [built] = folder.glob("*.zip")
    record = mjcompose.stamp(built)
    assert json.loads(json.dumps(record)) == record
    (folder / "stamp.json").write_text(json.dumps(record))
    code, output = run("rebuild", "stamp.json", "-o", "again.zip")
    assert code == 0, output
    assert (folder / "again.zip").read_bytes() == built.read_bytes()


def test_a_change_is_an_error_that_names_it(folder: Path) -> None:
    (folder / "cell.yaml").write_text(RECIPE)
    assert run("build", "cell.yaml", "-o", "cell/")[0] == 0
    (folder / "stamp.json").write_text(json.dumps(mjcompose.stamp("cell/")))
    (folder / "base.xml").write_text(BASE.replace("name='b'", "name='b' pos='1 0 0'"))
    code, output = run("rebuild", "stamp.json", "-o", "again.zip")
    assert code == 1 and not (folder / "again.zip").exists()
    assert "error[bundle-changed]: `cell` has other bytes than its stamp records" in output
    assert "`base.xml` changed" in output and "cell.yaml" not in output


@pytest.mark.parametrize("text", ["{}", "[", '{"stamp": 1}'])
def test_a_file_that_is_not_a_stamp_is_refused(folder: Path, text: str) -> None:
    (folder / "stamp.json").write_text(text)
    code, output = run("rebuild", "stamp.json")
    assert code == 2 and "is not a stamp of mjcompose" in output
    with pytest.raises(mjcompose.MjcomposeError, match="cannot|no"):
        mjcompose.stamp("missing.zip")


def stamped(folder: Path, **fields: object) -> dict[str, object]:
    """Write the stamp of a model, with these fields instead."""
    (folder / "cell.yaml").write_text(RECIPE)
    assert run("build", "cell.yaml", "-o", "cell/")[0] == 0
    record = {**mjcompose.stamp("cell/"), **fields}
    (folder / "stamp.json").write_text(json.dumps(record, indent=1))
    return record


@pytest.mark.parametrize(
    ("fields", "place", "fault"),
    [
        ({"name": "a\n::error::b"}, '"name": "a', "`name`: a name cannot have a line break in it"),
        ({"name": "\u202ecell"}, '"name": "', "`name`: a name cannot have the character U+202E in it"),
        ({"bundle": "0" * 63}, '"bundle": "00', "`bundle`"),
        (
            {"recipe": "../../home/cell.yaml"},
            '"recipe": "..',
            "`recipe`: it must be the name of a file, without a folder",
        ),
        ({"recipe": "/home/cell.yaml"}, '"recipe": "/', "`recipe`"),
        ({"recipe": ".."}, '"recipe": ".."', "`recipe`"),
        ({"cell": "x\r"}, '"cell": "x', "`cell`: a name cannot have a line break in it"),
        ({"sample": -1}, '"sample": -1', "`sample`"),
        ({"target": "nope"}, '"target": "nope"', "`target`: the target `nope` does not exist"),
        ({"params": {"size": {"x": 1}}}, '"size": {', "`params/size`: a parameter is a number, a text"),
        ({"params": {"size": [1, [2]]}}, '"size": [', "`params/size`: a parameter is a number, a text"),
        ({"params": {"size": float("nan")}}, '"size": NaN', "`params/size`: a parameter is a finite number"),
        ({"params": {"size": [1.0, float("-inf")]}}, '"size": [', "`params/size`: a parameter is a finite number"),
        ({"read": {"cell.yaml": "x"}}, '"cell.yaml": "x"', "`read/cell.yaml`"),
        ({"more": 1}, '"more": 1', "`more` is not a key of a stamp"),
    ],
)
def test_each_field_of_a_stamp_has_a_form(folder: Path, fields: dict[str, object], place: str, fault: str) -> None:
    stamped(folder, **fields)
    code, output = run("rebuild", "stamp.json")
    assert code == 2 and "Traceback" not in output
    file, line, _, message = output.splitlines()[0].split(":", 3)
    assert file == "stamp.json" and message.startswith(" error[bundle-manifest]: `stamp.json` is not a stamp")
    assert place in (folder / "stamp.json").read_text().splitlines()[int(line) - 1]
    assert fault in message
    assert not (folder / "build").exists()


@pytest.mark.parametrize("name", ["../../victim/backup", "/tmp/backup", "other"])
def test_a_stamp_with_another_name_writes_nothing(folder: Path, name: str) -> None:
    stamped(folder, name=name)
    before = sorted(folder.rglob("*"))
    code, output = run("rebuild", "stamp.json")
    assert code == 1 and f"error[bundle-changed]: the stamp is of `{name}`, and its recipe builds `cell`" in output
    assert sorted(folder.rglob("*")) == before


def test_a_name_like_a_path_is_a_file_in_build(folder: Path) -> None:
    (folder / "cell.yaml").write_text(f"{RECIPE}name: ../../victim/backup\n")
    assert run("build", "cell.yaml", "-o", "made.zip")[0] == 0
    (folder / "stamp.json").write_text(json.dumps(mjcompose.stamp("made.zip")))
    code, output = run("rebuild", "stamp.json")
    assert code == 0 and "wrote build/_.._victim_backup.zip" in output
    assert (folder / "build" / "_.._victim_backup.zip").read_bytes() == (folder / "made.zip").read_bytes()

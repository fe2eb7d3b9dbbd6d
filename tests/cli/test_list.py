"""`models.csv`, the index that `build --all` writes, and who reads it: `ls` and `load_many`."""

from __future__ import annotations

import csv
import json
import os
from pathlib import Path

import mjcompose
import pytest
from click.testing import CliRunner, Result
from mjcompose.cli.main import main

MODEL = '<mujoco><worldbody><body name="b"><freejoint/><geom name="g" size="0.1"/></body></worldbody></mujoco>'
RECIPE = """\
recipe: 1
name: ball
base: ./model.xml
params: {size: 1, path: 1, at: {default: [0, 0, 0]}}
edit:
  - {select: {geom: g}, set: {size: ["${size}"]}}
  - {select: {body: b}, set: {pos: "${at}"}}
matrix:
  axes: {size: [1, 2], path: [5]}
  include: [{size: 3, at: [0, 0, 1]}]
randomize:
  seed: 7
  samples: 2
  fields: {friction: {select: {geom: g}, attr: "friction[0]", per: sample, uniform: [0.5, 1]}}
check: {light: {expect: {attr: mass, range: [0, 500000]}}}
"""


def run(*words: str) -> Result:
    return CliRunner().invoke(main, words, prog_name="mjcompose")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("many")
    (found / "model.xml").write_text(MODEL)
    (found / "r.yaml").write_text(RECIPE)
    before = Path.cwd()
    os.chdir(found)
    try:
        result = run("build", "r.yaml", "--all", "-o", "out/{name}/")
        for number in (1, 2):
            run("build", "r.yaml", "--all", "--shard", f"{number}/2", "-o", "parts/{name}.zip")
    finally:
        os.chdir(before)
    assert result.exit_code == 0 and "wrote out/models.csv: the index of 9 models" in result.stdout, result.output
    return found


def listed(*words: str) -> list[str]:
    result = run("list", *words)
    assert result.exit_code == 0, result.output
    return result.stdout.splitlines()


@pytest.mark.parametrize(
    ("where", "count"),
    [
        ("size > 1", 6),
        ("size == 2 and sample == 1", 1),
        ("friction > 0", 6),  # sample 0 has no draws
        ("ngeom == 1 and checks == 1", 9),
        ("model == 'ball-2-5-s0001'", 1),
        ("size > 7", 0),
        ("true", 9),
    ],
)
def test_where(folder: Path, where: str, count: int) -> None:
    assert len(listed(str(folder / "out"), "--where", where)) == count
    assert len(listed(str(folder / "parts"), "--where", where)) == count


def test_a_line_says_what_sets_a_model_apart(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    lines = listed("out", "--where", "size == 3 and sample == 0")
    (name,) = [each.name for each in (folder / "out").glob("ball-3*-s0000")]
    assert lines == [f"out/{name} size=3 at[0]=0 at[1]=0 at[2]=1"]
    (data,) = map(json.loads, listed("out", "--where", "size == 1 and sample == 0", "--output-format", "json"))
    assert (data["value path"], data["path"], data["nv"]) == (5, "out/ball-1-5-s0000", 6)


def test_what_has_no_such_value_is_counted(folder: Path) -> None:
    result = run("list", str(folder / "out"), "--where", "friction > 0")
    assert result.stderr == "3 models have no `friction`, and are not listed\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("out", "--where", "sice > 1"), "did you mean `size`?"),
        (("out", "--where", "size >"), "character 6: the expression ends"),
        (("out", "--where", "size"), "`size` is a number, and not true or false"),
        (("out", "--where", "model > 1"), "error[expression]"),
        (("nowhere",), "error[file-not-found]: `nowhere` does not exist"),
        ((".",), "error[file-not-found]: `.` has no index of models"),
        (("model.xml",), "has no column `path`"),
    ],
)
def test_what_is_wrong(folder: Path, words: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    result = run("list", *words)
    assert result.exit_code in (1, 2) and said in result.stderr and "Traceback" not in result.output


def test_an_index_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "models.csv").write_bytes(b"path,model\n\xff\xfe,a\n")
    result = run("list", str(tmp_path))
    assert result.exit_code == 1 and "error[file-unreadable]" in result.stderr


@pytest.mark.parametrize("path", ["", "/etc/a.zip", "../a.zip"])
def test_an_index_names_what_is_below_it(tmp_path: Path, path: str) -> None:
    (tmp_path / "models.csv").write_text(f"model,path\na,{path}\n")
    result = run("list", str(tmp_path))
    assert result.exit_code == 1 and "error[source-outside]: row 1 of" in result.stderr


def test_load_many(folder: Path) -> None:
    found = list(mjcompose.load_many(folder / "parts", where="size > 2 and sample > 0"))
    assert [each.values["sample"] for each in found] == [2, 1]  # one of each part
    model, manifest, index = found[0].load()
    assert (model.geom_size[0, 0], manifest.name, found[0].name) == (3, found[0].name, found[0].name)
    assert index.qpos is not None


def test_models_are_loaded_one_by_one(folder: Path, tmp_path: Path) -> None:
    """A model that is gone is an error when it is asked for, and no matter to others."""
    index = (folder / "out" / "models.csv").read_text().splitlines()
    (tmp_path / "models.csv").write_text("\n".join(index[:3]) + "\n")
    (tmp_path / "ball-1-5-s0000").symlink_to(folder / "out" / "ball-1-5-s0000")
    first, second = mjcompose.load_many(tmp_path)
    assert first.load().model.nbody == 2
    with pytest.raises(mjcompose.LoadError):
        second.load()


@pytest.mark.parametrize("words", [("nowhere", None), (".", None), ("out", "size >"), ("out", "sice > 1")])
def test_load_many_raises(folder: Path, words: tuple[str, str | None], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    with pytest.raises(mjcompose.LoadError):
        list(mjcompose.load_many(words[0], where=words[1]))


TEXTS = ("=cmd()|' /C calc'!A0", "-0.5", "'quoted", "@sum(1)", "+1 way", "\t=1", "＝1", "plain")


def test_no_text_of_a_table_is_a_formula_and_none_is_lost(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("model.xml").write_text(MODEL)
    Path("study.yaml").write_text(
        "recipe: 1\nbase: ./model.xml\nparams: {note: plain, n: 1}\nmatrix:\n  name: ${n}\n  axes: {n: [0]}\n"
        f"  include: [{', '.join(json.dumps({'n': n, 'note': text}) for n, text in enumerate(TEXTS, 1))}]\n"
    )
    assert run("build", "study.yaml", "--all", "--jobs", "1", "-o", "out/{name}.zip").exit_code == 0
    with open("out/models.csv", newline="", encoding="utf-8") as file:
        written = [row["note"] for row in csv.DictReader(file)]
    assert all(not each.startswith(tuple("=+@\t＝")) for each in written)
    assert written[2] == "-0.5" and written[1] == "'" + TEXTS[0]
    listed = [json.loads(line) for line in run("list", "out", "--output-format", "json").stdout.splitlines()]
    assert [str(row["note"]) for row in listed[1:]] == list(TEXTS)


@pytest.mark.parametrize(
    ("names", "out"),
    [("[A, a]", "out/{name}.zip"), ("[a b, a_b]", "out/{name}/"), ("[straße, STRASSE]", "out/{name}.xml")],
)
def test_no_two_models_are_written_to_one_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, names: str, out: str
) -> None:
    """Also where a file system does not tell them apart."""
    monkeypatch.chdir(tmp_path)
    Path("model.xml").write_text(MODEL)
    Path("study.yaml").write_text(
        f"recipe: 1\nbase: ./model.xml\nparams: {{n: x}}\nmatrix: {{name: '${{n}}', axes: {{n: {names}}}}}\n"
    )
    result = run("build", "study.yaml", "--all", "-o", out)
    assert result.exit_code == 1 and "study.yaml:4:" in result.output and "error[name-clash]" in result.output
    assert not Path("out").exists()

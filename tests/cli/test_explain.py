from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import run, snapshot
from mjcompose.base import codes


def test_in_words(folder: Path) -> None:
    before = snapshot(folder)
    result = run("explain", "cell.yaml", "geom tool/palm")
    assert result.exit_code == 0 and result.stderr == ""
    assert "read from models/tool.xml:4" in result.stdout
    assert "palm → tool/palm" in result.stdout
    assert snapshot(folder) == before


def test_one_attribute_either_way(folder: Path) -> None:
    quoted = run("explain", "cell.yaml", "joint shoulder range")
    assert quoted.exit_code == 0 and "-90 90" in quoted.stdout
    assert run("explain", "cell.yaml", "joint shoulder", "range").stdout == quoted.stdout


def test_as_json(folder: Path) -> None:
    result = run("explain", "cell.yaml", "geom tool/palm", "--output-format", "json")
    told = json.loads(result.stdout)
    assert (told["explains"], told["label"]) == ("element", "geom tool/palm")
    assert told["written"][0]["span"] == {
        "file": "models/tool.xml",
        "line": 4,
        "column": 7,
        "end_line": 4,
        "end_column": 12,
    }
    assert [each["attribute"] for each in told["changes"]] == ["name"]
    told = json.loads(run("explain", "cell.yaml", "geom tool/palm size", "--output-format", "json").stdout)
    assert (told["explains"], told["value"]) == ("attribute", "0.03 0.03 0.01")
    told = json.loads(run("explain", "cell.yaml", "geom", "--output-format", "json").stdout)
    assert [each["label"] for each in told["found"]] == ["geom#0", "geom rod", "geom tool/palm"]


def test_faults(folder: Path) -> None:
    result = run("explain", "cell.yaml", "geom tol/palm")
    assert result.exit_code == 1 and result.stdout == ""
    assert "did you mean `geom tool/palm`?" in result.stderr
    assert run("explain", "cell.yaml", "").exit_code == 2
    assert run("explain", "cell.yaml").exit_code == 2
    result = run("explain", "wrong.yaml", "geom tool/palm")
    assert result.exit_code == 1 and "error[attach-place]" in result.stderr


def test_a_missing_file_hinders_no_answer(folder: Path) -> None:
    (folder / "models" / "meshes" / "cover.obj").unlink()
    result = run("explain", "cell.yaml", "joint shoulder")
    assert result.exit_code == 1
    assert "read from models/arm.xml:10" in result.stdout and "error[asset-missing]" in result.stderr


def test_a_bundle_names_its_recipe(folder: Path) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "out/").exit_code == 0
    assert run("build", "cell.yaml", "--no-compile", "-o", "cell.zip").exit_code == 0
    for bundle in ("out", "cell.zip"):
        result = run("explain", bundle, "joint shoulder")
        assert result.exit_code == 1
        assert "use its recipe: `mjcompose explain cell.yaml`" in result.stderr
    assert "read from out/model.xml" in run("explain", "out/model.xml", "joint shoulder").stdout
    (folder / "empty").mkdir()
    assert "use its recipe" in run("explain", "empty", "joint shoulder").stderr


def test_of_a_build_with_values(folder: Path) -> None:
    (folder / "study.yaml").write_text(
        "recipe: 1\nparams: {x: {type: float}}\nvariants: {speed: {slow: {}, fast: {option: {timestep: 0.01}}}}\n"
        "add: [{to: world, site: {name: s, pos: ['${x}', 0, 0]}}]\n"
    )
    assert run("explain", "study.yaml", "site s pos").exit_code == 1
    assert "3 0 0" in run("explain", "study.yaml", "site s pos", "--set", "x=3").stdout
    told = run("explain", "study.yaml", "option timestep", "--set", "x=3", "--set", "speed=fast")
    assert told.exit_code == 0 and "study.yaml:3" in told.stdout
    result = run("explain", "models/arm.xml", "joint", "--set", "x=3")
    assert result.exit_code == 1 and "`models/arm.xml` is not a recipe and has no parameters" in result.stderr


def test_of_a_cell_and_a_sample(folder: Path) -> None:
    (folder / "study.yaml").write_text(
        "recipe: 1\nname: a\nparams: {x: 1}\nmatrix: {axes: {x: [1, 3]}}\n"
        "add: [{to: world, site: {name: s, pos: ['${x}', 0, 0], size: [1]}}]\n"
        "randomize: {seed: 1, samples: 2, fields: {f: {select: {site: s}, attr: 'size[0]', uniform: [5, 6]}}}\n"
    )
    assert "3 0 0" in run("explain", "study.yaml", "site s pos", "--pick", "x=3").stdout
    first, sample = (
        run("explain", "study.yaml", "site s size", *more)
        for more in (("--pick", "a-3"), ("--pick", "a-3", "--sample", "2"))
    )
    assert (first.exit_code, sample.exit_code) == (0, 0) and first.stdout != sample.stdout
    named = run("explain", "study.yaml", "site s size", "--pick", "a-3-s0002")
    assert named.stdout == sample.stdout
    gone = run("explain", "study.yaml", "site s size", "--pick", "a-3", "--sample", "3")
    assert gone.exit_code == 2 and "sample 3 does not exist: the recipe has the samples 0 to 2" in gone.stderr


def test_a_code(folder: Path) -> None:
    told = run("explain", "bare-angle").stdout
    assert told.startswith("bare-angle\n\nAn angle in your recipe has no unit") and "How to fix it" in told
    assert run("explain", "error[bare-angle]").stdout == told
    data = json.loads(run("explain", "bare-angle", "--output-format", "json").stdout)
    assert (data["explains"], data["code"]) == ("code", "bare-angle")
    assert data["page"].startswith("# bare-angle\n")
    assert data["url"] is None and "https://" not in told
    listed = run("explain", "--codes").stdout
    assert (
        "\nbare-angle " in listed
        and json.loads(run("explain", "--codes", "--output-format", "json").stdout)["bare-angle"]
    )


def test_a_code_with_its_address_once_the_package_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(codes, "_urls", lambda: ("Source, https://a.org", "Documentation, https://b.org/latest"))
    url = "https://b.org/latest/errors/bare-angle.html"
    assert run("explain", "bare-angle").stdout.endswith(f"\n\n{url}\n")
    assert json.loads(run("explain", "bare-angle", "--output-format", "json").stdout)["url"] == url


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("bare-angel",), "`bare-angel` is neither a code nor a file that exists. Did you mean `bare-angle`?"),
        (("qqqqqq",), "`mjcompose explain --codes` lists them."),
        (("cell.yaml",), "Missing argument 'QUERY'."),
        (("gone.yaml",), "Missing argument 'QUERY'."),
        (("bare-angle", "geom x"), "`bare-angle` is a code, not a model. Write `mjcompose explain bare-angle` alone."),
        ((), "Missing argument 'MODEL|CODE'."),
    ],
)
def test_what_is_neither_a_code_nor_a_question(folder: Path, arguments: tuple[str, ...], said: str) -> None:
    result = run("explain", *arguments)
    assert result.exit_code == 2 and result.stdout == "" and said in " ".join(result.stderr.split())

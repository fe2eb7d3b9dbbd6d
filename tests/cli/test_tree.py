from __future__ import annotations

import json
import re
import shlex
from pathlib import Path

import pytest
from cli.shell import run, snapshot


def test_a_recipe(folder: Path) -> None:
    before = snapshot(folder)
    result = run("tree", "cell.yaml")
    assert result.exit_code == 0 and result.stderr == ""
    assert result.stdout.splitlines() == [
        "cell: 3 bodies, 1 joint, 2 parts",
        "  base  models/arm.xml",
        "  tool  models/tool.xml, on link",
        "world",
        "└ base",
        "  └ link   shoulder hinge ±90°",
        "    └ tool/palm [tool]",
    ]
    assert snapshot(folder) == before


def test_places_and_json(folder: Path) -> None:
    assert "site: flange" in run("tree", "cell.yaml", "--places").stdout
    told = json.loads(run("tree", "cell.yaml", "--output-format", "json").stdout)
    link = next(each for each in told["bodies"] if each["name"] == "link")
    assert link["parent"] == "base" and link["places"][1]["site"] == "flange"
    assert link["places"][1]["world_pos"] == [0, 0, 1.3] and link["places"][1]["pos"] == [0, 0, 0.3]
    assert run("tree", "cell.yaml", "--depth", "1").stdout.endswith("  └ … 2 bodies, 1 joint below\n")


def test_a_model_and_a_bundle(folder: Path) -> None:
    assert "└ palm" in run("tree", "models/tool.xml").stdout
    assert run("build", "cell.yaml", "--no-compile", "-o", "cell.zip").exit_code == 0
    assert run("tree", "cell.zip").stdout.splitlines()[3:] == run("tree", "cell.yaml").stdout.splitlines()[3:]


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("gone.yaml",), 2, "error[source-not-found]"),
        (("wrong.yaml",), 1, "error[attach-place]"),
        (("models",), 1, "error[file-unreadable]"),
        (("models/arm.xml", "--set", "x=1"), 1, "is not a recipe and has no parameter `x`"),
        (("models/arm.xml", "--pick", "x"), 2, "is not a recipe and has no cells"),
        (("cell.yaml", "--depth", "0"), 2, "--depth"),
        (("cell.yaml", "--set", "x"), 2, "is not NAME=VALUE"),
    ],
)
def test_bad_input(folder: Path, arguments: tuple[str, ...], code: int, said: str) -> None:
    result = run("tree", *arguments)
    assert (result.exit_code, result.stdout) == (code, "") and said in result.stderr


def test_a_broken_manifest_is_told(folder: Path) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "out/").exit_code == 0
    (folder / "out" / "manifest.json").write_text("{}")
    result = run("tree", "out")
    assert result.exit_code == 0 and "warning[bundle-manifest]" in result.stderr and "tool/palm" in result.stdout


def test_the_guide_shows_what_is_printed(monkeypatch: pytest.MonkeyPatch) -> None:
    root = Path(__file__).resolve().parents[2]
    monkeypatch.chdir(root)
    blocks = re.findall(
        r"^\$ mjcompose (tree .*)\n((?:.*\n)*?)```",
        (root / "docs" / "how-to" / "explain.md").read_text("utf-8"),
        re.MULTILINE,
    )
    assert len(blocks) == 2
    for command, shown in blocks:
        assert run(*shlex.split(command)).stdout == shown

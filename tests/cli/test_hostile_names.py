"""Names in a stranger's model, and names of its files, are only text in the output of every command."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest
from cli.shell import run

pytestmark = pytest.mark.skipif(os.name != "posix", reason="names of files")

NAME = (
    "x&#10;::error file=a.py::planted&#10;  ::add-mask::secret&#9;##[error]b&#x9b;31m&#x202e;&#x200b;&lt;script>`|`@me"
)
MODEL = f"""<mujoco model="{NAME}">
  <worldbody>
    <body name="{NAME}"><joint name="{NAME}" range="90 -90"/><geom name="{NAME}" size=".1" mass="1"/><site name="{NAME}"/></body>
  </worldbody>
  <actuator><motor name="{NAME}" joint="{NAME}"/></actuator>
  <keyframe><key name="{NAME}" qpos="0"/></keyframe>
</mujoco>
"""
COMMANDS = re.compile(r"(?m)^\s*::(?!error |warning |notice )|##\w*\[|^\s*::\w+ [^:]*::planted")
ACTS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\u200b]")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.xml").write_text(MODEL)
    (tmp_path / "robot.yaml").write_text("recipe: 1\nattach: {part: {model: ./arm.xml}}\n")
    (tmp_path / "two.yaml").write_text("recipe: 1\nbase: ./arm.xml\nadd: [{to: wrong, site: {name: a}}]\n")
    (tmp_path / "::error file=b.py::planted\n::add-mask::x.yaml").write_text("recipe: 1\nbase: ./arm.xml\nbas: 1\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    "words",
    [
        "plan robot.yaml",
        "tree robot.yaml",
        "tree arm.xml --places",
        "build robot.yaml",
        "build robot.yaml --why",
        "check two.yaml",
        "check two.yaml --output-format github",
        "check two.yaml --output-format markdown",
        "check two.yaml --output-format junit",
        "check two.yaml --output-format sarif",
        "check two.yaml --output-format json",
        "lint .",
        "lint . --output-format github",
        "lint . --output-format markdown",
        "lint . --statistics",
        "lint . --profile menagerie",
        "diff arm.xml robot.yaml",
        "diff arm.xml robot.yaml --output-format markdown",
        "explain robot.yaml part/**",
        "explain arm.xml joint#0",
        "names arm.xml --json",
        "names arm.xml --python",
        "tree robot.yaml --output-format json",
        "plan robot.yaml --output-format json",
        "fmt --check .",
        "check *.yaml",
        "migrate arm.xml --from 3.2 --to 4.0",
    ],
)
def test_no_name_is_a_command(folder: Path, words: str) -> None:
    arguments = [
        each for word in words.split() for each in (sorted(map(str, Path().glob(word))) if "*." in word else [word])
    ]
    result = run(*arguments)
    for shown in (result.stdout, result.stderr):
        assert not COMMANDS.search(shown), shown
        assert not ACTS.search(shown), shown


@pytest.mark.parametrize(
    "words",
    [
        ["build", "a\n::error::b.yaml"],
        ["build", "robot.yaml", "--pick", "a\n::error::b"],
        ["buil\n::error::d"],
        ["build", "robot.yaml", "--target", "a\n::error::b"],
        ["build", "robot.yaml", "--n\n::error::o"],
        ["list", "a\n::error::b"],
        ["build", "robot.yaml", "-o", "a\n::error::b.xyz"],
        ["lint", "--select", "a\n::error::b", "."],
        ["explain", "a\n::error::b"],
        ["rebuild", "a\n::error::b"],
        ["verify", "a\n::error::b"],
        ["diff", "a\n::error::b", "arm.xml"],
        ["import", "a\n::error::b"],
    ],
)
def test_no_argument_is_a_command(folder: Path, words: list[str]) -> None:
    result = run(*words)
    assert result.exit_code in (1, 2)
    assert not COMMANDS.search(result.stdout + result.stderr), result.stderr


@pytest.mark.parametrize(
    "words",
    [
        "view --html out.html {}",
        "diff --html out.html {} own.xml",
        "plan {}",
        "tree {}",
        "check {} --output-format sarif",
        "lint .",
        "build {} -o out.zip --sbom out.json --depfile out.d",
        "check {} --junit out.xml",
        "lock {}",
        "names {} --python",
        "explain {} geom#0",
        "diff {} own.xml --output-format markdown",
        "import own\udce9.xml",
        "view --html out.html own\udce9.xml",
    ],
)
def test_a_file_name_that_is_not_utf8(folder: Path, words: str) -> None:
    for file in Path().iterdir():
        file.unlink()
    for name in ("own.xml", "own\udce9.xml"):
        (folder / name).write_text("<mujoco/>")
    (folder / "n\udce9.yaml").write_text("recipe: 1\nbase: ./own.xml\nadd: [{to: world, geom: {size: [1]}}]\n")
    result = run(*(word.format("n\udce9.yaml") for word in words.split()))
    assert result.exit_code in (0, 1) and "please report it" not in result.stderr
    for written in folder.glob("out.*"):
        assert written.suffix in (".zip", ".d") or written.read_text(encoding="utf-8")


def test_data_for_programs_has_the_name_itself(folder: Path) -> None:
    [part] = [
        each
        for each in json.loads(run("tree", "robot.yaml", "--output-format", "json").stdout)["bodies"]
        if each["name"] != "world"
    ][:1]
    assert part["name"].startswith("part/x\n::error file=a.py::planted")


@pytest.mark.parametrize(
    "words", ["tree arm.xml", "tree robot.yaml", "tree arm.xml --places", "plan edited.yaml", "build robot.yaml"]
)
def test_a_name_starts_no_line(folder: Path, words: str) -> None:
    """The output has as many lines as for a model whose names are plain."""
    (folder / "edited.yaml").write_text("recipe: 1\nbase: ./arm.xml\nedit: [{select: {geom: '*'}, set: {mass: 2}}]\n")
    hostile = run(*words.split()).stdout
    (folder / "arm.xml").write_text(MODEL.replace(NAME, "plain"))
    assert len(hostile.splitlines()) == len(run(*words.split()).stdout.splitlines())
    assert "␊::error" in hostile or words.startswith(("plan", "build"))


def test_the_names_of_bodies_that_touch_start_no_line(folder: Path) -> None:
    lines = []
    for name in ("a", NAME):
        bodies = "".join(
            f'<body name="{name}{number}" pos="{number * 0.1} 0 0"><joint axis="0 0 1"/><geom size=".1"/></body>'
            for number in range(2)
        )
        (folder / "touching.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
        (folder / "touching.yaml").write_text("recipe: 1\nbase: ./touching.xml\ncontact: {exclude: auto}\n")
        shown = run("plan", "touching.yaml").stdout
        assert "will not collide" in shown
        lines.append(len(shown.splitlines()))
    assert lines[0] == lines[1]

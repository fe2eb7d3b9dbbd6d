"""Completion of what only the recipe knows, as the shells ask for it."""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from cli.shell import environment, run
from click.shell_completion import ShellComplete
from mjcompose.cli import main as main_module

STUDY = """
recipe: 1
name: study
base: ./models/arm.xml
params: {mass: 1, reach: 2}
variants: {speed: {slow: {}, fast: {}}}
matrix: {axes: {mass: [1, 2], speed: [slow, fast]}}
"""
PROGRAM = "from mjcompose.cli.main import main; main(prog_name='mjcompose')"


@pytest.fixture
def study(folder: Path) -> Path:
    (folder / "study.yaml").write_text(STUDY)
    return folder


def offered(*words: str) -> list[str]:
    """What is offered for the last word."""
    shell = ShellComplete(main_module.main, {}, "mjcompose", "_MJCOMPOSE_COMPLETE")
    return [item.value for item in shell.get_completions(list(words[:-1]), words[-1])]


def test_what_the_recipe_has(study: Path) -> None:
    cells = ["study-1-slow", "study-1-fast", "study-2-slow", "study-2-fast"]
    for verb in ("build", "check", "plan", "render", "view"):
        assert offered(verb, "study.yaml", "--pick", "s") == [*cells, "speed=slow", "speed=fast"]
    assert offered("build", "study.yaml", "--pick", "ma") == ["mass=1", "mass=2"]
    assert offered("build", "study.yaml", "--pick", "mass=2,s") == ["mass=2,speed=slow", "mass=2,speed=fast"]
    assert offered("build", "study.yaml", "--pick", "study-2") == cells[2:]
    assert offered("explain", "study.yaml", "world", "--pick", "study-2-f") == cells[3:]
    assert offered("diff", "study.yaml", "cell.yaml", "--pick", "study-2-f") == cells[3:]
    assert offered("build", "study.yaml", "--set", "") == ["mass=", "reach=", "speed=slow", "speed=fast"]
    assert offered("build", "study.yaml", "--set", "speed=f") == ["speed=fast"]
    assert offered("explain", "study.yaml", "sh") == ["shoulder"]
    assert offered("build", "study.yaml", "--qui") == ["--quiet"]


def test_values_that_a_parameter_may_have(folder: Path) -> None:
    params = "{tool: {default: hand, choices: [hand, hook]}, lit: true, reach: 2}"
    (folder / "tools.yaml").write_text(f"recipe: 1\nparams: {params}\n")
    assert offered("build", "tools.yaml", "--set", "") == ["tool=hand", "tool=hook", "lit=true", "lit=false", "reach="]


def test_what_the_model_has(folder: Path) -> None:
    (folder / "seen.yaml").write_text(
        "recipe: 1\nbase: ./models/arm.xml\n"
        "add: [{to: world, camera: {name: above}}]\n"
        "keyframe: {rest: {}}\n"
        "randomize: {seed: 1, samples: 2, fields: {m: {select: {geom: '**'}, attr: mass, uniform: [1, 2]}}}\n"
    )
    assert offered("render", "seen.yaml", "--key", "") == ["rest"]
    assert offered("view", "seen.yaml", "--key", "r") == ["rest"]
    assert offered("render", "seen.yaml", "--camera", "") == ["above"]
    assert offered("build", "seen.yaml", "--sample", "") == ["0", "1", "2"]
    assert offered("explain", "seen.yaml", "shoulder", "ran") == ["range"]
    assert offered("explain", "seen.yaml", "joint shoulder", "ran") == ["range"]
    assert offered("explain", "seen.yaml", "geom shoulder", "ran") == []


def test_commands_and_limits() -> None:
    assert offered("help", "bu") == ["build"]
    assert offered("build", "--limit", "exp") == ["expansion="]


@pytest.mark.parametrize("recipe", ["gone.yaml", "models", "wrong.yaml", "models/arm.xml"])
def test_nothing_is_offered_and_nothing_said_where_it_cannot_be_read(
    study: Path, recipe: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert offered("build", recipe, "--pick", "") == []
    assert offered("build", "--pick", "") == []
    assert capsys.readouterr() == ("", "")


def test_the_line_for_the_start_file() -> None:
    for shell in ("bash", "zsh", "fish"):
        assert f"_MJCOMPOSE_COMPLETE={shell}_source" in run("completion", shell).stdout
    assert run("completion", "csh").exit_code == 2


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("mjcompose build study.yaml --set speed=f", ["fast"]),
        ("mjcompose build study.yaml --set spe", ["speed=slow", "speed=fast"]),
        ("mjcompose build study.yaml --set m", ["mass="]),
        ("mjcompose pla", ["plan"]),
    ],
)
def test_bash_takes_an_equals_sign_for_the_end_of_a_word(study: Path, line: str, told: list[str]) -> None:
    """As bash calls the function: with the line, and with what replaces what stands after the last `=` in it."""
    source = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=environment(_MJCOMPOSE_COMPLETE="bash_source"),
        check=True,
        capture_output=True,
        text=True,
        cwd=study,
    ).stdout
    (function,) = {line.split("()")[0] for line in source.splitlines() if line.endswith("completion() {")}
    (study / "mjcompose").write_text(f"#!/bin/sh\nexec {shlex.quote(sys.executable)} -c {shlex.quote(PROGRAM)}\n")
    (study / "mjcompose").chmod(0o755)
    program = (
        f"complete() {{ :; }}; compopt() {{ :; }}\n{source}\n"
        f"COMP_LINE={shlex.quote(line)}; COMP_POINT=${{#COMP_LINE}}; COMP_WORDS=($COMP_LINE); COMP_CWORD=3\n"
        f"{function} ./mjcompose\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
    )
    done = subprocess.run(["bash", "-c", program], env=environment(), capture_output=True, text=True, cwd=study)
    assert (done.stdout.split(), done.stderr) == (told, "")

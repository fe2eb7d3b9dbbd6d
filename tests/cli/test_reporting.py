from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from cli.shell import environment, run

ESCAPE = "\x1b["


def test_text(folder: Path) -> None:
    result = run("check", "wrong.yaml")
    assert result.stderr == (
        "wrong.yaml:5:42: error[attach-place]: the site `flang` to attach `tool/` to does not exist\n"
        "  |\n"
        "5 |   tool: {model: ./models/tool.xml, site: flang}\n"
        "  |                                          ^^^^^\n"
        "  = note: sites that exist: flange\n"
        "  = help: did you mean `site: flange`?\n"
        "\n"
        "1 error\n"
    )
    assert result.stdout == ""


@pytest.mark.parametrize("verb", ["build", "check"])
def test_json(folder: Path, verb: str) -> None:
    result = run(verb, "wrong.yaml", "--output-format", "json")
    assert result.exit_code == 1 and result.stderr == ""
    (told,) = map(json.loads, result.stdout.splitlines())
    assert (told["severity"], told["code"]) == ("error", "attach-place")
    assert told["span"] == {"file": "wrong.yaml", "line": 5, "column": 42, "end_line": 5, "end_column": 47}


def test_github(folder: Path) -> None:
    result = run("check", "wrong.yaml", "--output-format", "github")
    assert result.exit_code == 1 and result.stderr == ""
    (line,) = result.stdout.splitlines()
    assert line.startswith("::error file=wrong.yaml,line=5,col=42,endLine=5,endColumn=47,title=attach-place::the site")


def test_paths_are_those_of_the_users_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder.parent)
    assert run("check", "cell/wrong.yaml").stderr.startswith("cell/wrong.yaml:5:42: error")
    monkeypatch.chdir(folder / "models")
    told = run("check", "../wrong.yaml").stderr
    assert told.startswith(f"{folder / 'wrong.yaml'}:5:42: error") and "site: flang}" in told


def test_nothing_but_text_where_there_is_no_terminal(folder: Path) -> None:
    for recipe in ("cell.yaml", "wrong.yaml"):
        result = run("check", recipe, "--no-compile")
        assert ESCAPE not in result.stderr + result.stdout
        assert "checking" not in result.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal")
@pytest.mark.parametrize(
    ("settings", "colors"),
    [({}, True), ({"NO_COLOR": "1"}, False), ({"NO_COLOR": ""}, True), ({"TERM": "dumb"}, False)],
)
def test_colors_and_progress_on_a_terminal(folder: Path, settings: dict[str, str], colors: bool) -> None:
    import pty

    ours, theirs = pty.openpty()
    try:
        subprocess.run(
            [sys.executable, "-m", "mjcompose", "check", "wrong.yaml"],
            env=environment(**{"TERM": "xterm", **settings}),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=theirs,
            timeout=60,
            check=False,
        )
        os.close(theirs)
        told = _read(ours)
    finally:
        os.close(ours)
    # The line of progress is removed again, where the terminal can.
    cleared = "\r\n" if settings.get("TERM") == "dumb" else "\r\x1b[K"
    assert told.startswith(f"checking wrong.yaml{cleared}")
    assert (f"{ESCAPE}1;31m" in told) == colors
    assert "error" in told and "^^^^^" in told


def _read(terminal: int) -> str:
    told = b""
    while True:
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # how Linux says that the other side is closed
            break
        if not piece:
            break
        told += piece
    return told.decode()

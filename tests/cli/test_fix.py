from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from cli.shell import run, snapshot

WRONG = """\
recipe: 1  # the version
base: ./models/arm.xml
attach:
  # the tool
  tool: {model: ./models/tool.xml, site: flang}
"""


@pytest.fixture
def broken(folder: Path) -> Path:
    (folder / "broken.yaml").write_text(WRONG)
    return folder / "broken.yaml"


def test_it_shows_and_writes_only_when_told(broken: Path, folder: Path) -> None:
    before = snapshot(folder)
    for arguments in ((), ("--diff",)):
        result = run("fix", "broken.yaml", *arguments)
        assert result.exit_code == 1 and snapshot(folder) == before
        assert (
            "-  tool: {model: ./models/tool.xml, site: flang}\n+  tool: {model: ./models/tool.xml, site: flange}\n"
            in result.stdout
        )
        assert result.stdout.endswith("can fix 1 fault in 1 file; --write does it\n") and result.stderr == ""


@pytest.mark.parametrize("option", ["--write", "--yes", "-y"])
def test_it_writes(broken: Path, option: str) -> None:
    result = run("fix", "broken.yaml", option)
    assert result.exit_code == 0 and result.stdout.endswith("fixed 1 fault in 1 file\n")
    assert broken.read_text() == WRONG.replace("flang}", "flange}")
    again = run("fix", "broken.yaml", option)
    assert (again.exit_code, again.stdout, again.stderr) == (0, "nothing to fix\n", "")


@pytest.mark.parametrize(("answer", "code"), [("y\n", 0), ("n\n", 1)])
def test_on_a_terminal_it_asks(broken: Path, monkeypatch: pytest.MonkeyPatch, answer: str, code: int) -> None:
    monkeypatch.setattr("mjcompose.cli.fmt.is_asked", lambda: True)
    result = run("fix", "broken.yaml", input=answer)
    assert result.exit_code == code and "write 1 fault in 1 file?" in result.stderr
    assert ("flange}" in broken.read_text()) is (code == 0)


def test_what_is_left_is_told_for_the_file_as_it_would_be(broken: Path) -> None:
    broken.write_text(WRONG.replace("recipe: 1  # the version\n", "") + "nonsense: 1\n")
    result = run("fix", "broken.yaml")
    assert result.exit_code == 1 and "error[unknown-key]" in result.stderr
    assert "broken.yaml:6:1" in result.stderr and "6 | nonsense: 1" in result.stderr
    assert run("fix", "broken.yaml", "--write").exit_code == 1
    assert broken.read_text().startswith("recipe: 1\nbase:")


def test_as_json(broken: Path) -> None:
    change, summary = map(json.loads, run("fix", "broken.yaml", "--output-format", "json").stdout.splitlines())
    assert (change["file"], change["written"]) == ("broken.yaml", False) and "+  tool:" in change["diff"]
    assert summary == {
        "fixed": [{"code": "attach-place", "message": "the site `flang` to attach `tool/` to does not exist"}],
        "left": 0,
    }


def test_check_hands_the_fix_to_programs(broken: Path) -> None:
    told = json.loads(run("check", "broken.yaml", "--output-format", "json", "--no-compile").stdout.splitlines()[0])
    assert told["fix"] == {
        "replacement": "flange",
        "span": {"file": "broken.yaml", "line": 5, "column": 42, "end_line": 5, "end_column": 47},
    }
    assert json.loads(run("check", "rejected.yaml", "--output-format", "json").stdout.splitlines()[0])["fix"] is None


def test_bad_input(folder: Path) -> None:
    result = run("fix", "gone.yaml")
    assert result.exit_code == 2 and "error[file-not-found]" in result.stderr
    assert run("fix", "cell.yaml", "--set", "x").exit_code == 2
    assert run("fix").exit_code == 2
    assert run("fix", "cell.yaml").exit_code == 0


def test_what_cannot_be_written_is_told(broken: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.bundle.bundle import OutputError

    def refused(*_: object, **__: object) -> None:
        raise OutputError("output-unwritable", "no")

    monkeypatch.setattr("mjcompose.bundle.staging.staged_file", refused)
    result = run("fix", "broken.yaml", "--write")
    assert result.exit_code == 1 and "error[output-unwritable]" in result.stderr and broken.read_text() == WRONG


def test_the_guide_shows_what_is_printed(folder: Path) -> None:
    root = Path(__file__).resolve().parents[2]
    text = (root / "docs" / "how-to" / "lint.md").read_text("utf-8")
    shown = text.partition("$ mjcompose fix arm.yaml\n")[2].partition("```")[0]
    before = [line[1:] for line in shown.splitlines()[3:-1] if line[0] in " -"]
    shutil.copytree(root / "recipes" / "models", folder / "models", dirs_exist_ok=True)
    (folder / "arm.yaml").write_text("\n".join(before) + "\n")
    assert run("fix", "arm.yaml").stdout == shown

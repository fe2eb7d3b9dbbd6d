from __future__ import annotations

import os
import shlex
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from cli.shell import environment, process, run
from mjcompose.base.sink import Sink
from mjcompose.cli.fmt import rewrite
from mjcompose.sources.context import Context

UNTIDY = "name: cell   # short\nrecipe: 1\nattach: {tool: {site: flange, model: ./models/tool.xml}}\n"
TIDY = "recipe: 1\nname: cell   # short\nattach: {tool: {model: ./models/tool.xml, site: flange}}\n"


def test_a_file_is_written_in_its_place(folder: Path) -> None:
    path = folder / "untidy.yaml"
    path.write_text(UNTIDY)
    path.chmod(0o640)
    result = run("fmt", "untidy.yaml", "cell.yaml")
    said = "formatted untidy.yaml\n1 file left unchanged\n"
    assert (result.exit_code, result.stdout, result.stderr) == (0, said, "")
    assert path.read_text() == TIDY
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [each.name for each in folder.iterdir() if each.name.startswith(".")] == []
    assert run("fmt", "untidy.yaml").stdout == "1 file left unchanged\n"


def test_a_link_stays_a_link(folder: Path) -> None:
    (folder / "untidy.yaml").write_text(UNTIDY)
    os.symlink("untidy.yaml", folder / "link.yaml")
    assert run("fmt", "link.yaml").exit_code == 0
    assert (folder / "link.yaml").is_symlink() and (folder / "untidy.yaml").read_text() == TIDY


def test_check_shows_the_difference_and_writes_nothing(folder: Path) -> None:
    (folder / "untidy.yaml").write_text(UNTIDY)
    result = run("fmt", "--check", "cell.yaml", "untidy.yaml")
    assert result.exit_code == 1
    assert result.stdout.startswith("--- untidy.yaml\n+++ untidy.yaml (formatted)\n")
    assert "\n-recipe: 1\n" in result.stdout and "\n+recipe: 1\n" in result.stdout
    assert result.stderr == "1 of 2 would change\n"
    assert (folder / "untidy.yaml").read_text() == UNTIDY
    assert run("fmt", "--check", "cell.yaml").exit_code == 0


def test_check_tells_a_missing_line_break(folder: Path) -> None:
    (folder / "untidy.yaml").write_text("recipe: 1")
    assert "-recipe: 1\n\\ No newline at end of file\n+recipe: 1\n" in run("fmt", "--check", "untidy.yaml").stdout


def test_standard_input(folder: Path) -> None:
    done = process("fmt", "-", input=UNTIDY.replace("\n", "\r\n").encode())
    assert (done.returncode, done.stdout, done.stderr) == (0, TIDY.replace("\n", "\r\n").encode(), b"")
    wrong = process("fmt", "-", input=b"a: [\n")
    assert wrong.returncode == 1 and wrong.stdout == b"" and b"<stdin>:2:1: error[yaml-syntax]" in wrong.stderr


def test_faults_leave_the_file_alone_and_the_others_are_formatted(folder: Path) -> None:
    (folder / "untidy.yaml").write_text(UNTIDY)
    (folder / "broken.yaml").write_text("name: [\n")
    (folder / "empty").mkdir()
    result = run("fmt", "broken.yaml", "absent.yaml", "empty", "untidy.yaml")
    assert result.exit_code == 2  # one of them does not exist
    assert result.stdout == "formatted untidy.yaml\n"
    for code in (
        "broken.yaml:2:1: error[yaml-syntax]",
        "error[file-not-found]: `absent.yaml`",
        "error[file-not-found]: `empty` has no recipe and no MJCF file",
    ):
        assert code in result.stderr
    assert (folder / "broken.yaml").read_text() == "name: [\n"


UNTIDY_MODEL = '<mujoco>\n<worldbody><geom size=".1" name="a"/></worldbody>\n</mujoco>\n'
TIDY_MODEL = '<mujoco>\n  <worldbody>\n    <geom name="a" size=".1"/>\n  </worldbody>\n</mujoco>\n'


def test_models(folder: Path) -> None:
    (folder / "untidy.xml").write_text(UNTIDY_MODEL)
    result = run("fmt", "--check", "untidy.xml")
    assert result.exit_code == 1 and '-<worldbody><geom size=".1" name="a"/></worldbody>\n' in result.stdout
    assert run("fmt", "untidy.xml").stdout == "formatted untidy.xml\n"
    assert (folder / "untidy.xml").read_text() == TIDY_MODEL
    assert run("fmt", "--check", "untidy.xml").exit_code == 0
    assert process("fmt", "-", input=UNTIDY_MODEL.encode()).stdout == TIDY_MODEL.encode()


def test_a_folder_is_its_recipes_and_models(folder: Path) -> None:
    below = folder / "lab" / "deep"
    (below / ".hidden").mkdir(parents=True)
    for path in (below / "a.xml", below / ".hidden" / "b.xml"):
        path.write_text(UNTIDY_MODEL)
    (below / "arm.urdf.xml").write_text(robot := "<robot   name='arm'/>")
    (below / "ci.yml").write_text(other := "on:   push\n")
    (folder / "lab" / "untidy.yaml").write_text(UNTIDY)
    result = run("fmt", "lab")
    assert (result.exit_code, result.stdout) == (0, "formatted lab/untidy.yaml\nformatted lab/deep/a.xml\n")
    assert (below / "a.xml").read_text() == TIDY_MODEL and (below / ".hidden" / "b.xml").read_text() == UNTIDY_MODEL
    assert ((below / "arm.urdf.xml").read_text(), (below / "ci.yml").read_text()) == (robot, other)


def test_no_recipe_is_a_usage_error() -> None:
    assert run("fmt").exit_code == 2


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
def test_closed_streams(folder: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m mjcompose fmt -"
    for line, said in (
        (f"{command} <&-", b"error[file-unreadable]: standard input is closed\n\n1 error\n"),
        (f"{command} < cell.yaml >&-", b"cannot continue: standard output is closed\n"),
    ):
        result = subprocess.run(line, shell=True, env=environment(), capture_output=True, timeout=60, check=False)
        assert (result.returncode, result.stderr, result.stdout) == (1, said, b""), line


def test_a_urdf_is_no_recipe(folder: Path) -> None:
    (folder / "arm.urdf").write_text('<robot name="arm"/>', encoding="utf-8")
    result = run("fmt", "arm.urdf")
    assert result.exit_code == 1 and "error[not-mjcf]: `arm.urdf` is not MJCF: its root is `<robot>`" in result.stderr


def test_a_file_that_has_changed_since_is_left_as_it_is(folder: Path) -> None:
    path = folder / "arm.xml"
    path.write_bytes(b"<mujoco />")
    context = Context(sink=Sink(), folder=folder)
    there = sorted(folder.iterdir())
    assert not rewrite(path, b"<mujoco/>\n", context, before=b"<mujoco></mujoco>")
    assert path.read_bytes() == b"<mujoco />" and sorted(folder.iterdir()) == there
    assert [each.code for each in context.sink.errors] == ["output-unwritable"]
    assert rewrite(path, b"<mujoco/>\n", context, before=b"<mujoco />") and path.read_bytes() == b"<mujoco/>\n"

"""No output takes the place of a file that the run reads, or that its recipes name."""

from __future__ import annotations

import errno
import os
import shutil
from pathlib import Path
from typing import Any

import pytest
from cli.shell import run
from mjcompose.base import files
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import staged_file, staged_folder

TEXTURE = Path(__file__).parents[2] / "recipes" / "models" / "table" / "textures" / "wood.png"
MODEL = """<mujoco>
  <include file="light.xml"/>
  <asset><texture name="wood" type="2d" file="wood.png"/><material name="wood" texture="wood"/></asset>
  <worldbody><geom name="box" type="box" size=".1 .1 .1" material="wood"/></worldbody>
</mujoco>
"""
LIGHT = '<mujoco><worldbody><light pos="0 0 3"/></worldbody></mujoco>'
RECIPE = """recipe: 1
name: wood
base: ./table.xml
# `mjcompose build table.yaml -o said.xml` builds it
variants: {light: {on: {}, off: {attach: {more: {model: ./other.yaml}}}}}
params: {size: 1}
matrix: {axes: {size: [1, 2]}}
edit: [{select: {geom: box}, scale: {size: "${size}"}}]
"""


@pytest.fixture
def table(folder: Path) -> Path:
    """A recipe with the name of its texture, whose model includes a file."""
    for name, text in {
        "table.xml": MODEL,
        "light.xml": LIGHT,
        "table.yaml": RECIPE,
        "other.yaml": "recipe: 1\nextends: ./low.yaml\n",
        "low.yaml": "recipe: 1\nbase: './a far.xml'\n",
        "a far.xml": '<mujoco><compiler meshdir="m"/><asset><mesh name="a" file="a.obj"/></asset></mujoco>',
        "values.yaml": "size: 2\n",
        "second.xml": LIGHT,
    }.items():
        (folder / name).write_text(text)
    (folder / "m").mkdir()
    (folder / "m" / "a.obj").write_text("v 0 0 0\n")
    shutil.copy(TEXTURE, folder / "wood.png")
    if hasattr(os, "symlink"):
        (folder / "link.xml").symlink_to("light.xml")
        (folder / "here").symlink_to(".")
    os.link(folder / "light.xml", folder / "hard.xml")
    return folder


@pytest.mark.parametrize(
    ("arguments", "source"),
    [
        (("build", "table.yaml", "-o", "light.xml"), "light.xml"),
        (("build", "table.yaml", "-o", "wood.xml", "--picture"), "wood.png"),
        (("render", "table.yaml", "-o", "wood.png"), "wood.png"),
        (("render", "table.yaml", "--all", "--jobs", "1", "-o", "wood.png"), "wood.png"),
        (("render", "table.xml", "-o", "wood.png"), "wood.png"),
        (("view", "table.yaml", "--html", "light.xml"), "light.xml"),
        (("view", "table.xml", "--html", "table.xml"), "table.xml"),
    ],
    ids=lambda given: " ".join(given) if isinstance(given, tuple) else "",
)
def test_no_output_takes_the_place_of_a_source(table: Path, arguments: tuple[str, ...], source: str) -> None:
    before = _contents(table)
    result = run(*arguments)
    if "error[no-rendering]" in result.stderr:
        pytest.skip("there is no OpenGL")
    assert result.exit_code == 1, result.output
    assert f"{source}` is one of the files that this model is built from" in result.stderr
    assert _contents(table) == before


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


SOURCES = (
    "table.yaml table.xml light.xml wood.png hard.xml link.xml here/wood.png values.yaml other.yaml low.yaml m/a.obj "
    "table.lock"
).split()


@pytest.mark.skipif(os.name != "posix", reason="links need a privilege there")
def test_no_report_or_page_takes_the_place_of_a_source(table: Path) -> None:
    """Under any of its names, read or only named; the second time the cache has the model."""
    assert run("lock", "table.yaml").exit_code == 0
    before = _contents(table)
    asked = [("check", "table.yaml", "--set-file", "values.yaml", "--junit", each) for each in (*SOURCES, "a far.xml")]
    asked += [("build", "table.yaml", "-o", each) for each in ("link.xml", "hard.xml", "here/light.xml", "a far.xml")]
    asked += [
        ("diff", "table.xml", "second.xml", "--html", each)
        for each in ("table.xml", "second.xml", "here/wood.png", "hard.xml")
    ]
    asked.append(("build", "table.yaml", "--all", "--jobs", "1", "-o", "{name}.xml", "--sample-table", "values.yaml"))
    for arguments in asked:
        result = run(*arguments)
        option, name = arguments[-2:]
        if option != "--sample-table":
            assert result.exit_code == (1 if arguments[0] != "diff" else 2) or arguments[0] == "diff", arguments
            assert f"`{option} {table / name}` is one of the files" in result.stderr, (arguments, result.stderr)
        assert {name: text for name, text in _contents(table).items() if name in before} == before, arguments
    assert run("build", "table.yaml", "-o", "said.xml").exit_code == 0  # a comment names it
    assert run("build", "table.yaml", "-o", "said.xml", "--no-cache").exit_code == 0
    assert run("fmt", "table.yaml").exit_code == 0 and run("lock", "table.yaml").exit_code == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_what_is_no_ordinary_file_is_not_replaced(table: Path) -> None:
    """Neither is a device, which who runs this may be allowed to: so none of the system is tried here."""
    os.mkfifo(table / "pipe")
    result = run("check", "table.yaml", "--junit", "pipe")
    assert result.exit_code == 1 and "pipe`: it is not an ordinary file" in result.stderr
    assert (table / "pipe").is_fifo()


def test_an_older_report_survives_a_full_disk(table: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (table / "report.xml").write_text("old")

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))

    monkeypatch.setattr(Path, "write_text", full)
    result = run("check", "table.yaml", "--junit", "report.xml")
    assert result.exit_code == 1 and "file too large" in result.stderr
    assert (table / "report.xml").read_bytes() == b"old" and not list(table.glob(".report*"))


@pytest.mark.parametrize("kind", [RecursionError, MemoryError, OSError, UnicodeError, RuntimeError])
@pytest.mark.parametrize("inner", ["_identity", "real_path", "_text", "_folder"])
def test_what_cannot_be_judged_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: type[Exception], inner: str
) -> None:
    (tmp_path / "a.yaml").write_text("base: ./b.xml\n")
    (tmp_path / "out.xml").write_text("old")

    def fails(*_: Any, **__: Any) -> Any:
        raise kind

    monkeypatch.setattr(files, inner, fails)
    with files.run() as own:
        own.note([tmp_path / "a.yaml"])
        with (
            pytest.raises(OutputError, match="which may be a source of this run"),
            staged_file(tmp_path / "out.xml", "-o", inputs=[tmp_path / "c.xml"]),
        ):
            pytest.fail("it began to write")
        with pytest.raises(OutputError), staged_folder(tmp_path, inputs=[tmp_path / "c.xml"]):
            pytest.fail("it began to write")
    assert (tmp_path / "out.xml").read_text() == "old"


def test_a_file_that_is_read_while_the_output_is_made(tmp_path: Path) -> None:
    (tmp_path / "out.xml").write_text("old")
    with files.run() as own, pytest.raises(OutputError), staged_file(tmp_path / "out.xml") as stage:
        stage.write_text("new")
        own.note([tmp_path / "out.xml"])
    assert [each.read_text() for each in tmp_path.iterdir()] == ["old"]


def test_a_worker_knows_what_the_run_has_read(tmp_path: Path) -> None:
    (tmp_path / "values.yaml").touch()
    with files.run() as first:
        first.note([tmp_path / "values.yaml"])
        noted = first.noted()
    with files.run() as second:
        assert second.taken(str(tmp_path / "values.yaml")) is None
        second.note(noted)
        assert second.taken(str(tmp_path / "values.yaml")) is not None
        assert second.taken(str(tmp_path)) is not None


def test_a_source_that_an_editor_has_replaced_is_one_still(tmp_path: Path) -> None:
    source = tmp_path / "a.xml"
    source.write_text("old")
    with files.run() as own:
        own.note([source])
        assert own.taken(str(source)) is not None
        (tmp_path / "new").write_text("new")
        (tmp_path / "new").replace(source)
        assert own.taken(str(source)) is not None

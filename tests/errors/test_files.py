"""Files that a repository cannot hold: too large, unreadable, no files at all. In one of three places each."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

SOURCE = '<mujoco>\n  <asset>\n    <mesh name="base" file="base.obj"/>\n  </asset>\n  <include file="more.xml"/>\n</mujoco>\n'
FILES = {
    "recipe.yaml": "recipe: 1\nbase: ./robot.xml\n",
    "robot.xml": SOURCE,
    "more.xml": '<mujocoinclude>\n  <worldbody>\n    <geom type="mesh" mesh="base"/>\n  </worldbody>\n</mujocoinclude>\n',
    "base.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
}
# Where it is told that a file cannot be read, and with which code.
PLACES = {
    "recipe.yaml": (None, "file-unreadable"),
    "robot.xml": (("recipe.yaml", 2, 7), "file-unreadable"),
    "more.xml": (("robot.xml", 5, 18), "xml-include"),
    "base.obj": (("robot.xml", 3, 29), "asset-missing"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def told(folder: Path) -> Diagnostic:
    """The one fault of the recipe."""
    context = Context(environment={}, folder=folder)
    assert build(ModelRequest(folder / "recipe.yaml", verified=False), context) is None
    (fault,) = context.sink.diagnostics
    return fault


def place_of(fault: Diagnostic) -> tuple[str, int, int] | None:
    return None if fault.span is None else (fault.span.file, fault.span.line, fault.span.column)


def test_all_is_well_without_a_fault(folder: Path) -> None:
    assert (
        build(ModelRequest(folder / "recipe.yaml", verified=False), Context(environment={}, folder=folder)) is not None
    )


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
@pytest.mark.parametrize("name", PLACES)
def test_a_link_to_itself(folder: Path, name: str) -> None:
    """Not even the superuser can read it."""
    (folder / name).unlink()
    (folder / name).symlink_to(name)
    fault = told(folder)
    place, code = PLACES[name]
    if name == "robot.xml":  # not a file, and so no model to refer to
        code = "source-not-found"
    assert (place_of(fault), fault.code) == (place, code)


@pytest.mark.parametrize("name", PLACES)
def test_a_file_that_must_not_be_read(folder: Path, name: str) -> None:
    (folder / name).chmod(0)
    if os.access(folder / name, os.R_OK):
        pytest.skip("who runs this may read everything")
    fault = told(folder)
    place, code = PLACES[name]
    assert (place_of(fault), fault.code) == (place, code)
    assert "permission denied" in fault.message


@pytest.mark.parametrize(("name", "size"), [("robot.xml", 65 << 20), ("more.xml", 65 << 20)])
def test_a_huge_source(folder: Path, name: str, size: int) -> None:
    os.truncate(folder / name, size)  # sparse: it takes no room
    fault = told(folder)
    assert (place_of(fault), fault.code) == (PLACES[name][0], "limit-exceeded")
    assert fault.message.endswith("is not read: it is larger than 64M")
    assert fault.help == "to allow it, raise the limit: `--limit xml-size=65M`"


def test_a_huge_recipe(folder: Path) -> None:
    os.truncate(folder / "recipe.yaml", 1 << 40)
    fault = told(folder)
    assert fault.code == "yaml-too-large" and place_of(fault) == ("recipe.yaml", 1, 1)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="needs a device that never ends")
def test_a_recipe_without_an_end() -> None:
    context = Context(environment={}, folder=Path("/dev"))
    assert build(ModelRequest(Path("/dev/zero"), verified=False), context) is None
    assert [each.code for each in context.sink.diagnostics] == ["file-unreadable"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_recipe_that_nobody_writes(folder: Path) -> None:
    (folder / "recipe.yaml").unlink()
    os.mkfifo(folder / "recipe.yaml")
    fault = told(folder)
    assert (fault.code, fault.message.partition(",")[0]) == ("file-unreadable", "`recipe.yaml` is a named pipe")


@pytest.mark.skipif(not Path("/dev/fd").exists(), reason="needs the shell's way to name a pipe")
def test_a_recipe_that_a_command_writes() -> None:
    reading, writing = os.pipe()
    os.write(writing, b"recipe: 1\n")
    os.close(writing)
    context = Context(environment={}, folder=Path("/dev/fd"))
    assert build(ModelRequest(Path(f"/dev/fd/{reading}"), verified=False), context) is not None
    os.close(reading)


@pytest.mark.parametrize("name", ["robot.xml", "more.xml", "base.obj"])
def test_a_folder_in_the_place_of_a_file(folder: Path, name: str) -> None:
    (folder / name).unlink()
    (folder / name).mkdir()
    fault = told(folder)
    assert place_of(fault) == PLACES[name][0]
    if name != "robot.xml":
        assert fault.message.endswith("cannot be read: is a directory")


def test_names_that_are_too_long(folder: Path) -> None:
    (folder / "robot.xml").write_text(SOURCE.replace("more.xml", "x" * 300 + ".xml"))
    fault = told(folder)
    assert fault.code == "xml-include" and "file name too long" in fault.message
    (folder / "robot.xml").write_text(SOURCE.replace("base.obj", "x" * 300 + ".obj"))
    assert told(folder).code == "asset-missing"
    (folder / "recipe.yaml").write_text(f"recipe: 1\nbase: ./{'x' * 300}.xml\n")
    assert told(folder).code == "source-not-found"


def test_elements_that_stand_too_deep(folder: Path) -> None:
    for depth, code in ((1500, "not-supported"), (3000, "xml-syntax")):
        (folder / "more.xml").write_text(
            f"<mujocoinclude><worldbody>{'<frame>' * depth}{'</frame>' * depth}</worldbody></mujocoinclude>"
        )
        (folder / "recipe.yaml").write_text("recipe: 1\nattach:\n  robot: {model: ./robot.xml}\n")
        assert told(folder).code == code

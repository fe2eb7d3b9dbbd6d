"""A folder from somebody else has links to files elsewhere, which no command changes unless the user names them."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.shell import run, snapshot
from mjcompose.base.access import door_of_walk
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import replace_text, staged_file

pytestmark = pytest.mark.skipif(os.name != "posix", reason="links")

UNTIDY = "<mujoco><default><default class='unused'/></default><worldbody><geom size='1' name='g'/></worldbody></mujoco>"
PART = (
    """<mujoco><worldbody><body name="b"><joint name="j" range="90 -90"/><geom size="1"/></body></worldbody></mujoco>"""
)
RECIPE = "name: arm\nrecipe: 1\nbase: ./own.xml\n"
WRONG = "recipe: 1\nbase: ./own.xml\nsensors: {}\n"


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, next to `mine`."""
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "secret.xml").write_text(UNTIDY)
    (mine / "part.xml").write_text(PART)
    (mine / "own.xml").write_text("<mujoco/>")
    (mine / "robot.yaml").write_text(RECIPE)
    (mine / "wrong.yaml").write_text(WRONG)
    (mine / "robot.lock").write_text("")
    theirs = tmp_path / "theirs"
    (theirs / "sub").mkdir(parents=True)
    (theirs / "own.xml").write_text("<mujoco/>")
    monkeypatch.chdir(theirs)
    return theirs


def a_link(theirs: Path) -> None:
    (theirs / "arm.xml").symlink_to("../mine/secret.xml")
    (theirs / "arm.yaml").symlink_to("../mine/robot.yaml")


def an_absolute_link(theirs: Path) -> None:
    (theirs / "arm.xml").symlink_to(theirs.parent / "mine" / "secret.xml")


def a_chain(theirs: Path) -> None:
    (theirs / "arm.xml").symlink_to("sub/next.xml")
    (theirs / "sub" / "next.xml").symlink_to("../.hidden.xml")
    (theirs / ".hidden.xml").symlink_to("../mine/secret.xml")


def a_folder(theirs: Path) -> None:
    (theirs / "models").symlink_to("../mine")
    (theirs / "sub" / "arm.xml").symlink_to("../models/secret.xml")


def a_way_around(theirs: Path) -> None:
    (theirs / "sub" / "arm.xml").symlink_to("../../theirs/../mine/secret.xml")


@pytest.mark.parametrize("plant", [a_link, an_absolute_link, a_chain, a_folder, a_way_around])
@pytest.mark.parametrize("words", [("fmt", "."), ("fmt", "sub/.."), ("lint", "--fix", ".", "--select", "dead")])
def test_a_walk_changes_nothing_outside_of_its_folder(
    theirs: Path, plant: Callable[[Path], None], words: tuple[str, ...]
) -> None:
    plant(theirs)
    mine = snapshot(theirs.parent / "mine")
    result = run(*words)
    assert snapshot(theirs.parent / "mine") == mine
    assert "secret.xml`, is outside `" in result.stderr and "it is not changed" in result.stderr
    assert "note[source-outside]" in result.stderr and "traceback" not in result.stderr.lower()


def test_a_glob_is_a_walk(theirs: Path) -> None:
    a_link(theirs)
    mine = snapshot(theirs.parent / "mine")
    assert "is outside" in run("lint", "--fix", "a*.xml", "--select", "dead").stderr
    assert snapshot(theirs.parent / "mine") == mine


@pytest.mark.parametrize("words", [("fmt",), ("lint", "--select", "dead", "--fix")])
def test_a_link_that_the_user_names_is_followed(theirs: Path, words: tuple[str, ...]) -> None:
    a_link(theirs)
    run(*words, "arm.xml")
    assert (theirs / "arm.xml").is_symlink()
    assert (theirs.parent / "mine" / "secret.xml").read_text() != UNTIDY


def test_a_folder_that_the_user_names_may_be_a_link(theirs: Path) -> None:
    (theirs / "models").symlink_to("../mine")
    result = run("fmt", "models")
    assert "formatted models/secret.xml" in result.stdout and "outside" not in result.stderr


def test_a_file_with_several_names_is_written_once(theirs: Path) -> None:
    (theirs / "real.xml").write_text(UNTIDY)
    (theirs / "again.xml").symlink_to("real.xml")
    (theirs / "sub" / "more.xml").symlink_to("../again.xml")
    (theirs / "own.xml").unlink()
    result = run("fmt", ".")
    assert result.stdout.count("formatted") == 1 and "outside" not in result.stderr
    assert (theirs / "again.xml").is_symlink() and (theirs / "sub" / "more.xml").is_symlink()
    assert (theirs / "real.xml").read_text() != UNTIDY


def test_a_walk_does_not_change_files_that_a_model_includes_from_elsewhere(theirs: Path) -> None:
    (theirs / "sub" / "arm.xml").write_text('<mujoco><include file="../../mine/part.xml"/></mujoco>')
    (theirs.parent / "package.xml").write_text("<package/>")  # one project, so the model may read the file
    mine = snapshot(theirs.parent / "mine")
    result = run("lint", "--fix", "sub")
    assert snapshot(theirs.parent / "mine") == mine
    assert "part.xml` is outside `sub`: it is not changed" in result.stderr
    assert "fixed 1 finding" in run("lint", "--fix", "sub/arm.xml").stdout
    assert 'range="-90 90"' in (theirs.parent / "mine" / "part.xml").read_text()


def test_fix_changes_only_recipes_of_the_project(theirs: Path) -> None:
    (theirs / "robot.yaml").write_text("recipe: 1\nattach: {a: {model: ../mine/wrong.yaml}}\n")
    mine = snapshot(theirs.parent / "mine")
    result = run("fix", "robot.yaml", "--write")
    assert snapshot(theirs.parent / "mine") == mine
    assert "wrong.yaml` is outside" in result.stderr
    (theirs.parent / "pyproject.toml").write_text("")  # one project
    assert run("fix", "robot.yaml", "--write").exit_code == 0
    assert "sensor: {}" in (theirs.parent / "mine" / "wrong.yaml").read_text()


@pytest.mark.parametrize("words", [("lock",), ("build",), ("check", "--locked"), ("plan",)])
def test_a_dangling_lock_is_an_error(theirs: Path, words: tuple[str, ...]) -> None:
    (theirs / "robot.yaml").write_text(RECIPE)
    (theirs / "robot.lock").symlink_to("../mine/new.lock")
    result = run(words[0], "robot.yaml", *words[1:])
    assert result.exit_code == 1
    message = "the lock `robot.lock` is a link to `../mine/new.lock`, which does not exist"
    assert f"error[lock-invalid]: {message}" in result.stderr
    assert not (theirs.parent / "mine" / "new.lock").exists()


def test_a_lock_that_leads_elsewhere_is_read_but_not_written(theirs: Path) -> None:
    (theirs / "robot.yaml").write_text(RECIPE)
    assert run("lock", "robot.yaml").exit_code == 0
    locked = (theirs / "robot.lock").rename(theirs.parent / "mine" / "robot.lock")
    (theirs / "robot.lock").symlink_to("../mine/robot.lock")
    assert run("check", "robot.yaml").exit_code == 0
    (theirs / "robot.yaml").write_text(RECIPE + "attach: {part: {model: ./own.xml}}\n")
    before = locked.read_bytes()
    result = run("lock", "robot.yaml")
    assert (
        result.exit_code == 1 and "error[output-unwritable]" in result.stderr and "nothing is written" in result.stderr
    )
    assert locked.read_bytes() == before


def test_a_link_that_takes_the_place_of_a_file_is_replaced_and_not_followed(theirs: Path) -> None:
    """Between the look and the write, somebody puts a link there."""
    file = theirs / "arm.xml"
    secret = theirs.parent / "mine" / "secret.xml"
    file.write_text("before")
    with staged_file(file, rewrites=True, within=door_of_walk(theirs)) as stage:
        stage.write_text("after")
        file.unlink()
        file.symlink_to(secret)
    assert file.read_text() == "after" and not file.is_symlink()
    assert secret.read_text() == UNTIDY


def test_a_link_that_takes_the_place_of_a_file_before_it_is_resolved_is_refused(theirs: Path) -> None:
    a_link(theirs)
    with pytest.raises(OutputError, match="is outside"):
        replace_text(theirs / "arm.xml", b"after", within=door_of_walk(theirs))
    assert (theirs.parent / "mine" / "secret.xml").read_text() == UNTIDY


SEVERAL = "recipe: 1\nbase: ./own.xml\nmatrix: {axes: {size: [1, 2]}, name: '${name}-${size}'}\nparams: {size: 1}\n"


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("build/robot.zip", ["build", "robot.yaml"]),
        ("build/robot.png", ["build", "robot.yaml", "--picture"]),
        ("build/robot.png", ["render", "robot.yaml"]),
        ("build/several-2.zip", ["build", "several.yaml", "--all"]),
        ("build/models.csv", ["build", "several.yaml", "--all"]),
        ("out/robot.xml", ["build", "robot.yaml", "-o", "out/{name}.xml"]),
        ("out/robot.manifest.json", ["build", "robot.yaml", "-o", "out/robot.mjb"]),
    ],
)
def test_an_output_that_the_user_does_not_name_follows_no_link(theirs: Path, link: str, words: list[str]) -> None:
    (theirs / "own.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    (theirs / "robot.yaml").write_text("recipe: 1\nbase: ./own.xml\n")
    (theirs / "several.yaml").write_text(SEVERAL)
    (theirs / link).parent.mkdir()
    (theirs / link).symlink_to("../../mine/secret.xml")
    mine = snapshot(theirs.parent / "mine")
    result = run(*words)
    assert snapshot(theirs.parent / "mine") == mine
    assert result.exit_code == 1 and f"`{theirs / link}` is a link to" in result.stderr.replace(
        f"`{link}`", f"`{theirs / link}`"
    )


def test_an_output_that_the_user_names_follows_a_link(theirs: Path) -> None:
    (theirs / "robot.yaml").write_text(RECIPE)
    (theirs / "out.zip").symlink_to("../mine/new.zip")
    assert run("build", "robot.yaml", "-o", "out.zip").exit_code == 0
    assert (theirs.parent / "mine" / "new.zip").exists() and (theirs / "out.zip").is_symlink()
    (theirs / "build").symlink_to("../mine")  # a folder elsewhere, such as a larger disk
    assert run("build", "robot.yaml").exit_code == 0
    assert (theirs.parent / "mine" / "arm.zip").exists()

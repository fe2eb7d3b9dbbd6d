from __future__ import annotations

from pathlib import Path

import pytest

from composer.diagnostics import Sink, Span
from composer.reading import project
from composer.reading.project import MARKERS, folder_of_recipe, folders_of_model, own_door, project_of
from composer.reading.refused import Refused


@pytest.mark.parametrize("marker", MARKERS)
def test_the_nearest_folder_with_a_marker(tmp_path: Path, marker: str) -> None:
    model = tmp_path / "robot" / "a" / "b" / "arm.xml"
    model.parent.mkdir(parents=True)
    (tmp_path / marker).touch()
    (tmp_path / "robot" / marker).touch()
    assert project_of(model.parent) == str(tmp_path / "robot")
    assert folders_of_model(model) == [str(tmp_path / "robot")]


def test_without_a_marker_the_folder_above(tmp_path: Path) -> None:
    """`robot/mjcf/arm.xml` with `../meshes/` is how most robots are laid out."""
    door = own_door(tmp_path / "robot" / "mjcf" / "arm.xml")
    assert door.sees(tmp_path / "robot" / "meshes" / "arm.stl")
    assert not door.sees(tmp_path / "other" / "arm.stl")


def test_a_home_is_no_project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A `.git` there is for somebody's settings, and a model in it does not see what else is there."""
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("USERPROFILE", str(tmp_path / "home"))
    (tmp_path / "home" / "robot" / "mjcf").mkdir(parents=True)
    (tmp_path / "home" / ".git").mkdir()
    (tmp_path / ".git").mkdir()
    robot = tmp_path / "home" / "robot"
    assert project_of(robot) is None
    assert folders_of_model(robot / "arm.xml") == [str(robot)]
    assert folders_of_model(robot / "mjcf" / "arm.xml") == [str(robot)]
    assert folders_of_model(tmp_path / "home" / "arm.xml") == [str(tmp_path / "home")]
    assert not own_door(robot / "arm.xml").sees(tmp_path / "home" / ".ssh" / "id_rsa")


def test_the_folder_for_temporary_files_is_nobodys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(tmp_path))
    project._too_wide.cache_clear()
    try:
        assert folders_of_model(tmp_path / "robot" / "arm.xml") == [str(tmp_path / "robot")]
    finally:
        project._too_wide.cache_clear()


def test_a_model_that_is_a_link_sees_where_it_is_and_where_it_is_called(tmp_path: Path) -> None:
    for name in ("share", "source"):
        (tmp_path / name / "robot" / "urdf").mkdir(parents=True)
        (tmp_path / name / "robot" / "package.xml").touch()
    (tmp_path / "source" / "robot" / "urdf" / "arm.urdf").touch()
    called = tmp_path / "share" / "robot" / "urdf" / "arm.urdf"
    called.symlink_to(tmp_path / "source" / "robot" / "urdf" / "arm.urdf")
    assert folders_of_model(called) == [str(tmp_path / "share" / "robot"), str(tmp_path / "source" / "robot")]


def test_the_folder_of_a_recipe(tmp_path: Path) -> None:
    assert folder_of_recipe(tmp_path / "a" / "recipe.yaml") == str(tmp_path / "a")
    (tmp_path / "pyproject.toml").touch()
    assert folder_of_recipe(tmp_path / "a" / "recipe.yaml") == str(tmp_path)


def test_files_of_one_folder_outside_have_one_cause(tmp_path: Path) -> None:
    sink, door = Sink(), own_door(tmp_path / "robot" / "mjcf" / "arm.xml")
    for number, name in enumerate(["one/a.stl", "one/b.stl", "two/c.stl", "one/d.stl"], 1):
        with pytest.raises(Refused) as refused:
            door.admit(tmp_path / name)
        refused.value.report(sink, Span("arm.xml", number, 5), shown=lambda path: path.name)
    first, second = sink.diagnostics
    assert [(each.message, each.span and each.span.line) for each in first.others] == [
        ("`b.stl`", 2),
        ("`d.stl`", 4),
    ]
    assert second.others == () and second.span == Span("arm.xml", 3, 5)

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mjcompose.base import access
from mjcompose.base.access import ALL, MARKERS, NOTHING, Door, folder_of_recipe, folders_of_model, own_door, project_of
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import Refused, read_regular
from mjcompose.base.sink import Sink

fifos = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A folder `own` with a file, and a file beside it that it must not see."""
    (tmp_path / "own" / "deep").mkdir(parents=True)
    (tmp_path / "own" / "mesh.obj").write_text("mine")
    (tmp_path / "secret.obj").write_text("secret")
    (tmp_path / "ownership").mkdir()
    (tmp_path / "ownership" / "secret.obj").write_text("secret")
    return tmp_path


def test_what_is_inside_is_read(tree: Path) -> None:
    door = Door.of([tree / "own"])
    assert door.read(tree / "own" / "mesh.obj") == b"mine"
    assert door.read(f"{tree}/own/deep/../mesh.obj") == b"mine"
    assert door.admit(f"{tree}/own/none.obj") == f"{tree}/own/none.obj"  # reported where it is read
    assert door.exists(tree / "own" / "mesh.obj") and not door.exists(tree / "own" / "none.obj")


@pytest.mark.parametrize(
    "path", ["secret.obj", "own/../secret.obj", "own/deep/../../secret.obj", "ownership/secret.obj", ""]
)
def test_what_is_outside_is_refused(tree: Path, path: str) -> None:
    door = Door.of([tree / "own"], "the robot", "put it into {folder}")
    assert not door.sees(f"{tree}/{path}") and not door.exists(f"{tree}/{path}")
    for ask in (door.admit, door.read):
        with pytest.raises(Refused) as caught:
            ask(f"{tree}/{path}")
        assert "is outside the robot" in caught.value.message()


def test_links_are_followed_before_they_are_judged(tree: Path) -> None:
    (tree / "own" / "link.obj").symlink_to(tree / "secret.obj")
    (tree / "own" / "out").symlink_to(tree)
    (tree / "own" / "in.obj").symlink_to("mesh.obj")
    (tree / "own" / "chain.obj").symlink_to("link.obj")
    door = Door.of([tree / "own"])
    assert door.read(tree / "own" / "in.obj") == b"mine"
    for path in ("own/link.obj", "own/out/secret.obj", "own/out/ownership/secret.obj", "own/chain.obj"):
        with pytest.raises(Refused):
            door.read(tree / path)
    with pytest.raises(Refused) as caught:
        door.read(tree / "own" / "link.obj")
    assert f"link.obj`, a link to `{tree / 'secret.obj'}`, is outside" in caught.value.message()


def test_a_root_that_is_a_link_is_where_it_leads(tree: Path) -> None:
    (tree / "called").symlink_to(tree / "own")
    assert Door.of([tree / "called"]).read(tree / "own" / "mesh.obj") == b"mine"
    assert Door.of([tree / "own"]).read(tree / "called" / "mesh.obj") == b"mine"


def test_a_wider_door(tree: Path) -> None:
    door = Door.of([tree / "own"])
    assert not door.sees(tree / "ownership" / "secret.obj")
    assert door.wider((tree / "ownership",)).read(tree / "ownership" / "secret.obj") == b"secret"
    assert not door.wider((tree / "ownership",)).sees(tree / "secret.obj")


def test_the_doors_without_folders(tree: Path) -> None:
    assert ALL.read(tree / "secret.obj") == b"secret"
    with pytest.raises(Refused):
        NOTHING.read(tree / "own" / "mesh.obj")


@fifos
@pytest.mark.timeout(10)
def test_a_pipe_is_refused_at_once(tree: Path) -> None:
    os.mkfifo(tree / "own" / "pipe.obj")
    for read in (Door.of([tree / "own"]).read, ALL.read, read_regular):
        with pytest.raises(Refused) as caught:
            read(tree / "own" / "pipe.obj")
        assert "is a named pipe, not an ordinary file" in caught.value.message()


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="needs devices")
@pytest.mark.timeout(10)
def test_a_device_is_refused_at_once() -> None:
    with pytest.raises(Refused, match="device"):
        ALL.read("/dev/zero")


def test_a_bound(tree: Path) -> None:
    with pytest.raises(OSError, match="larger than"):
        ALL.read(tree / "secret.obj", 3)
    assert ALL.read(tree / "secret.obj", 6) == b"secret"


def test_a_report_has_the_place_and_what_to_write(tree: Path) -> None:

    door = Door.of([tree / "own"], "the robot", "write `trust: {files: [{folder}]}`", str(tree / "own"))
    sink = Sink()
    span = Span("arm.xml", 1, 2)
    door.outside(str(tree / "ownership" / "x.obj")).report(sink, span, shown=lambda path: path.name)
    (found,) = sink.errors
    assert (found.code, found.span) == ("source-outside", span)
    assert found.message == "the file `x.obj` is outside the robot"
    assert found.help == "write `trust: {files: [../ownership]}`"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_pipe_is_neither_let_through_nor_opened(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo(tree / "own" / "pipe")
    door = Door.of([tree / "own"])
    with pytest.raises(Refused, match="a named pipe"):
        door.admit(tree / "own" / "pipe")
    # one that took the place of a file since it was looked at
    monkeypatch.setattr("mjcompose.base.files.is_irregular", lambda path: None)
    with pytest.raises(Refused, match="a named pipe"):
        read_regular(tree / "own" / "pipe")


def test_many_files_are_admitted_by_one_look_at_their_folder(tree: Path) -> None:
    for folder in ("own", "ownership"):
        for name in "abcd":
            (tree / folder / f"{name}.obj").write_text(name)
    (tree / "own" / "link.obj").symlink_to(tree / "secret.obj")
    (tree / "own" / "out").symlink_to(tree / "ownership")
    mine = [f"{tree}/own/{name}.obj" for name in "abcd"]
    others = [f"{tree}/{folder}/{name}.obj" for folder in ("ownership", "own/out", "none") for name in "abcd"]
    asked = [*mine, f"{tree}/own/link.obj", f"{tree}/own/none.obj", *others]
    assert sorted(Door.of([tree / "own"]).admit_listed(asked)) == mine
    assert set(ALL.admit_listed(asked)) == {*mine, *others[:8]}


def test_a_search_looks_into_folders_that_the_door_shows(tree: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    door = Door.of([tree / "own"])
    (tree / "own" / "deep" / "mesh.obj").write_text("deep")
    (tree / "own" / ".hidden.obj").write_text("")
    (tree / "own" / "out").symlink_to(tree)
    assert door.search(f"{tree}/own/*.obj") == [f"{tree}/own/mesh.obj"]
    assert door.search(f"{tree}/own/d*/m?sh.[no]bj") == [f"{tree}/own/deep/mesh.obj"]
    assert door.search(f"{tree}/own/mesh.obj") == [f"{tree}/own/mesh.obj"]
    assert door.search(f"{tree}/own/deep/**") == [f"{tree}/own/deep/mesh.obj"]
    looked: list[str] = []
    names = os.listdir
    monkeypatch.setattr(os, "listdir", lambda folder: looked.append(folder) or names(folder))
    for pattern in (f"{tree}/*.obj", "/usr/*/x", "/*", f"{tree}/own/../*", f"{tree}/own/out/*"):
        with pytest.raises(Refused):
            door.search(pattern)
    with pytest.raises(Refused):
        door.search(f"{tree}/own/*/secret.obj")  # one of the folders is a link that leads out
    assert looked == [f"{tree}/own"]


def test_a_search_ends(tree: Path) -> None:
    for number in range(30):
        (tree / "own" / f"{number}.obj").write_text("")
    looks = iter(range(50))
    door = Door.of([tree])
    assert len(door.search(f"{tree}/own/*.obj", looks)) == 31
    with pytest.raises(Refused, match="too many"):
        door.search(f"{tree}/own/*.obj", looks)


@pytest.mark.parametrize("error", [RecursionError, MemoryError, OSError, UnicodeError])
@pytest.mark.parametrize("inner", ["_mode", "parted", "real_folder"])
def test_a_door_whose_judgement_fails_shows_nothing(
    tree: Path, monkeypatch: pytest.MonkeyPatch, inner: str, error: type[Exception]
) -> None:
    def fails(*_: object) -> object:
        raise error

    from mjcompose.base import access as module

    monkeypatch.setattr(module, inner, fails)
    door = Door((str(tree / "own"),))
    for ask in (door.admit, door.read, door.sees, lambda path: door.search(f"{path.parent}/*")):
        try:
            assert not ask(tree / "own" / "mesh.obj")
        except (error, Refused):
            continue


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_what_is_no_ordinary_file_is_not_even_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To open a device may do something."""
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.setattr(os, "open", lambda *_: pytest.fail("it was opened"))
    with pytest.raises(Refused, match="named pipe"):
        read_regular(tmp_path / "pipe")


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
    access._too_wide.cache_clear()
    try:
        assert folders_of_model(tmp_path / "robot" / "arm.xml") == [str(tmp_path / "robot")]
    finally:
        access._too_wide.cache_clear()


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
    sink = Sink()
    door = own_door(tmp_path / "robot" / "mjcf" / "arm.xml")
    for number, name in enumerate(["one/a.stl", "one/b.stl", "two/c.stl", "one/d.stl"], 1):
        with pytest.raises(Refused) as refused:
            door.admit(tmp_path / name)
        refused.value.report(sink, Span("arm.xml", number, 5), shown=lambda path: path.name)
    first, second = sink.diagnostics
    assert [(each.message, each.span and each.span.line) for each in first.others] == [("`b.stl`", 2), ("`d.stl`", 4)]
    assert second.others == () and second.span == Span("arm.xml", 3, 5)

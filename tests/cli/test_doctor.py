from __future__ import annotations

import json
from importlib import metadata
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose.cli import about
from mjcompose.cli.about import SetupFinding, _store, _templates
from mjcompose.sources.blobs import put


def test_a_working_installation_is_said_to_be_one() -> None:
    result = run("doctor")
    assert result.exit_code == 0, result.stdout
    told = {line[4:].split()[0]: line[:2] for line in result.stdout.splitlines()}
    assert {told[name] for name in ("mjcompose", "mujoco", "numpy", "store")} == {"ok"}


def test_another_package_of_the_same_name_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "packages_distributions", lambda: {"mjcompose": ["mjcompose", "composer"]})
    result = run("doctor")
    assert result.exit_code == 1
    assert "`composer` also install it" in result.stdout


def test_what_not_everybody_needs_is_no_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    result = run("doctor", "--output-format", "json")
    found = {each["what"]: each for each in json.loads(result.stdout)}
    assert result.exit_code == 0
    assert found["git"]["fine"] is None and "need it" in found["git"]["found"]


def test_mujoco_works_where_pictures_cannot_be_made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "nonsense")
    result = run("doctor", "--output-format", "json")
    found = {each["what"]: each for each in json.loads(result.stdout)}
    assert result.exit_code == 0
    assert found["mujoco"]["fine"] and found["OpenGL"]["fine"] is None
    assert "nonsense" in found["OpenGL"]["found"]


@pytest.mark.parametrize(
    ("answer", "found"),
    [
        (
            {"ok": True, "confined": ["limits", "Landlock 7"], "value": {"write": False, "connect": False}},
            SetupFinding("templates", "confined by limits, Landlock 7"),
        ),
        (
            {"ok": True, "confined": [], "value": {"write": True, "connect": True}},
            SetupFinding(
                "templates", "this system has no way to confine their process; it can write and connect", None
            ),
        ),
        (
            {"ok": False, "error": "its process cannot be confined: seccomp", "crash": "unconfined"},
            SetupFinding("templates", "cannot be expanded: its process cannot be confined: seccomp", False),
        ),
    ],
)
def test_how_templates_are_confined_is_told(
    monkeypatch: pytest.MonkeyPatch, answer: dict[str, object], found: SetupFinding
) -> None:
    monkeypatch.setattr(about, "call_confined", lambda *_, **__: answer)
    assert _templates() == found


def test_the_store_is_measured_and_tried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    put(tmp_path / "store", "raw", "1" * 64, bytes(3_000_000))
    assert _store() == SetupFinding("store", f"{tmp_path / 'store'}, 3.0 MB")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "file"))
    found = _store()
    assert found.fine is None and "cannot be written" in found.found

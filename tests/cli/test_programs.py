"""`mjcompose install` and `uninstall` as they are typed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli.shell import run
from mjcompose.mujoco import programs


@pytest.fixture(autouse=True)
def there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Path]:
    """The versions that are installed: no installer runs."""
    versions: dict[str, Path] = {}

    def install(version: str, *_: object) -> bool:
        is_new = version not in versions
        versions[version] = tmp_path / version
        return is_new

    monkeypatch.setenv("MJCOMPOSE_PROGRAMS", str(tmp_path / "programs"))
    monkeypatch.setattr(programs, "install", install)
    monkeypatch.setattr(programs, "uninstall", lambda version, _: versions.pop(version, None) is not None)
    monkeypatch.setattr(programs, "installed", lambda _: versions)
    return versions


def test_install_list_and_uninstall(tmp_path: Path) -> None:
    assert run("install").stdout == f"nothing is installed in {tmp_path / 'programs'}\n"
    result = run("install", "mujoco==3.12", "mujoco==3.2.0", "mujoco==3.12.0")
    assert result.stdout == "installed MuJoCo 3.12.0\ninstalled MuJoCo 3.2.0\n"
    assert run("install", "mujoco==3.12").stdout == "already installed: MuJoCo 3.12.0\n"
    assert run("install").stdout == (f"mujoco==3.12.0  {tmp_path / '3.12.0'}\nmujoco==3.2.0  {tmp_path / '3.2.0'}\n")
    data = json.loads(run("install", "--output-format", "json").stdout)
    assert data["installed"][0] == {"program": "mujoco==3.12.0", "python": str(tmp_path / "3.12.0")}
    assert run("uninstall", "mujoco==3.12", "mujoco==3.3.0").stdout == (
        "removed MuJoCo 3.12.0\nMuJoCo 3.3.0 is not installed\n"
    )


@pytest.mark.parametrize("word", ["mujoco", "mujoco==2.3", "drake", "mujoco==../..", "mujoco==3.12; ls", ""])
def test_only_releases_of_mujoco_are_programs(word: str, there: dict[str, Path]) -> None:
    for verb in ("install", "uninstall"):
        result = run(verb, word)
        assert result.exit_code == 2 and f"`{word}` is not `mujoco==VERSION`" in result.stderr
    assert there == {}
    assert run("uninstall").exit_code == 2


def test_an_installer_that_fails_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def install(version: str, *_: object) -> bool:
        raise programs.ProgramError(f"MuJoCo {version} cannot be installed: no network", "try again")

    monkeypatch.setattr(programs, "install", install)
    result = run("install", "mujoco==3.12")
    assert result.exit_code == 2
    assert "error[not-installed]: MuJoCo 3.12.0 cannot be installed: no network\n  = help: try again" in result.stderr

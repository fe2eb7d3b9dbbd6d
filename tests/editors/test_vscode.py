"""The extension for VS Code: its own tests, and what is in the file that is installed."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXTENSION = ROOT / "editors" / "vscode"
INSTALL = ["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"]

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the extension, in a copy of what it needs of the repository."""
    if shutil.which("npm") is None:
        pytest.skip("there is no npm")
    root = tmp_path_factory.mktemp("repository")
    shutil.copy(ROOT / "LICENSE", root)
    shutil.copytree(ROOT / "recipes", root / "recipes")
    folder = root / "editors" / "vscode"
    shutil.copytree(EXTENSION, folder, ignore=shutil.ignore_patterns("node_modules", "build", "dist", "*.vsix"))
    if (EXTENSION / "node_modules").is_dir():
        (folder / "node_modules").symlink_to(EXTENSION / "node_modules")
    elif (ran := _run(INSTALL, folder)).returncode:
        pytest.skip(f"npm cannot install: {ran.stderr.strip()[-200:]}")
    return folder


def test_its_types_fit_and_its_tests_pass(extension: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_COMMAND", json.dumps([sys.executable, "-P", "-m", "mjcompose"]))
    for script in ("check", "test"):
        ran = _run(["npm", "run", "--silent", script], extension)
        assert ran.returncode == 0, ran.stdout + ran.stderr


def test_the_package_has_the_bundle_and_the_licenses_of_what_is_in_it(extension: Path) -> None:
    ran = _run(["npm", "run", "--silent", "package"], extension)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    (package,) = extension.glob("*.vsix")
    with zipfile.ZipFile(package) as archive:
        names = {name.removeprefix("extension/") for name in archive.namelist()}
        notice = archive.read("extension/dist/NOTICE").decode()
        license = archive.read("extension/LICENSE.txt").decode()
    assert names == {
        "[Content_Types].xml",
        "extension.vsixmanifest",
        "package.json",
        "readme.md",
        "changelog.md",
        "LICENSE.txt",
        "icon.png",
        "picture.png",
        "language-configuration.json",
        "syntaxes/recipe.tmLanguage.json",
        "dist/extension.js",
        "dist/bridge.js",
        "dist/NOTICE",
    }
    assert license == (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "\nvscode-languageclient 11.0.0, MIT\n" in notice and "\nsemver " in notice


def test_its_version_has_an_entry_in_the_changes() -> None:
    about = json.loads((EXTENSION / "package.json").read_text(encoding="utf-8"))
    assert f"\n## {about['version']}\n" in (EXTENSION / "CHANGELOG.md").read_text(encoding="utf-8")


def _run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=300, check=False)

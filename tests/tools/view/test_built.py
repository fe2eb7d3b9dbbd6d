"""The page that the package carries is the one that its sources give."""

from __future__ import annotations

import lzma
import shutil
import subprocess
from pathlib import Path

import pytest

COMPOSER = Path(__file__).parents[3] / "composer"
PAGE = COMPOSER / "viewer"
NPM_LOCK = COMPOSER.parent / "build" / "npm" / "installed.json"
"""The lock of what `.ci/page` has installed beside it."""
BUILT = COMPOSER / "mjcompose" / "tools" / "view" / "built"
INSTALL = ["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"]


@pytest.mark.slow
def test_the_page_is_built_from_its_sources(tmp_path: Path) -> None:
    if shutil.which("npm") is None:
        pytest.skip("there is no npm")
    page = tmp_path / "page"
    shutil.copytree(PAGE, page, ignore=shutil.ignore_patterns("node_modules"))
    if (PAGE / "node_modules").is_dir():
        (page / "node_modules").symlink_to(PAGE / "node_modules")
    elif NPM_LOCK.exists() and NPM_LOCK.read_bytes() == (PAGE / "package-lock.json").read_bytes():
        (page / "node_modules").symlink_to(NPM_LOCK.parent / "node_modules")
    elif (ran := _run(INSTALL, page)).returncode:
        pytest.skip(f"npm cannot install: {ran.stderr.strip()[-200:]}")
    for script in ("check", "build"):
        ran = _run(["npm", "run", "--silent", script], page)
        assert ran.returncode == 0, ran.stdout + ran.stderr
    for name in ("page.js", "physics.js", "page.css"):
        same = (tmp_path / "mjcompose" / "tools" / "view" / "built" / name).read_bytes() == (BUILT / name).read_bytes()
        assert same, f"{name} is not what the sources give: `npm ci && npm run build` in composer/viewer"
    engine = page / "node_modules" / "@mujoco" / "mujoco" / "mujoco.wasm"
    packed = (BUILT / "mujoco.wasm.xz").read_bytes()
    assert lzma.decompress(packed) == engine.read_bytes(), (
        "`xz -9e` of mujoco.wasm into composer/mjcompose/tools/view/built"
    )


def _run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=300, check=False)

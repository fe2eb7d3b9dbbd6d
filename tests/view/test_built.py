"""The page that the package carries is the one that its sources give."""

from __future__ import annotations

import lzma
import shutil
import subprocess
from pathlib import Path

import pytest

VIEW = Path(__file__).parents[2] / "composer" / "view"
INSTALL = ["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"]


@pytest.mark.slow
def test_the_page_is_built_from_its_sources(tmp_path: Path) -> None:
    if shutil.which("npm") is None:
        pytest.skip("there is no npm")
    page = tmp_path / "page"
    shutil.copytree(VIEW / "page", page, ignore=shutil.ignore_patterns("node_modules"))
    if (VIEW / "page" / "node_modules").is_dir():
        (page / "node_modules").symlink_to(VIEW / "page" / "node_modules")
    elif (ran := _run(INSTALL, page)).returncode:
        pytest.skip(f"npm cannot install: {ran.stderr.strip()[-200:]}")
    for script in ("check", "build"):
        ran = _run(["npm", "run", "--silent", script], page)
        assert ran.returncode == 0, ran.stdout + ran.stderr
    for name in ("page.js", "physics.js", "page.css"):
        same = (tmp_path / "built" / name).read_bytes() == (VIEW / "built" / name).read_bytes()
        assert same, f"{name} is not what the sources give: `npm ci && npm run build` in composer/view/page"
    engine = page / "node_modules" / "@mujoco" / "mujoco" / "mujoco.wasm"
    packed = (VIEW / "built" / "mujoco.wasm.xz").read_bytes()
    assert lzma.decompress(packed) == engine.read_bytes(), "`xz -9e` of mujoco.wasm into composer/view/built"


def _run(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=300, check=False)

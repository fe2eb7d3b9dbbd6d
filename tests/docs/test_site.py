"""The site of the docs: all pages are on it, and all links lead somewhere."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
BESIDE = {"errors", "examples", "pictures", "live"}


def _pages(nav: object) -> list[str]:
    if isinstance(nav, str):
        return [nav]
    inner = nav.values() if isinstance(nav, dict) else nav
    return [page for each in inner for page in _pages(each)]  # type: ignore[attr-defined]


def test_every_page_is_in_the_menu() -> None:
    menu = _pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"])
    ours = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert {page for page in ours if page.partition("/")[0] not in BESIDE} <= set(menu)
    made = {"errors/index.md"}
    assert all(page in ours | made or (ROOT / page).is_file() for page in menu)
    assert len(menu) == len(set(menu))


@pytest.mark.slow
def test_links_lead_somewhere_on_the_site() -> None:
    made = subprocess.run(
        [sys.executable, ".ci/site", "--pages"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert made.returncode == 0, made.stderr
    assert (ROOT / "build" / "site_pages" / "live" / "demo.html").is_file()
    assert "--variant" in (ROOT / "build" / "site_pages" / "commands.md").read_text(encoding="utf-8")
    assert "::: composer.mjcf.from_path" in (ROOT / "build" / "site_pages" / "api.md").read_text(
        encoding="utf-8"
    )
    assert "asset-missing" in (ROOT / "build" / "site_pages" / "errors" / "index.md").read_text(
        encoding="utf-8"
    )

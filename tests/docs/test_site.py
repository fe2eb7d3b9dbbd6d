"""The site of the docs: all pages are on it, and all links lead somewhere."""

from __future__ import annotations

import json
import shutil
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
        [sys.executable, ".ci/site", "--pages"], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert made.returncode == 0, made.stderr
    assert (ROOT / "build" / "site_pages" / "live" / "demo.html").is_file()
    assert "--set" in (ROOT / "build" / "site_pages" / "reference" / "commands.md").read_text(encoding="utf-8")
    assert "::: mjcompose.mjcf.from_path" in (ROOT / "build" / "site_pages" / "reference" / "api.md").read_text(
        encoding="utf-8"
    )
    assert "asset-missing" in (ROOT / "build" / "site_pages" / "errors" / "index.md").read_text(encoding="utf-8")


def test_each_release_has_its_pages_beside_the_latest(tmp_path: Path) -> None:
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "versions", tmp_path / ".ci")
    build = tmp_path / "build"
    for folder, text in {"site": "now", "mjcompose-docs-v0.2.0": "two", "mjcompose-docs-v0.10.0": "ten"}.items():
        (build / folder).mkdir(parents=True)
        (build / folder / "index.html").write_text(f'{text} {{"version":null}}', encoding="utf-8")
    for tag in ("v0.2.0", "v0.10.0"):
        packed = build / "releases" / tag / "dist-docs"
        shutil.make_archive(str(packed), "zip", build, f"mjcompose-docs-{tag}")
    subprocess.run([sys.executable, ".ci/versions"], cwd=tmp_path, check=True, timeout=60)
    listed = json.loads((build / "pages" / "versions.json").read_text(encoding="utf-8"))
    assert [each["version"] for each in listed] == ["latest", "v0.10.0", "v0.2.0"]
    pages = [build / "pages" / each["version"] / "index.html" for each in listed]
    assert [page.read_text(encoding="utf-8").split()[0] for page in pages] == ["now", "ten", "two"]
    assert all('"provider":"mike"' in page.read_text(encoding="utf-8") for page in pages)

"""The site of the docs: all pages are on it, all links lead somewhere, and its search finds the words that people type."""

from __future__ import annotations

import functools
import http.server
import json
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml
from chromium import NoBrowser, started

ROOT = Path(__file__).resolve().parents[2]
BESIDE = {"rules", "errors", "examples", "pictures", "live"}
TYPED = (
    "domain randomization",
    "combine robots",
    "quickstart",
    "headless",
    "namespace",
    "end effector",
    "Isaac Lab",
    "sim-to-real",
    "macOS",
    "troubleshooting",
)
BEGINNERS = ("macOS", "Windows", "quickstart", "headless", "EGL", "pip install")
"""The page on the installation has these words."""
ASKED = {
    "gripper falls apart": "how-to/troubleshooting.html",
    "wrong units": "how-to/troubleshooting.html",
    "rename prefix": "how-to/combine.html",
    "freeze versions": "reference/sources.html",
    "train with isaac lab": "how-to/simulators.html",
    "weld two robots": "how-to/combine.html",
    "calibration": "how-to/actuators.html",
    "terrain": "how-to/combine.html",
    "position servo": "how-to/actuators.html",
    "friction randomization": "how-to/randomize.html",
    "weld": "how-to/combine.html",
    "rename": "how-to/combine.html",
    "units": "explanation/composition.html",
    "freeze": "reference/sources.html",
}
"""Questions that people type into the search, each with the page that answers it."""
FIRST_RESULTS = 3
_RESULTS = """query => {
    const links = []
    const walk = root => {
        links.push(...root.querySelectorAll("a[href]"))
        for (const element of root.querySelectorAll("*")) if (element.shadowRoot) walk(element.shadowRoot)
    }
    for (const element of document.querySelectorAll("*")) if (element.shadowRoot) walk(element.shadowRoot)
    const shown = links.map(link => new URL(link.href)).filter(url => url.searchParams.get("h") === query)
    return [...new Set(shown.map(url => url.pathname.slice(1) + url.hash))]
}"""
"""The results of a query, which the links name."""
_FOCUSED = """() => {
    let focused = document.activeElement
    while (focused?.shadowRoot?.activeElement) focused = focused.shadowRoot.activeElement
    return focused?.tagName === "INPUT"
}"""
FIRST_WORDS = 60
"""A page counts as found if the words are in its path of headings or near the beginning of a section."""


def _pages(nav: object) -> list[str]:
    if isinstance(nav, str):
        return [nav]
    inner = nav.values() if isinstance(nav, dict) else nav
    return [page for each in inner for page in _pages(each)]  # type: ignore[attr-defined]


def _entries(nav: list[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    for each in nav:
        for words, inner in each.items():
            yield from [(words, inner)] if isinstance(inner, str) else _entries(inner)


def test_every_page_is_in_the_menu() -> None:
    menu = _pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"])
    ours = {path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")}
    assert {page for page in ours if page.partition("/")[0] not in BESIDE} <= set(menu)
    made = {"errors/index.md"}
    assert all(page in ours | made or (ROOT / page).is_file() for page in menu)
    assert len(menu) == len(set(menu))


def test_the_menu_has_the_headings_of_the_pages() -> None:
    menu = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]
    other = []
    for words, page in _entries(menu):
        path = next((each for each in (ROOT / "docs" / page, ROOT / page) if each.is_file()), None)
        if path is not None:
            text = re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
            (heading,) = re.findall(r"^# (.*)$", text, re.MULTILINE)
            if heading.replace("`", "") != words:
                other.append(f"{page}: {words} | {heading}")
    assert not other


def _found(site: Path) -> dict[str, list[str]]:
    """What the site's own search shows in a browser for each question. Raises `NoBrowser`."""
    with started() as browser, _served(site) as address:
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        return {query: _results(page, address, query) for query in ASKED}


def _results(page: Any, address: str, query: str) -> list[str]:
    """What the search shows on a fresh page, when it no longer changes; nothing, if nothing comes for 20 seconds."""
    page.goto(f"{address}/index.html")
    page.wait_for_load_state("networkidle")
    page.locator(".md-search__button").first.click()
    page.wait_for_function(_FOCUSED, timeout=20_000)
    page.keyboard.insert_text(query)
    shown: list[str] = []
    for _ in range(80):
        before = shown
        page.wait_for_timeout(250)
        shown = page.evaluate(_RESULTS, query)
        if shown and shown == before:
            break
    return shown


def _among(answer: str, results: list[str]) -> bool:
    return any(result.partition("#")[0] == answer for result in results[:FIRST_RESULTS])


@contextmanager
def _served(site: Path) -> Iterator[str]:
    """The site on this machine, by HTTP."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *arguments: Any) -> None:
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


@pytest.mark.slow
def test_links_lead_somewhere_and_search_finds_the_words_that_people_type() -> None:
    made = subprocess.run(
        [sys.executable, ".ci/site", "--pages"], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert made.returncode == 0, made.stderr
    assert (ROOT / "build" / "site_pages" / "live" / "demo.html").is_file()
    assert "--set" in (ROOT / "build" / "site_pages" / "reference" / "commands.md").read_text(encoding="utf-8")
    assert "::: mjcompose.mjcf.from_path" in (ROOT / "build" / "site_pages" / "reference" / "mjcf.md").read_text(
        encoding="utf-8"
    )
    llms = (ROOT / "build" / "site_pages" / "llms.txt").read_text(encoding="utf-8")
    assert llms.startswith("# mjcompose\n\n> ") and "\n## How to\n" in llms
    line = next(each for each in llms.splitlines() if "(how-to/split.html)" in each)
    assert line.startswith(
        "- [Split a merged XML into its parts](how-to/split.html): `mjcompose import` finds the models"
    )
    menu = _pages(yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"])
    assert llms.count("\n- [") == len(menu)
    errors = (ROOT / "build" / "site_pages" / "errors" / "index.md").read_text(encoding="utf-8")
    assert "## Sources and lock" in errors and "asset-missing" in errors
    index = json.loads(_search_index().read_text(encoding="utf-8"))
    entries = {entry["location"]: _words(entry) for entry in index["items"]}
    assert len(entries) > 300
    lost = [text for text in TYPED if not any(set(text.lower().split()) <= words for words in entries.values())]
    assert not lost, f"no page has these words in a heading or at the beginning of a section: {lost}"
    install = set[str]().union(*(words for place, words in entries.items() if place.startswith("install.html")))
    assert not [text for text in BEGINNERS if not set(text.lower().split()) <= install]
    try:
        results = _found(ROOT / "build" / "site")
    except NoBrowser as reason:
        pytest.skip(f"everything else holds, and nobody asked the site's search: {reason}")
    unanswered = {query: results[query] for query, answer in ASKED.items() if not _among(answer, results[query])}
    assert not unanswered, "the page that answers is not among the first results"


def _search_index() -> Path:
    """The index that the site's own search reads, in `build/site`; skips if the generator cannot be installed."""
    environment = ROOT / "build" / "docs"
    program = environment / ("Scripts" if sys.platform == "win32" else "bin") / "zensical"
    if not program.exists() and not program.with_suffix(".exe").exists():
        if not (environment / "pyvenv.cfg").exists():
            subprocess.run([sys.executable, "-m", "venv", environment], check=True, timeout=120)
        pip = [program.with_name("python"), "-m", "pip", "install", "--quiet", "zensical", "mkdocstrings-python"]
        made = subprocess.run(pip, capture_output=True, text=True, timeout=300, check=False)
        if made.returncode:
            pytest.skip(f"the pages are laid out, and zensical cannot be installed: {made.stderr[-200:]}")
    made = subprocess.run([program, "build"], cwd=ROOT, capture_output=True, text=True, timeout=300, check=False)
    assert made.returncode == 0, made.stdout + made.stderr
    return ROOT / "build" / "site" / "search.json"


def _words(entry: dict[str, Any]) -> set[str]:
    """The words of an entry's headings and of the beginning of its text."""
    text = re.sub(r"<[^>]+>", " ", entry["text"]).split()[:FIRST_WORDS]
    return set(re.findall(r"[\w-]+", " ".join([*entry["path"], entry["title"], *text]).lower()))


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

"""The page of a fit: what it says, that no name can be more than text, and how it looks in a browser."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from chromium import NoBrowser, started
from mjcompose.tools.identify.page import page_of

HOSTILE = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)>&amp;</style>"


def number(name: str = "elbow", **changes: Any) -> dict[str, Any]:
    plain = {"kind": "joint", "names": [name], "attribute": "damping", "recipe": 0.5, "range": [0.0, 5.0]}
    return {**plain, "value": 0.9012, "std": 0.01, "verdict": "", "reason": "", **changes}


def error(name: str = "qpos elbow", held_out: float | None = 2.1e-4, correlated: float = 1.0) -> dict[str, Any]:
    held = {} if held_out is None else {"recipe": 8e-3, "fitted": held_out}
    return {"signal": name, "recipe": 1e-2, "fitted": 2e-4, "correlated": correlated, "held_out": held}


def curve(signal: str = "qpos elbow", file: str = "run1.csv", used: str = "fit") -> dict[str, Any]:
    times = [0.01 * step for step in range(100)]
    recorded = [0.3 * math.sin(3 * time) for time in times]
    part = {"times": times, "recorded": recorded, "recipe": [1.1 * value for value in recorded], "fitted": recorded}
    return {"file": file, "signal": signal, "unit": "rad", "seconds": 0.99, "parts": [part], "used": used}


def data(**changes: Any) -> dict[str, Any]:
    run = {"file": "run1.csv", "sha256": "0" * 64, "seconds": 1.0, "samples": 100}
    whole = {
        "numbers": [number(), number("wrist")],
        "correlation": [[1.0, -0.93], [-0.93, 1.0]],
        "errors": [error()],
        "recordings": [run],
        "held_out": [{**run, "file": "run2.csv"}],
        "window": None,
        "simulated_steps": 1234,
    }
    return {**whole, **changes}


def page(*curves: dict[str, Any], name: str = "A12", recipe: str = "fit.yaml", **changes: Any) -> str:
    return page_of(name, recipe, data(**changes), curves or (curve(), curve(file="run2.csv", used="held out")))


def plain(text: str) -> str:
    """Return the words of a page."""
    body = text.partition("</style>")[2]
    return " ".join(re.sub(r"<[^>]*>", " ", body).split())


def test_a_good_fit() -> None:
    words = plain(page())
    assert words.index("The fitted model follows the robot.") < words.index("Motion") < words.index("Numbers", 10)
    assert "2 of 2 numbers are measured." in words
    assert "The errors for what was held out are 38 times smaller than with the recipe (median of 1 signal)." in words
    assert "1 joint elbow: damping 0.9012 ± 0.0196 0.5 0 … 5 measured confused with 2 (-93 %)" in words
    assert "qpos elbow 0.01 0.0002 0.008 0.00021 1" in words


@pytest.mark.parametrize(
    ("errors", "verdict", "code"),
    [
        ([error(held_out=1.2e-2)], "Do not use these numbers yet.", "error[worse-than-recipe]"),
        ([error(held_out=1e-3)], "Use these numbers with care.", "warning[held-out]"),
        ([error(correlated=22.0)], "Use these numbers with care.", "warning[errors-not-noise]"),
    ],
)
def test_a_fit_that_something_is_wrong_with(errors: list[dict[str, Any]], verdict: str, code: str) -> None:
    words = plain(page(errors=errors))
    assert verdict in words and code in words
    assert "follows the robot" not in words


def test_numbers_that_are_not_known() -> None:
    reason = "only together with joint elbow: damping (correlation -0.930)"
    words = plain(page(numbers=[number(), number("wrist", verdict="not_identified", reason=reason)]))
    assert "1 of 2 numbers is measured. Not identified: 2 ." in words
    assert f"not identified : {reason}" in words


def test_nothing_held_out_is_said() -> None:
    words = plain(page(curve(), errors=[error(held_out=None)], held_out=[]))
    assert "There is no held-out recording" in words
    assert "qpos elbow 0.01 0.0002 – – 1" in words


def test_a_model_that_falls_over_does_not_hide_the_recording() -> None:
    wild = curve()
    wild["parts"][0]["recipe"][50:] = [1e9] * 25 + [None] * 25
    shown = page(wild)
    assert "0.345 rad" in shown and "<span>0.99 rad<" in shown, "three times what was recorded"
    paths = re.findall(r'<path class=recipe d="([^"]*)"', shown)
    numbers = [abs(int(word)) for path in paths for word in re.findall(r"-?\d+", path)]
    assert max(numbers) <= 2000


def test_a_signal_that_never_moves_and_one_number() -> None:
    still = curve()
    for word in ("recorded", "recipe", "fitted"):
        still["parts"][0][word] = [0.0] * 100
    shown = page(still, numbers=[number()], correlation=[[1.0]])
    assert "nan" not in shown and "inf" not in shown
    assert "There is only one number." in shown


def hostile_page() -> str:
    numbers = [number(HOSTILE), number("wrist", verdict="not_identified", reason=HOSTILE)]
    run = {"file": HOSTILE, "sha256": "0" * 64, "seconds": 1.0, "samples": 100}
    curves = (curve(f"qpos {HOSTILE}", HOSTILE), curve(f"qpos {HOSTILE}", HOSTILE, "held out"))
    return page(
        *curves,
        name=HOSTILE,
        recipe=HOSTILE,
        numbers=numbers,
        errors=[error(f"qpos {HOSTILE}", held_out=1.2e-2, correlated=22.0)],
        recordings=[run],
        held_out=[run],
    )


def test_names_are_text() -> None:
    shown = hostile_page()
    assert "<script" not in shown and "<img" not in shown and shown.count("</style>") == 1
    assert shown.count("&lt;script&gt;alert(1)&lt;/script&gt;&quot;&#x27;&gt;") > 10
    assert "\x1b" not in page(name="a\x1b[31mb") and "\u202e" not in page(name="a\u202eb")


def many() -> str:
    """A page as large as that of an arm: 18 numbers with long names, 6 joints."""
    joints = [f"left_arm/shoulder_and_elbow_link_{index}" for index in range(6)]
    numbers = [
        number(name, attribute=attribute) for name in joints for attribute in ("frictionloss", "damping", "armature")
    ]
    correlation = [[1.0 if row == column else (-1) ** row * 0.9 for column in range(18)] for row in range(18)]
    curves = [
        curve(f"qpos {name}", file, used)
        for name in joints
        for file, used in (("recordings/2026-11-28/run1.csv", "fit"), ("recordings/2026-11-28/run2.csv", "held out"))
    ]
    return page(*curves, numbers=numbers, correlation=correlation, errors=[error(f"qpos {name}") for name in joints])


def test_a_page_is_small() -> None:
    assert len(many()) < 150_000


# ------------------------------------------------------------------------------------------------------- in a browser


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    try:
        with started() as browser:
            yield browser
    except NoBrowser as reason:
        pytest.skip(str(reason))


OVERLAPS = """() => {
  const boxes = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    if (!node.textContent.trim() || node.parentElement.closest('style,script,title')) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const box of range.getClientRects())
      if (box.width > 1 && box.height > 1) boxes.push([node.textContent.trim(), box]);
  }
  const found = [];
  for (let one = 0; one < boxes.length; one++)
    for (let other = one + 1; other < boxes.length; other++) {
      const [a, b] = [boxes[one][1], boxes[other][1]];
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (across > 1 && down > 3) found.push(`${boxes[one][0]} | ${boxes[other][0]}`);
    }
  return found;
}"""
OUTSIDE = """() => [...document.querySelectorAll('body *')].filter((element) =>
  !element.closest('.wide') && element.getBoundingClientRect().right > innerWidth + 1).map((element) => element.outerHTML.slice(0, 80))"""
CONTRASTS = """() => {
  const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  const light = (color) => {
    canvas.fillStyle = color;
    canvas.fillRect(0, 0, 1, 1);
    const part = [...canvas.getImageData(0, 0, 1, 1).data].slice(0, 3).map((value) => {
      const share = value / 255;
      return share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
    });
    return 0.2126 * part[0] + 0.7152 * part[1] + 0.0722 * part[2];
  };
  const ground = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const color = getComputedStyle(at).backgroundColor;
      if (!color.endsWith(', 0)')) return color;
    }
    return 'white';
  };
  const found = [];
  for (const element of document.querySelectorAll('body *')) {
    const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!own || !element.getClientRects().length) continue;
    const [a, b] = [light(getComputedStyle(element).color), light(ground(element))].sort();
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (contrast < 4.5) found.push(`${element.textContent.slice(0, 40)}: ${contrast.toFixed(2)}`);
  }
  return found;
}"""


@pytest.mark.slow
@pytest.mark.parametrize("width", [340, 700, 1200])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_page_in_a_browser(browser: Any, tmp_path: Path, width: int, scheme: str) -> None:
    file = tmp_path / "page.html"
    file.write_text(many(), encoding="utf-8")
    with browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme) as shown:
        asked: list[str] = []
        said: list[str] = []
        shown.on("request", lambda request: asked.append(request.url))
        shown.on("console", lambda message: said.append(message.text))
        shown.goto(file.as_uri())
        assert asked == [file.as_uri()] and said == []
        assert shown.evaluate("document.documentElement.scrollWidth") <= width
        assert shown.evaluate(OVERLAPS) == []
        assert shown.evaluate(OUTSIDE) == []
        assert shown.evaluate(CONTRASTS) == []
        size = (
            "Math.min(...[...document.querySelectorAll('body *')].map((e) => parseFloat(getComputedStyle(e).fontSize)))"
        )
        assert shown.evaluate(size) >= 11


@pytest.mark.slow
def test_hostile_names_in_a_browser(browser: Any, tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    file.write_text(hostile_page(), encoding="utf-8")
    with browser.new_page() as shown:
        asked: list[str] = []
        told: list[str] = []
        shown.on("request", lambda request: asked.append(request.url))
        shown.on("dialog", lambda dialog: (told.append(dialog.message), dialog.dismiss()))
        shown.goto(file.as_uri())
        assert (asked, told) == ([file.as_uri()], [])
        assert shown.locator("h1").inner_text() == HOSTILE
        assert shown.locator("script, img").count() == 0

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from composer.diagnostics.codes import CODES
from composer.diagnostics.page import code_of, in_terminal, page

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("code", CODES)
def test_every_page_can_be_read_in_a_terminal(code: str) -> None:
    shown = in_terminal(page(code), 80)
    assert shown.startswith(f"{code}\n\n")
    assert "```" not in shown and not re.search(r"\]\(\w[\w./#-]*\.md", shown)
    outside = re.compile(r"^#+ |^\|[-|]+$", re.MULTILINE)
    row = re.compile(r"^\|.*\|$", re.MULTILINE)
    link = re.compile(r"\[([^]]+)\]\([^)]+\.md[^)]*\)")
    pieces = re.split(r"^```\w*$", page(code), flags=re.MULTILINE)  # every second one is code
    words = " ".join(
        link.sub(r"\1", row.sub(_cells, outside.sub(" ", text))) if n % 2 == 0 else text
        for n, text in enumerate(pieces)
    )
    assert shown.split() == words.split()


def _cells(row: re.Match[str]) -> str:
    return row[0].replace("|", " ")


def test_code_stays_on_its_line_and_may_be_pasted() -> None:
    shown = in_terminal("# a\n\n- one `x: {y: z}` two\n- three\n\n```yaml\n- a:  1\n\n  b\n```\n", 8)
    assert shown.splitlines() == [
        "a",
        "",
        "- one",
        "  `x: {y: z}`",
        "  two",
        "- three",
        "",
        "    - a:  1",
        "",
        "      b",
    ]


def test_colors() -> None:
    assert in_terminal("# a\n\n`b`\n", color=True) == "\x1b[1ma\x1b[0m\n\n\x1b[36m`b`\x1b[0m"


def test_what_a_code_is() -> None:
    assert code_of("warning[usd-loss]:") == code_of("[usd-loss]") == "usd-loss"
    assert code_of("usd") is None and code_of("arm.yaml") is None and code_of("") is None


def test_the_pages_are_in_the_wheel() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert included["docs/errors"] == "composer/diagnostics/pages"

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest
from mjcompose.base.codes import BY_TOPIC, code_of, in_terminal, page

ROOT = Path(__file__).parents[2]
PAGES = {path.stem: path for path in (ROOT / "docs" / "errors").glob("*.md") if path.stem not in ("index", "README")}

CODES = dict(sorted((code, summary) for codes in BY_TOPIC.values() for code, summary in codes.items()))
"""Without the rules of the linter, which add theirs when they are imported."""


def test_codes_and_pages_agree() -> None:
    assert sorted(CODES) == sorted(PAGES)


def test_codes_are_sorted_slugs_with_a_summary_of_one_line() -> None:
    assert list(CODES) == sorted(CODES)
    for code, text in CODES.items():
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", code), code
        assert text and "\n" not in text and not text.endswith("."), code


@pytest.mark.parametrize("code", sorted(PAGES))
def test_page(code: str) -> None:
    text = PAGES[code].read_text(encoding="utf-8")
    assert text.startswith(f"# {code}\n")
    headings = re.findall(r"^## (.+)$", text, re.MULTILINE)
    assert headings == ["Example", "How to fix it"], "a page shows a case and says what to do"
    assert "```" in text.split("## Example")[1].split("## How to fix it")[0]
    assert len(text.split("## How to fix it")[1].strip()) > 40
    assert text.count("```") % 2 == 0
    assert len(text.splitlines()) <= 45


def test_codes_in_use_are_declared() -> None:
    """Every literal code that the package gives to a sink or a diagnostic is in the list."""
    used = set()
    for path in (ROOT / "composer" / "mjcompose").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
                name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                code = node.args[0].value
                takes_code = name in ("error", "warning", "note", "Diagnostic", "Fault", "fault")
                if (takes_code or name.endswith("Error")) and re.fullmatch(r"[a-z]+(-[a-z0-9]+)+", str(code)):
                    used.add(code)
    assert used - set(CODES) == set()
    assert {"yaml-tag", "yaml-alias-bomb"} <= used


PAGE_ROOT = Path(__file__).resolve().parents[2]


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
    project = tomllib.loads((PAGE_ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    included = project["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    assert included["docs/errors"] == "mjcompose/base/pages/errors"
    assert included["docs/rules"] == "mjcompose/base/pages/rules"

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from composer.diagnostics import CODES

ROOT = Path(__file__).parents[2]
PAGES = {
    path.stem: path
    for path in (ROOT / "docs" / "errors").glob("*.md")
    if path.stem not in ("index", "README")
}


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
    for path in (ROOT / "composer").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
                name = (
                    node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                )
                code = node.args[0].value
                takes_code = name in ("error", "warning", "note", "Diagnostic", "Fault", "fault")
                if (takes_code or name.endswith("Error")) and re.fullmatch(r"[a-z]+(-[a-z0-9]+)+", str(code)):
                    used.add(code)
    assert used - set(CODES) == set()
    assert {"yaml-tag", "yaml-alias-bomb"} <= used

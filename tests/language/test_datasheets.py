"""The table in `docs/how-to/actuators.md` is that of the library."""

from __future__ import annotations

import runpy
from pathlib import Path

from mjcompose.language.datasheets import library

ROOT = Path(__file__).parents[2]


def test_the_page_has_the_table() -> None:
    page = (ROOT / "docs" / "how-to" / "actuators.md").read_text(encoding="utf-8")
    writer = runpy.run_path(str(ROOT / ".ci" / "datasheet_table.py"))
    assert writer["with_table"](page) == page, "`make schemas` writes it"
    assert writer["table"]() in page
    assert all(f"| `{name}` |" in page for name in library())

"""The table in `docs/how-to/simulators.md` is that of the targets."""

from __future__ import annotations

from mjcompose.language.target_names import NAMES
from mjcompose.targets.table import PAGE, features, read_back, with_tables


def test_the_page_has_the_table() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert with_tables(page) == page, "`make schemas` writes it"
    assert features() in page and read_back() in page
    assert all(f"`{name}`" in page for name in NAMES)

"""The table in `docs/how-to/actuators.md` is that of the library."""

from __future__ import annotations

from mjcompose.language.datasheets import PAGE, library, table, with_table


def test_the_page_has_the_table() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert with_table(page) == page, "`make schemas` writes it"
    assert table() in page
    assert all(f"| `{name}` |" in page for name in library())

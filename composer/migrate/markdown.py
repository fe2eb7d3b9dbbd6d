"""The table of changes in `docs/migrate.md`; run as a program, it writes it there."""

from __future__ import annotations

import re
from pathlib import Path

from composer.migrate.change import Change
from composer.migrate.changes import ORDERED

PAGE = Path(__file__).resolve().parents[2] / "docs" / "migrate.md"
_TABLE = re.compile(r"(?<=<!-- changes -->\n).*?(?=<!-- end of changes -->)", re.DOTALL)


def table() -> str:
    """A row for each change."""
    lines = [
        "| since | change | of | before | now | what becomes of a model | back |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {each.version.removesuffix('.0')} | `{each.name}` | {each.of} | {each.was} | {each.now} | {each.becomes}"
        f" | {_back(each)} |"
        for each in ORDERED
    ]
    return "\n".join(lines) + "\n"


def _back(change: Change) -> str:
    return "yes" if change.backward is not None else "–"


def with_table(page: str) -> str:
    """The text of the page with the table as it is now."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")

"""Write a table as CSV, and read its texts back.

A spreadsheet takes a text that begins with `=` for a formula, and runs it. So such a text, which may come from somebody
else's recipe, is written with a `'` before it, and so is one that begins with `'` itself. Numbers stay as they are.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from typing import Any, TextIO

_FORMULA = tuple("=+-@\t\r\n＝＋－＠'")


def write_rows(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a header and rows; numbers as the shortest text that reads back the same, nothing for None."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(map(guarded, columns))
    for row in rows:
        writer.writerow([_text(each) for each in row])


def guarded(text: str) -> str:
    """Return a text as a table has it: no spreadsheet takes it for a formula.

    >>> guarded("=1+1"), guarded("arm"), guarded("'arm'"), guarded("-0.5")
    ("'=1+1", 'arm', "''arm'", '-0.5')
    """
    return f"'{text}" if text.startswith(_FORMULA) and not _is_number(text) else text


def unguarded(text: str) -> str:
    """Return the text that a table has.

    >>> all(unguarded(guarded(each)) == each for each in ("=1+1", "arm", "'arm'", "''", "-0.5", ""))
    True
    """
    return text.removeprefix("'")


def _is_number(text: str) -> bool:
    try:
        return float(text) is not None and text.isascii() and text == text.strip()
    except ValueError:
        return False


def _text(value: Any) -> Any:
    if isinstance(value, bool):
        return str(value).lower()
    return "" if value is None else guarded(value) if isinstance(value, str) else value

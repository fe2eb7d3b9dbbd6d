"""Write a table as CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from typing import Any, TextIO


def write_rows(file: TextIO, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write a header and rows; numbers as the shortest text that reads back the same, nothing for None."""
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(map(_written, rows))


def _written(row: Sequence[Any]) -> Sequence[Any]:
    """Return a row with words for truth values; `csv` writes numbers and None as they should be."""
    if bool in set(map(type, row)):
        return [str(each).lower() if isinstance(each, bool) else each for each in row]
    return row

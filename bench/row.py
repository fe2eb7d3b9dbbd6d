"""One line of the table."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Row:
    """A ratio of ours to a peer's, less being better, and what it may be; None where it was not measured."""

    name: str
    ratio: float | None
    limit: float | None
    note: str = ""

    @property
    def ok(self) -> bool | None:
        """Whether it is within the limit; None where there is nothing to judge."""
        if self.ratio is None or self.limit is None:
            return None
        return self.ratio <= self.limit


def table(rows: list[Row]) -> str:
    """The rows as aligned text, a header first."""
    cells = [("", "ratio", "limit", "ok", "")]
    for row in rows:
        ratio = "-" if row.ratio is None else f"{row.ratio:.2f}"
        limit = "-" if row.limit is None else f"{row.limit:.2f}"
        cells.append((row.name, ratio, limit, {True: "yes", False: "NO", None: ""}[row.ok], row.note))
    widths = [max(len(line[at]) for line in cells) for at in range(4)]
    return "\n".join(
        f"{name:{widths[0]}}  {ratio:>{widths[1]}}  {limit:>{widths[2]}}  {ok:{widths[3]}}  {note}".rstrip()
        for name, ratio, limit, ok, note in cells
    )

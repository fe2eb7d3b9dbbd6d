"""The table of `docs/contributing/fidelity.md`: one row a set, one column for each who composes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import mujoco
from fidelity import dmcontrol
from fidelity.judging import Verdict
from fidelity.roundtrip import Trip

BEGIN = "<!-- fidelity: begin -->"
END = "<!-- fidelity: end -->"


@dataclass(frozen=True)
class Row:
    """How many of a set each of the three leaves as they are; None where it was not asked."""

    title: str
    size: int
    ours: int
    mjspec: int | None = None
    dm_control: int | None = None


def of_compositions(title: str, verdicts: Sequence[Verdict]) -> Iterator[Row]:
    """A row of what can be composed, and one of what must be refused."""
    there = dmcontrol.version() is not None
    wanted = [verdict for verdict in verdicts if not verdict.refused]
    refused = [verdict for verdict in verdicts if verdict.refused]
    yield Row(
        title,
        len(wanted),
        sum(verdict.unchanged and not verdict.error for verdict in wanted),
        _right([verdict.rival for verdict in wanted]),
        _right([verdict.dm_control for verdict in wanted]) if there else None,
    )
    if refused:
        yield Row(f"{title}: to be refused, and refused", len(refused), sum(v.fine for v in refused))


def _right(verdicts: Sequence[str]) -> int | None:
    return verdicts.count("right") if any(verdicts) else None


def of_trips(title: str, trips: Sequence[Trip]) -> Row:
    """The files that MuJoCo loads."""
    loaded = [trip for trip in trips if trip.loads]
    return Row(
        title,
        len(loaded),
        sum(trip.fine for trip in loaded),
        sum(trip.mjspec for trip in loaded),
        sum(trip.dm_control for trip in loaded) if dmcontrol.version() is not None else None,
    )


def together(rows: Iterable[Row]) -> list[Row]:
    """Without the sets that nothing is in."""
    return [row for row in rows if row.size]


def text(rows: Sequence[Row]) -> str:
    """The table as Markdown, under a line with the versions that were compared."""
    dm_control = dmcontrol.version()
    versions = f"MuJoCo {mujoco.__version__}" + (f", dm_control {dm_control}" if dm_control else "")
    return "\n".join(
        [
            f"{versions}; models that stay the same:",
            "",
            "| set | size | mjcompose | `MjSpec` | `dm_control.mjcf` |",
            "|---|---|---|---|---|",
            *(
                f"| {row.title} | {row.size} | {_share(row.ours, row.size)} | {_share(row.mjspec, row.size)} "
                f"| {_share(row.dm_control, row.size)} |"
                for row in rows
            ),
        ]
    )


def _share(number: int | None, size: int) -> str:
    if number is None:
        return "–"
    return f"{number} ({_percent(number, size)})"


def _percent(number: int, size: int) -> str:
    """Rounded down: 100 % is all of them."""
    return f"{100 * number // size} %"


def between_markers(page: str, text: str, begin: str = BEGIN, end: str = END) -> str:
    """The page with what is between two markers replaced."""
    before, found, rest = page.partition(begin)
    _, found_end, after = rest.partition(end)
    if not found or not found_end:
        raise ValueError(f"the page has no `{begin}` … `{end}`")
    return f"{before}{begin}\n{text}\n{end}{after}"

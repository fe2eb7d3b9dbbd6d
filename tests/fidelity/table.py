"""What came of many compositions or round trips, as lines on a terminal and as a page."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fidelity.judging import Verdict
from fidelity.roundtrip import Trip

HEAD = ("composition", "built", "compiles", "parts unchanged", "as MjSpec", "first differences")
TRIP_HEAD = ("file", "same", "what differs")
_LONGEST = 300


def cells(verdict: Verdict) -> tuple[str, ...]:
    """One row: the columns of `HEAD`."""
    if verdict.refused:
        told = _first_error(verdict.diagnostics) if verdict.fine else "; ".join(verdict.first_differences)
        return verdict.id, "refused" if not verdict.built else "yes", "-", "-", "-", _short(told)
    rival = _yes(verdict.like_rival) if verdict.compiled else "-"
    if verdict.compiled and verdict.rival not in ("", "right"):
        rival = f"{rival} (MjSpec {verdict.rival})"
    return (
        verdict.id,
        _yes(verdict.built),
        _yes(verdict.compiled),
        _yes(verdict.unchanged) if verdict.compiled else "-",
        rival,
        _short("; ".join(verdict.first_differences)),
    )


def totals(verdicts: Sequence[Verdict]) -> list[str]:
    """The sums that a run ends with."""
    wanted = [verdict for verdict in verdicts if not verdict.refused]
    refused = [verdict for verdict in verdicts if verdict.refused]
    rivals = [v for v in wanted if not v.rival.startswith("fails")]
    ours = ", ".join(
        (
            f"built {_of(v.built for v in wanted)}",
            f"compile {_of(v.compiled for v in wanted)}",
            f"parts unchanged {_of(v.unchanged for v in wanted)}",
            f"as MjSpec {_of(v.like_rival for v in rivals)}",
        )
    )
    theirs = _of(v.rival == "right" for v in wanted)
    failed = len(wanted) - len(rivals)
    lines = [ours]
    if any(v.rival for v in wanted):
        lines.append(f"MjSpec itself: leaves the parts unchanged {theirs}, fails {failed}")
    if refused:
        lines.append(f"refused as they must be {_of(v.fine for v in refused)}")
    differing = [v for v in wanted if v.options]
    lines.append(f"options other than the base's alone: {len(differing)}")
    lines += [f"  {v.id}: {_short('; '.join(v.options))}" for v in differing]
    return lines


def trip_cells(trip: Trip) -> tuple[str, ...]:
    """One row: the columns of `TRIP_HEAD`."""
    same = _yes(trip.fine) if trip.loads else "MuJoCo does not load it"
    return trip.id, same, _short(trip.error or ", ".join(trip.different))


def trip_totals(trips: Sequence[Trip]) -> list[str]:
    loaded = [trip for trip in trips if trip.loads]
    same = _of(trip.fine for trip in loaded)
    return [f"the same after a round trip {same}; {len(trips) - len(loaded)} do not load"]


def markdown(title: str, head: Sequence[str], rows: Iterable[Sequence[str]], lines: Iterable[str]) -> str:
    """A page with one table."""
    body = [" | ".join(_escaped(cell) for cell in row) for row in rows]
    return "\n".join(
        [
            f"# {title}",
            "",
            f"| {' | '.join(head)} |",
            f"|{'---|' * len(head)}",
            *(f"| {row} |" for row in body),
            "",
            *(f"- {line.strip()}" for line in lines),
            "",
        ]
    )


def _yes(value: bool) -> str:
    return "yes" if value else "**no**"


def _of(values: Iterable[bool]) -> str:
    every = list(values)
    return f"{sum(every)} of {len(every)}"


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 1]}…"


def _first_error(diagnostics: str) -> str:
    return next((line for line in diagnostics.splitlines() if "error" in line), diagnostics)


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|")

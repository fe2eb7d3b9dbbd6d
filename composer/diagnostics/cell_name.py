"""The models of a recipe that a diagnostic is about, for commands that look at several."""

from __future__ import annotations

from collections.abc import Iterable

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class CellName:
    """A model of a recipe; `name` is its argument for `--pick`.

    `cell` is the cell of the matrix, None without a matrix. `sample` is its number, None if nothing is drawn.
    """

    name: str
    cell: str | None = None
    sample: int | None = None


def listed(cells: Iterable[CellName]) -> str:
    """Return all of them on one line; consecutive samples of one cell become a range.

    >>> listed([CellName("a-1kg", "a-1kg"), CellName("a-2kg", "a-2kg")])
    'a-1kg, a-2kg'
    >>> listed([CellName(f"a-s000{n}", None, n) for n in (0, 1, 2, 4)])
    'a-s0000 … a-s0002, a-s0004'
    """
    ranges: list[list[CellName]] = []
    for each in cells:
        if ranges and _follows(ranges[-1][-1], each):
            ranges[-1].append(each)
        else:
            ranges.append([each])
    return ", ".join(_named(each) for each in ranges)


def _follows(before: CellName, after: CellName) -> bool:
    return (
        before.cell == after.cell
        and before.sample is not None
        and after.sample is not None
        and after.sample == before.sample + 1
    )


def _named(cells: list[CellName]) -> str:
    names = [each.name for each in cells]
    return ", ".join(names) if len(names) < 3 else f"{names[0]} … {names[-1]}"

"""Pair unnamed elements by their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

T = TypeVar("T")


def paired(
    one: Sequence[T], other: Sequence[T], alike: Callable[[T, T], bool]
) -> Iterator[tuple[T, T | None]]:
    """Yield every element of `one` with its counterpart in `other`, or None if it has none.

    Equal elements are paired in order, and the elements between them first to first. If that leaves an element of
    `other` without a partner, all elements are paired by position, because additions stand at the end.

    >>> list(paired("abcd", "axd", str.__eq__)), list(paired("ab", "axb", str.__eq__))
    ([('a', 'a'), ('b', 'x'), ('c', None), ('d', 'd')], [('a', 'a'), ('b', 'x')])
    """
    kept = _common(one, other, alike)
    if len(other) > len(one) or any(
        b - d > a - c for (a, b), (c, d) in zip(kept, [(-1, -1), *kept], strict=False)
    ):
        kept = []
    last = (-1, -1)
    for end in (*kept, (len(one), len(other))):
        between = list(range(last[1] + 1, end[1]))
        for number, index in enumerate(range(last[0] + 1, end[0])):
            yield one[index], other[between[number]] if number < len(between) else None
        if end[0] < len(one):
            yield one[end[0]], other[end[1]]
        last = end


def _common(one: Sequence[T], other: Sequence[T], alike: Callable[[T, T], bool]) -> list[tuple[int, int]]:
    """Return the longest sequence of equal pairs, in the order of both."""
    same = [[alike(a, b) for b in other] for a in one]
    length = [[0] * (len(other) + 1) for _ in range(len(one) + 1)]
    for i in reversed(range(len(one))):
        for j in reversed(range(len(other))):
            length[i][j] = 1 + length[i + 1][j + 1] if same[i][j] else max(length[i + 1][j], length[i][j + 1])
    pairs, i, j = [], 0, 0
    while i < len(one) and j < len(other):
        if same[i][j]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif length[i + 1][j] >= length[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs

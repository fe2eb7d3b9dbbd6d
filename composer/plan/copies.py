"""The copies that `replicate` makes of a part: their numbers, and what is put behind the prefix."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from composer.recipe.replicate import Axis

Copy = tuple[int, ...]
"""The number of a copy on each axis, from 0."""


def copies(axes: Sequence[Axis]) -> Iterator[tuple[str, Copy]]:
    """What each copy has behind the prefix of the part, and its numbers; the last axis runs first.

    >>> [suffix for suffix, _ in copies([Axis(2), Axis(11)])][9:12]
    ['0_09', '0_10', '1_00']
    """
    widths = [len(str(axis.count - 1)) for axis in axes]
    for copy in product(*(range(axis.count) for axis in axes)):
        numbers = (str(number).zfill(width) for number, width in zip(copy, widths, strict=True))
        yield "_".join(numbers), copy

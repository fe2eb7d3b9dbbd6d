"""Folding ranges. They follow from the indentation, so that half-written text can be folded too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from composer.lsp.answers import Fold


def folds(lines: Sequence[str]) -> list[Fold]:
    """Return the first and last lines of the blocks and comments of a text.

    >>> folds(["a:", "  b: 1", "", "  c: 2", "d: 3"])
    [Fold(first=0, last=3, kind='region')]
    """
    return sorted([*_blocks(lines), *_comments(lines)], key=lambda each: (each.first, each.last))


def _blocks(lines: Sequence[str]) -> Iterator[Fold]:
    open: list[tuple[int, int]] = []
    last = -1
    for number, line in enumerate([*lines, "end"]):
        if number < len(lines) and (not line.strip() or line.lstrip().startswith("#")):
            continue
        indent = len(line) - len(line.lstrip()) if number < len(lines) else -1
        while open and open[-1][0] >= indent:
            _, first = open.pop()
            if last > first:
                yield Fold(first, last)
        open.append((indent, number))
        last = number


def _comments(lines: Sequence[str]) -> Iterator[Fold]:
    first = None
    for number, line in enumerate([*lines, ""]):
        is_comment = line.lstrip().startswith("#")
        if is_comment and first is None:
            first = number
        elif not is_comment and first is not None:
            if number - first > 1:
                yield Fold(first, number - 1, "comment")
            first = None

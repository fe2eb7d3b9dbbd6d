"""Which items of two sequences belong together, such as the lines of a text before and after a change."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Hashable, Iterator, Sequence
from difflib import Match, SequenceMatcher
from typing import TypeVar

Item = TypeVar("Item", bound=Hashable)

_SMALL = 300_000
"""The most pairs of items that `SequenceMatcher` compares: about 0.1 s."""


class Alignment(SequenceMatcher[Item]):
    """A `SequenceMatcher` for long sequences, whose time grows with their length.

    `SequenceMatcher` looks for the longest common run, and again on both sides of it. If each entry of a long file has
    one changed line, it takes the square of the file's length. Here, items that both sequences have exactly once part
    long sequences first. A long stretch without such items counts as replaced.

    >>> Alignment("abcd", "axcd").get_opcodes()
    [('equal', 0, 1, 0, 1), ('replace', 1, 2, 1, 2), ('equal', 2, 4, 2, 4)]
    """

    def __init__(self, before: Sequence[Item], after: Sequence[Item]) -> None:
        super().__init__(None, before, after, autojunk=False)
        self._before = before
        self._after = after
        self._blocks: list[Match] | None = None

    def get_matching_blocks(self) -> list[Match]:
        if self._blocks is None:
            self._blocks = self._found()
        return self._blocks

    def _found(self) -> list[Match]:
        if len(self._before) * len(self._after) <= _SMALL:
            return super().get_matching_blocks()
        runs = _adjacent(_matches(self._before, self._after))
        return [*runs, Match(len(self._before), len(self._after), 0)]


def _matches(before: Sequence[Item], after: Sequence[Item]) -> Iterator[Match]:
    """Yield common runs of two long sequences in order: the ends, the anchors, and the runs between them."""
    head, tail = common_ends(before, after)
    ends = (len(before) - tail, len(after) - tail)
    yield Match(0, 0, head)
    start = (head, head)
    for at, place in [*_anchors(before, after, start, ends), ends]:
        inner = before[start[0] : at]
        outer = after[start[1] : place]
        if len(inner) * len(outer) <= _SMALL:
            for block in SequenceMatcher(None, inner, outer, autojunk=False).get_matching_blocks():
                yield Match(start[0] + block.a, start[1] + block.b, block.size)
        if (at, place) != ends:
            yield Match(at, place, 1)
        start = (at + 1, place + 1)
    yield Match(*ends, tail)


def _anchors(
    before: Sequence[Item], after: Sequence[Item], start: tuple[int, int], ends: tuple[int, int]
) -> list[tuple[int, int]]:
    """Return the places of the most items, unique in both stretches, that have the same order in both."""
    counts = Counter(before[start[0] : ends[0]])
    places = {item: place for place, item in enumerate(after[start[1] : ends[1]], start[1])}
    others = Counter(after[start[1] : ends[1]])
    pairs = [
        (at, places[item])
        for at, item in enumerate(before[start[0] : ends[0]], start[0])
        if counts[item] == 1 and others[item] == 1
    ]
    return _longest_increasing(pairs)


def _longest_increasing(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return a longest part of the pairs whose second numbers increase (patience sorting).

    >>> _longest_increasing([(0, 5), (1, 0), (2, 1), (3, 9)])
    [(1, 0), (2, 1), (3, 9)]
    """
    tops: list[int] = []  # the smallest second number that ends an increasing part of each length
    ends: list[int] = []  # the pair with this number
    previous: list[int] = []
    for number, (_, place) in enumerate(pairs):
        length = bisect_left(tops, place)
        previous.append(ends[length - 1] if length else -1)
        tops[length : length + 1] = [place]
        ends[length : length + 1] = [number]
    chosen: list[tuple[int, int]] = []
    number = ends[-1] if ends else -1
    while number >= 0:
        chosen.append(pairs[number])
        number = previous[number]
    return chosen[::-1]


def _adjacent(matches: Iterator[Match]) -> list[Match]:
    """Return the runs with those that follow each other joined, and without empty ones."""
    runs: list[Match] = []
    for match in matches:
        if not match.size:
            continue
        last = runs[-1] if runs else None
        if last is not None and (last.a + last.size, last.b + last.size) == (match.a, match.b):
            runs[-1] = Match(last.a, last.b, last.size + match.size)
        else:
            runs.append(match)
    return runs


def common_ends(before: Sequence[object], after: Sequence[object]) -> tuple[int, int]:
    """Return the number of items that two lists or texts share at the start, and of the other items at the end.

    >>> common_ends("abcd", "abxd"), common_ends("aa", "aaa")
    ((2, 1), (2, 0))
    """
    most = min(len(before), len(after))
    head = next((at for at in range(most) if before[at] != after[at]), most)
    return head, next((at for at in range(most - head) if before[-1 - at] != after[-1 - at]), most - head)


def unified_diff(before: list[str], after: list[str], old: str, new: str) -> Iterator[str]:
    r"""Yield the lines of a unified diff, as `difflib.unified_diff` does, with three lines around each change.

    >>> list(unified_diff(["a", "b"], ["a", "c"], "x.yaml", "x.yaml (formatted)"))
    ['--- x.yaml\n', '+++ x.yaml (formatted)\n', '@@ -1,2 +1,2 @@\n', ' a', '-b', '+c']
    """
    for number, group in enumerate(Alignment(before, after).get_grouped_opcodes()):
        if number == 0:
            yield f"--- {old}\n"
            yield f"+++ {new}\n"
        first = group[0]
        last = group[-1]
        yield f"@@ -{_lines(first[1], last[2])} +{_lines(first[3], last[4])} @@\n"
        for kind, low, high, start, end in group:
            if kind == "equal":
                yield from (f" {line}" for line in before[low:high])
                continue
            yield from (f"-{line}" for line in before[low:high])
            yield from (f"+{line}" for line in after[start:end])


def _lines(low: int, high: int) -> str:
    """Return the range of lines as a unified diff has it: an empty one begins at the line before."""
    count = high - low
    if count == 1:
        return str(low + 1)
    return f"{low + 1 if count else low},{count}"

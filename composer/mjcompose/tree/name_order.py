"""Names in alphabetical order, to find those that begin with a text or contain it without a look at each."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections.abc import Iterable
from itertools import accumulate

_FEW = 8
"""The most candidates that a search compares one by one."""
_BETWEEN = "\0"
"""A character that no name in XML has."""


class NameOrder:
    """Names that differ from each other, in order.

    >>> order = NameOrder(["left/pad", "left/tip", "right/pad"])
    >>> order.add("left/arm")
    >>> order.discard("left/tip")
    >>> order.beginning("left/"), order.containing("pad")
    (['left/arm', 'left/pad'], ['left/pad', 'right/pad'])
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._names = sorted(names)
        self._text: str | None = None
        self._starts: list[int] = []

    def __len__(self) -> int:
        return len(self._names)

    def add(self, name: str) -> None:
        if not self._has(name):
            insort(self._names, name)
            self._text = None

    def discard(self, name: str) -> None:
        if self._has(name):
            del self._names[bisect_left(self._names, name)]
            self._text = None

    def all(self) -> list[str]:
        return list(self._names)

    def beginning(self, start: str) -> list[str]:
        """Return the names that begin with a text."""
        length = len(start)
        first = bisect_left(self._names, start)
        last = bisect_right(self._names, start, lo=first, key=lambda name: name[:length])
        return self._names[first:last]

    def containing(self, part: str) -> list[str]:
        """Return the names that contain a text. C searches all names at once."""
        if _BETWEEN in part:
            return []
        if self._text is None:
            self._text = _BETWEEN.join(self._names)
            self._starts = [0, *accumulate(len(name) + 1 for name in self._names)]
        found: list[str] = []
        place = self._text.find(part)
        while place >= 0 and len(found) < len(self._names):
            number = bisect_right(self._starts, place) - 1
            found.append(self._names[number])
            place = self._text.find(part, self._starts[number + 1])
        return found

    def narrowed(self, starts: Iterable[str], part: str) -> list[str]:
        """Return names among which are all that begin with one of the texts and contain `part`, and few others.

        >>> order = NameOrder([f"pad{number}" for number in range(20)])
        >>> order.narrowed(["pad19"], ""), order.narrowed([""], "d9"), order.narrowed(["p"], "d9")
        (['pad19'], ['pad9'], ['pad9'])
        """
        starts = list(starts)
        if "" in starts:
            return self.containing(part) if part else self.all()
        begun = list(dict.fromkeys(name for start in starts for name in self.beginning(start)))
        if not part or len(begun) <= _FEW:
            return begun
        return min(begun, self.containing(part), key=len)

    def _has(self, name: str) -> bool:
        at = bisect_left(self._names, name)
        return at < len(self._names) and self._names[at] == name

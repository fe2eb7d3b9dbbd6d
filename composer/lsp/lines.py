"""The lines of a text as editors count them, and columns in the units of the protocol."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_UNITS: dict[str, Callable[[str], int]] = {
    "utf-8": lambda character: len(character.encode("utf-8", "surrogatepass")),
    "utf-16": lambda character: 2 if ord(character) > 0xFFFF else 1,
    "utf-32": lambda character: 1,
}


def lines_of(text: str) -> list[str]:
    r"""Return the lines without their ends. `str.splitlines` also splits at characters that editors and YAML do not.

    >>> lines_of("a\r\nb\u2028c\n")
    ['a', 'b\u2028c', '']
    """
    return _LINE_BREAK.split(text)


def units(line: str, column: int, encoding: str = "utf-16") -> int:
    """Return how many units of an encoding precede a character, counted from 0. Past the end counts as the end.

    >>> units("🤖: x", 1)
    2
    """
    before = line[: max(column, 0)]
    if before.isascii():
        return len(before)
    return sum(map(_UNITS[encoding], before))


def column_of(line: str, count: int, encoding: str = "utf-16") -> int:
    """Return the character, counted from 0, that this many units precede.

    >>> column_of("🤖: x", 2), column_of("ab", 9)
    (1, 2)
    """
    if line.isascii():
        return max(0, min(count, len(line)))
    size, passed = _UNITS[encoding], 0
    for column, character in enumerate(line):
        if passed >= count:
            return column
        passed += size(character)
    return len(line)


def moved(old: Sequence[str], new: Sequence[str]) -> dict[int, int]:
    """Return for the lines of a text where they are in a later text, both counted from 0.

    Lines that may have changed are left out.

    >>> moved(["a", "b", "c"], ["a", "x", "y", "c"])
    {0: 0, 2: 3}
    """
    most = min(len(old), len(new))
    head = next((at for at in range(most) if old[at] != new[at]), most)
    tail = next((at for at in range(most - head) if old[-1 - at] != new[-1 - at]), most - head)
    kept = {at: at for at in range(head)}
    kept |= {at: at + len(new) - len(old) for at in range(len(old) - tail, len(old))}
    return kept

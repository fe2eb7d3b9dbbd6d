"""Globs over names: `*` and `?` stop at the separator, `**` does not, `{a,b}` is a choice.

A name is matched in one go through the glob, by the set of its places that can be reached: never by trying and going
back, so that no glob takes long for any name. The sets are the bits of integers.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from enum import Enum
from functools import lru_cache

_TOKENS = r"\*\*|\*|\?|\{[^{}]*\}|[^*?{]+|."
_ONE = ord("1")


class _Wild(Enum):
    ONE = "?"
    LEVEL = "*"
    ALL = "**"
    LEVELS = "**/"


_Token = _Wild | str | list[list["_Token"]]
"""What stands for other characters, text that stands for itself, or a choice."""


def is_glob(name: str) -> bool:
    """Whether a name is one of many: no plain name has these characters."""
    return any(character in name for character in "*?{")


def stray_brace(glob: str) -> int | None:
    """The place of a brace that is not part of a choice, of which none can stand in another.

    >>> stray_brace("{a,b}/*"), stray_brace("x{a"), stray_brace("a}"), stray_brace("{a,{b}}")
    (None, 1, 1, 0)
    """
    found = re.search(r"[{}]", re.sub(r"\{[^{}]*\}", lambda choice: "-" * len(choice[0]), glob))
    return found.start() if found else None


@lru_cache(maxsize=256)
def matcher(glob: str, separator: str = "/") -> Callable[[str], bool]:
    """Whether a name is meant by a glob.

    >>> pads = matcher("gripper/*_pad?")
    >>> pads("gripper/left_pad1"), pads("gripper/left/pad1"), matcher("**/{pad,tip}")("a/b/tip")
    (True, False, True)
    """
    if not is_glob(glob):
        return glob.__eq__
    tokens = _tokens(glob, separator)
    texts = [token for token in tokens if isinstance(token, str)]
    stops = separator if _makes_levels(separator) else ""

    def fits(name: str) -> bool:
        # Most names lack a part of the glob, and this is seen at once.
        return all(text in name for text in texts) and _Name(name, stops).is_meant_by(tokens)

    return fits


def _tokens(glob: str, separator: str) -> list[_Token]:
    levels = f"**{separator}" if _makes_levels(separator) else None
    found: list[_Token] = []
    for token in re.findall(rf"{re.escape(levels)}|{_TOKENS}" if levels else _TOKENS, glob, re.DOTALL):
        if token == levels:
            found.append(_Wild.LEVELS)
        elif token in ("?", "*", "**"):
            found.append(_Wild(token))
        elif token[0] == "{" and len(token) > 1:
            found.append([_tokens(each, separator) for each in token[1:-1].split(",")])
        else:
            found.append(token)
    return found


def _makes_levels(separator: str) -> bool:
    """Whether `*` stops there: `_` stands in names, too."""
    return separator not in ("_", "__")


class _Name:
    """A name that is matched. Places are bits: the lowest is that before its first character."""

    def __init__(self, name: str, stops: str) -> None:
        self.name = name
        self.end = 1 << len(name)
        self.stops = 0
        for character in stops:
            self.stops |= self._at(character)
        self.within = (self.end - 1) & ~self.stops

    def _at(self, text: str) -> int:
        """The places before a text; not by an integer for each, since a name may be long."""
        found = bytearray(b"0" * (len(self.name) + 1))
        place = self.name.find(text)
        while place >= 0:
            found[~place] = _ONE
            place = self.name.find(text, place + 1)
        return int(found, 2)

    def is_meant_by(self, tokens: list[_Token]) -> bool:
        return bool(self._reached(tokens, 1) & self.end)

    def _reached(self, tokens: list[_Token], places: int) -> int:
        """The places behind what the tokens stand for, from each of some places on."""
        for token in tokens:
            if isinstance(token, str):
                places = (places & self._at(token)) << len(token)
            elif isinstance(token, list):
                ends = 0
                for each in token:
                    ends |= self._reached(each, places)
                places = ends
            else:
                places = self._behind(token, places)
            if not places:
                break
        return places

    def _behind(self, token: _Wild, places: int) -> int:
        from_first = -(places & -places)
        if token is _Wild.ONE:
            return (places & self.within) << 1
        if token is _Wild.LEVEL:  # the carry of the sum runs from each place to the end of its level
            return (((places & self.within) + self.within) ^ self.within) | places
        if token is _Wild.ALL:
            return from_first & (2 * self.end - 1)
        return places | (self.stops & from_first) << 1

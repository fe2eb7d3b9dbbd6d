"""Globs over names: `*` and `?` stop at the separator, `**` does not, `{a,b}` is a choice."""

from __future__ import annotations

import re
from collections.abc import Callable

_TOKEN = re.compile(r"\*\*/|\*\*|\*|\?|\{[^{}]*\}|.", re.DOTALL)


def is_glob(name: str) -> bool:
    """Whether a name is one of many: no plain name has these characters."""
    return any(character in name for character in "*?{")


def matcher(glob: str, separator: str = "/") -> Callable[[str], bool]:
    """Whether a name is meant by a glob.

    >>> pads = matcher("gripper/*_pad?")
    >>> pads("gripper/left_pad1"), pads("gripper/left/pad1"), matcher("**/{pad,tip}")("a/b/tip")
    (True, False, True)
    """
    pattern = re.compile(_pattern(glob, separator))
    return lambda name: pattern.fullmatch(name) is not None


def _pattern(glob: str, separator: str) -> str:
    any_character = f"[^{re.escape(separator)}]" if separator not in ("_", "__") else "."
    pieces = []
    for token in _TOKEN.findall(glob):
        if token == "**/":
            pieces.append(f"(?:.*{re.escape(separator)})?" if separator == "/" else ".*/")
        elif token == "**":
            pieces.append(".*")
        elif token == "*":
            pieces.append(f"{any_character}*")
        elif token == "?":
            pieces.append(any_character)
        elif token[0] == "{" and len(token) > 1:
            pieces.append(f"(?:{'|'.join(_pattern(each, separator) for each in token[1:-1].split(','))})")
        else:
            pieces.append(re.escape(token))
    return "".join(pieces)

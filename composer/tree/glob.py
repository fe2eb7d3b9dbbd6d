"""Globs over names: `*` and `?` stop at the separator, `**` does not, `{a,b}` is a choice."""

from __future__ import annotations

import re
from collections.abc import Callable

_TOKENS = r"\*\*|\*|\?|\{[^{}]*\}|."


def is_glob(name: str) -> bool:
    """Whether a name is one of many: no plain name has these characters."""
    return any(character in name for character in "*?{")


def stray_brace(glob: str) -> int | None:
    """The place of a brace that is no part of a choice, of which none can stand in another.

    >>> stray_brace("{a,b}/*"), stray_brace("x{a"), stray_brace("a}"), stray_brace("{a,{b}}")
    (None, 1, 1, 0)
    """
    found = re.search(r"[{}]", re.sub(r"\{[^{}]*\}", lambda choice: "-" * len(choice[0]), glob))
    return found.start() if found else None


def matcher(glob: str, separator: str = "/") -> Callable[[str], bool]:
    """Whether a name is meant by a glob.

    >>> pads = matcher("gripper/*_pad?")
    >>> pads("gripper/left_pad1"), pads("gripper/left/pad1"), matcher("**/{pad,tip}")("a/b/tip")
    (True, False, True)
    """
    pattern = re.compile(_pattern(glob, separator))
    return lambda name: pattern.fullmatch(name) is not None


def _pattern(glob: str, separator: str) -> str:
    makes_levels = separator not in ("_", "__")
    end = re.escape(separator)
    any_character = f"[^{end}]" if makes_levels else "."
    pieces = []
    levels = f"**{separator}"
    for token in re.findall(rf"\*\*{end}|{_TOKENS}" if makes_levels else _TOKENS, glob, re.DOTALL):
        if token == levels:
            pieces.append(f"(?:.*{end})?")
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

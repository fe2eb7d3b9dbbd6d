"""Help for a text in `{ }` without a colon: YAML reads it as a key without a value, which no recipe intends."""

from __future__ import annotations

import re

from composer.document.quote import quoted

_NUMBER = re.compile(r"[-+(]*(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?:deg|rad)?\)*")
_TIGHT = re.compile(r"([A-Za-z_][\w.-]*):([^\s:/\\].*)")
_WORDS = re.compile(r"([A-Za-z_][\w.-]*)\s+(?:=\s*)?(\S.*)")


def advice(text: str, is_quoted: bool, before: str | None) -> str:
    """Return what to write instead of `text`; `before` is the key of the preceding pair, if any.

    >>> advice("size 0.03", False, None)
    'put a colon between them: `size: 0.03`'
    >>> advice("0", False, "pos")
    'put brackets around the numbers: `pos: […]`'
    """
    if not is_quoted:
        parts = text.split()
        if parts and all(map(_NUMBER.fullmatch, parts)):
            numbers = "…" if len(parts) < 2 else ", ".join(parts)
            return f"put brackets around the numbers: `{before + ': ' if before and len(parts) < 2 else ''}[{numbers}]`"
        if found := _TIGHT.fullmatch(text):
            return f"put a space behind the colon: `{found[1]}: {found[2]}`"
        if found := _WORDS.fullmatch(text):
            return f"put a colon between them: `{found[1]}: {found[2]}`"
    shown = quoted(text) if is_quoted else text
    return f"write `{shown}: …` with its value, or `[{shown}]` for a list"

"""Formatting of a recipe, as changes of lines, so that the cursor stays where it is."""

from __future__ import annotations

import difflib
import re

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.formatting.format import format_recipe
from composer.lsp.answers import Change
from composer.lsp.lines import lines_of

_LINE = re.compile(r"[^\r\n]*(?:\r\n|\n|\r)|[^\r\n]+\Z")


def formatted(text: str, file: str) -> list[Change]:
    """Return the changes that `fmt` would make, or none if the text is not a recipe that it can format."""
    result = format_recipe(text.encode("utf-8", "replace"), file, Sink())
    if result is None:
        return []
    before, after = _LINE.findall(text), _LINE.findall(result.decode("utf-8"))
    return [
        Change(_span(file, first, last, text), "".join(after[low:high]))
        for kind, first, last, low, high in difflib.SequenceMatcher(None, before, after, False).get_opcodes()
        if kind != "equal"
    ]


def _span(file: str, first: int, last: int, text: str) -> Span:
    """Return the span of whole lines, counted from 0.

    A last line without a line break ends after its last character.
    """
    lines = lines_of(text)
    if last >= len(lines):
        return Span(file, first + 1, 1, len(lines), len(lines[-1]) + 1)
    return Span(file, first + 1, 1, last + 1, 1)

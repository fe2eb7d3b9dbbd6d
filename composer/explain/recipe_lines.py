"""Show what a recipe writes for a value, which may be in another unit or form than the model's."""

from __future__ import annotations

import re
from itertools import takewhile
from pathlib import Path

from composer.diagnostics.span import Span
from composer.explain.explanation import Reason
from composer.reading.regular import read_regular
from composer.recipe.controls import HOLD, WAYS


class RecipeLines:
    """The lines of recipes in a folder, read on first use."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.lines: dict[str, list[str]] = {}

    def text_of(self, span: Span) -> str | None:
        """Return the text of a span if it is on one line."""
        if span.end_column is None or span.end_line != span.line:
            return None
        if span.file not in self.lines:
            try:
                self.lines[span.file] = read_regular(self.folder / span.file).decode("utf-8").splitlines()
            except (OSError, UnicodeDecodeError):
                self.lines[span.file] = []
        lines = self.lines[span.file]
        if span.line > len(lines):
            return None
        text = lines[span.line - 1][span.column - 1 : span.end_column - 1]
        return text if not text.startswith("- ") else _list_of(lines[span.line - 1 :], span.column - 1)

    def in_own_form(self, span: Span | None, text: str | None) -> Reason:
        """Return the place of a value in a recipe, with the recipe's own text if that is not the value itself."""
        if span is None or self.has(span, text):
            return Reason("", span)
        written = self.text_of(span)
        if written in (HOLD, *WAYS):
            return Reason("computed: what holds the pose of the key", span)
        return Reason(f"`{written}` in the recipe's own unit or form", span)

    def has(self, span: Span | None, text: str | None) -> bool:
        recipe = None if span is None else self.text_of(span)
        return recipe is None or text is None or same_words(recipe, text)


def _list_of(lines: list[str], indent: int) -> str:
    """Join a YAML list with an item on each line into one line."""
    dash = " " * indent + "- "
    items = [line[len(dash) :].strip() for line in takewhile(lambda line: line.startswith(dash), lines)]
    return f"[{', '.join(items)}]"


def same_words(recipe: str, text: str) -> bool:
    """Return whether a recipe and MJCF write the same value, each in its own syntax."""
    return same_value(re.sub(r"""[][,"']""", " ", recipe), text)


def same_value(a: str, b: str) -> bool:
    """Return whether two MJCF texts are the same value: word by word the same text or the same number.

    >>> same_value("1 0.50 x", "1.0 .5 x")
    True
    """
    ours, theirs = a.split(), b.split()
    return len(ours) == len(theirs) and all(map(_same_word, ours, theirs))


def _same_word(ours: str, theirs: str) -> bool:
    try:
        return ours == theirs or float(ours) == float(theirs)
    except ValueError:
        return False

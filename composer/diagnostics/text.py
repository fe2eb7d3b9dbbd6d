"""Diagnostics as text for a terminal: the message, the source line, and what to do."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable
from functools import lru_cache

from composer.dataclass import dataclass
from composer.diagnostics.cell_name import listed
from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.paint import Paint
from composer.diagnostics.secret import masked
from composer.diagnostics.span import Span

ReadSource = Callable[[str], str | None]

_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_TAB = " " * 4
_WINDOW = 160  # screen columns of source shown at most
_BEFORE = 60  # of these, columns before the span
_NEAR = 2000  # characters on each side of a span that are read: a line may be as long as a file
_BIDIRECTIONAL = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
_CONTROL = f"\\x00-\\x08\\x0b-\\x1a\\x1c-\\x1f\\x7f-\\x9f\u2028\u2029{_BIDIRECTIONAL}"
_UNSAFE = re.compile(f"[\\x1b\ud800-\udfff{_CONTROL}]")
_UNSAFE_WITH_COLORS = re.compile(f"\\x1b(?!\\[[0-9;]*m)|[{_CONTROL}]")


def render(diagnostic: Diagnostic, read_source: ReadSource | None = None, color: bool = False) -> str:
    """Return the diagnostic as several lines of text, without a final line break.

    `read_source(file)` returns the text of a file, or None if there is none to show; without it, no source lines
    are shown. `color` adds ANSI colours. No I/O of its own.
    """
    excerpts = [_excerpt(span, read_source) for span in _spans(diagnostic)]
    margin = max((len(str(each.number)) for each in excerpts if each), default=1)
    paint = Paint(color)
    edge = paint("gutter", " " * (margin + 1) + "|")

    def shown(excerpt: _Excerpt | None, style: str, mark: str) -> list[str]:
        if excerpt is None:
            return []
        number = paint("gutter", f"{excerpt.number:>{margin}} |")
        underline = " " * excerpt.offset + paint(style, mark * excerpt.width)
        return [edge, f"{number} {excerpt.text}".rstrip(), f"{edge} {underline}"]

    def remark(kind: str, text: str) -> list[str]:
        first, *rest = _printable_lines(text)
        head = " " * (margin + 1) + "= "
        indent = " " * (len(head) + len(kind) + 2)
        return [f"{head}{paint(kind, kind)}: {first}", *(f"{indent}{line}".rstrip() for line in rest)]

    kind = diagnostic.severity.value
    place = "" if diagnostic.span is None else paint("bold", f"{_printable(str(diagnostic.span))}:") + " "
    message = paint("bold", " ".join(_printable_lines(diagnostic.message)))
    lines = [f"{place}{paint(kind, f'{kind}[{diagnostic.code}]')}: {message}"]

    following = iter(excerpts)
    if diagnostic.span is not None:
        lines += shown(next(following), kind, "^")
    if cells := diagnostic.cells:
        lines += remark("cell" if len(cells) == 1 else "cells", listed(cells))
    if recipes := diagnostic.recipes:
        lines += remark("recipe" if len(recipes) == 1 else "recipes", ", ".join(recipes))
    for note in diagnostic.listed():
        if note.span is None:
            lines += remark("note", note.message)
        else:
            lines += remark("note", f"{note.span}: {note.message}")
            lines += shown(next(following), "note", "-")
    if diagnostic.help is not None:
        lines += remark("help", diagnostic.help)
    return "\n".join(lines)


def printable(text: str, colors: bool = False) -> str:
    r"""Return a text in which no character acts on a terminal, a log or the order of others; lines and tabs stay.

    With `colors`, codes of colours stay too, and bytes of file names that are no text in this locale.

    >>> printable("a\x9b2Jb\u202ec")
    'a\ufffd2Jb\ufffdc'
    """
    unsafe = _UNSAFE_WITH_COLORS if colors else _UNSAFE
    return unsafe.sub(lambda found: _stand_in(found[0]), text.replace("\r\n", "\n"))


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """Return how many diagnostics of each severity there are.

    >>> summary([Diagnostic("bad-name", "a"), Diagnostic("bad-name", "b", severity=Severity.WARNING)])
    '1 error, 1 warning'
    >>> summary([])
    'no errors'
    """
    found = [each.severity for each in diagnostics]
    counts = [(severity.value, found.count(severity)) for severity in Severity]
    listed = [f"{count} {name}{'s' * (count != 1)}" for name, count in counts if count]
    return ", ".join(listed) or "no errors"


@dataclass(frozen=True, slots=True)
class _Excerpt:
    """A source line for display: `offset` and `width` of the underline are in screen columns."""

    number: int
    text: str
    offset: int
    width: int


def _spans(diagnostic: Diagnostic) -> Iterable[Span]:
    if diagnostic.span is not None:
        yield diagnostic.span
    for note in diagnostic.notes:
        if note.span is not None:
            yield note.span


@lru_cache(maxsize=4)
def _lines(source: str) -> tuple[str, ...]:
    """Split a text into lines; cached because many diagnostics may be about one text."""
    return tuple(_LINE_BREAK.split(source.removeprefix("\ufeff")))


def _excerpt(span: Span, read_source: ReadSource | None) -> _Excerpt | None:
    source = None if read_source is None else read_source(span.file)
    if source is None:
        return None
    lines = _lines(source)
    if not 1 <= span.line <= len(lines):
        return None
    whole = lines[span.line - 1].rstrip()
    skipped = max(span.column - 1 - _NEAR, 0)
    line = masked(whole[skipped : max(span.column, 1) + _NEAR])
    cells = [_cell(character) for character in line]
    widths = [width for _, width in cells]

    start = min(max(span.column - 1 - skipped, 0), len(line))
    if span.end_line is not None and span.end_line > span.line:
        end = len(line)
    else:
        end = start if span.end_column is None else min(span.end_column - 1 - skipped, len(line))
    end = max(end, start + 1)  # an empty span, or one past the end of the line, gets one caret

    left, right = _window(widths, start)
    text = "".join(shown for shown, _ in cells[left:right])
    offset = sum(widths[left:start])
    width = max(sum(widths[start : min(end, right)]), 1)
    if left + skipped > 0:
        text, offset = "…" + text, offset + 1
    if right < len(cells) or skipped + len(line) < len(whole):
        text += "…"
    return _Excerpt(span.line, text, offset, width=width)


def _window(widths: list[int], start: int) -> tuple[int, int]:
    """Return the slice of a line to show: all of it, or about `_WINDOW` columns around the character `start`."""
    if sum(widths) <= _WINDOW:
        return 0, len(widths)
    left, used = start, 0
    while left > 0 and used + widths[left - 1] <= _BEFORE:
        left -= 1
        used += widths[left]
    right = start
    while right < len(widths) and used + widths[right] <= _WINDOW:
        used += widths[right]
        right += 1
    while left > 0 and used + widths[left - 1] <= _WINDOW:
        left -= 1
        used += widths[left]
    return left, right


def _cell(character: str) -> tuple[str, int]:
    """Return what is shown for a character, and how many screen columns that takes."""
    if " " <= character <= "~":
        return character, 1
    if character == "\t":
        return _TAB, len(_TAB)
    category = unicodedata.category(character)
    if category in ("Cc", "Cs", "Zl", "Zp") or character in _BIDIRECTIONAL:
        return _stand_in(character), 1
    if category in ("Mn", "Me", "Cf"):
        return character, 0
    return character, 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _stand_in(character: str) -> str:
    """Return a visible character in place of a control character."""
    return chr(0x2400 + ord(character)) if character < " " else "\ufffd"


def _printable(text: str) -> str:
    return "".join(_TAB if character == "\t" else _cell(character)[0] for character in text)


def _printable_lines(text: str) -> list[str]:
    return [_printable(line) for line in _LINE_BREAK.split(text)]

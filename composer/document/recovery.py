"""Where a YAML parser stopped, the error reported for it, and how reading goes on behind it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from composer.diagnostics import Diagnostic, Note, Span
from composer.diagnostics.fix import Fix
from composer.document.decode import position
from composer.document.quote import in_flow, quoted

_LINE = re.compile(r"[^\r\n]*")
_WORD = re.compile(r"[\w${*/.-]+|\S")


@dataclass(frozen=True, slots=True)
class SyntaxFault:
    """A syntax fault as a diagnostic.

    `hide` is the stretch of the text that was meant as a plain value: once it is hidden from the reader,
    reading can go on and find what else there is. None when the reading ends here.
    """

    diagnostic: Diagnostic
    hide: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class ParserStop:
    """Where the parser stopped, and what it said, in its words (`context`, `problem`).

    `at` and `since` are indices into `text`: where it broke off, and the start of what it was reading then.
    `outer` says whether the break is inside `[ ]` or `{ }` that began on an earlier line.
    """

    text: str
    file: str
    context: str
    problem: str
    since: int
    at: int
    outer: bool

    def span(self, start: int, end: int | None = None) -> Span:
        """The place of the characters up to `end`; without it, of one."""
        line, column = position(self.text, start)
        length = 1 if end is None else max(end - start, 1)
        return Span(self.file, line, column, line, column + length)

    def fault(
        self, message: str, span: Span, help: str | None = None, code: str = "yaml-syntax", *notes: Note
    ) -> SyntaxFault:
        """A fault after which nothing can be read."""
        return SyntaxFault(Diagnostic(code, message, span, notes=notes, help=help))

    def unquoted(self, code: str, start: int, end: int, message: str) -> SyntaxFault:
        """The fault of a text that only lacks its quotes."""
        text = quoted(self.text[start:end])
        found = Diagnostic(code, message, self.span(start, end), help=f"quote it: {text}", fix=Fix(text))
        return SyntaxFault(found, (start, end))

    @property
    def flow(self) -> bool:
        """Whether the break is inside `[ ]` or `{ }`."""
        return in_flow(self.text, self.at, self.outer)

    @property
    def line(self) -> str:
        """The line of the break."""
        return self.line_of(self.at)

    def line_start(self, index: int) -> int:
        return max(self.text.rfind("\n", 0, index), self.text.rfind("\r", 0, index)) + 1

    def line_of(self, index: int) -> str:
        found = _LINE.match(self.text, self.line_start(index))
        return found.group() if found else ""

    @property
    def same_line(self) -> bool:
        """Whether what was being read began on the line of the break."""
        return self.line_start(self.since) == self.line_start(self.at)

    @property
    def shown(self) -> str:
        """What stands where the reading broke off."""
        if self.at >= len(self.text):
            return "the end of the file"
        found = _WORD.match(self.text, self.at)
        return f"`{found.group()[:40]}`" if found else "the end of the line"

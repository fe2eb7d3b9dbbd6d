"""Where a YAML parser stopped, the error to report, and how reading continues after it."""

from __future__ import annotations

import re

from composer.dataclass import dataclass
from composer.diagnostics import Diagnostic, Note, Span
from composer.diagnostics.fix import Fix
from composer.document.decode import position
from composer.document.quote import in_flow, quoted

_LINE = re.compile(r"[^\r\n]*")
_WORD = re.compile(r"[\w${*/.-]+|\S")


@dataclass(frozen=True, slots=True)
class SyntaxFault:
    """A syntax fault as a diagnostic.

    `hide` is the stretch of text that was meant as a plain value: once it is hidden from the reader, reading can
    continue and find further faults. It is None if reading ends here.
    """

    diagnostic: Diagnostic
    hide: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class ParserStop:
    """Where the parser stopped, and its message (`context`, `problem`).

    `at` and `since` are indices into `text`: where it stopped, and the start of what it was reading. `outer` says
    whether it is inside `[ ]` or `{ }` that began on an earlier line.
    """

    text: str
    file: str
    context: str
    problem: str
    since: int
    at: int
    outer: bool

    def span(self, start: int, end: int | None = None) -> Span:
        """Return the place of the characters up to `end`, or of a single one."""
        line, column = position(self.text, start)
        length = 1 if end is None else max(end - start, 1)
        return Span(self.file, line, column, end_line=line, end_column=column + length)

    def fault(
        self, message: str, span: Span, help: str | None = None, code: str = "yaml-syntax", *notes: Note
    ) -> SyntaxFault:
        """Return a fault after which nothing can be read."""
        return SyntaxFault(Diagnostic(code, message, span, notes=notes, help=help))

    def unquoted(self, code: str, start: int, end: int, message: str) -> SyntaxFault:
        """Return the fault for a text that only lacks its quotes."""
        text = quoted(self.text[start:end])
        found = Diagnostic(code, message, self.span(start, end), help=f"quote it: {text}", fix=Fix(text))
        return SyntaxFault(found, (start, end))

    @property
    def flow(self) -> bool:
        """Whether the parser stopped inside `[ ]` or `{ }`."""
        return in_flow(self.text, self.at, self.outer)

    @property
    def line(self) -> str:
        """The line where the parser stopped."""
        return self.line_of(self.at)

    def line_start(self, index: int) -> int:
        return max(self.text.rfind("\n", 0, index), self.text.rfind("\r", 0, index)) + 1

    def line_of(self, index: int) -> str:
        found = _LINE.match(self.text, self.line_start(index))
        return found.group() if found else ""

    @property
    def same_line(self) -> bool:
        """Whether the parser stopped on the line where the current token began."""
        return self.line_start(self.since) == self.line_start(self.at)

    @property
    def shown(self) -> str:
        """The text where the parser stopped."""
        if self.at >= len(self.text):
            return "the end of the file"
        found = _WORD.match(self.text, self.at)
        return f"`{found.group()[:40]}`" if found else "the end of the line"

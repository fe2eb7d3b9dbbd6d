"""Describe errors in malformed XML for its author, instead of in a parser's words."""

from __future__ import annotations

import re
from collections.abc import Callable

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.tree import lfs

_Words = tuple[str, str | None]


def report(said: str, file: str, line: int, column: int, text: str, sink: Sink) -> None:
    """Report an `xml-syntax` error for lxml's message about `file`, with the tag that the message names by line."""
    if lfs.is_pointer(text):
        message = f"`{file}` is not XML: it is not the file itself but where Git LFS has it"
        sink.error("xml-syntax", message, Span(file, line, column), help=lfs.HELP)
        return
    said = re.sub(r", line \d+, column \d+.*", "", said, flags=re.DOTALL)
    message, help = next(
        (make(found) for pattern, make in _KNOWN if (found := pattern.match(said))), _plain(said)
    )
    notes: tuple[Note, ...] = ()
    if opened := _OPENED.search(said):
        lines = text.splitlines()
        at, tag = int(opened["line"]), opened["tag"]
        begin = lines[at - 1].rfind(f"<{tag}") if 0 < at <= len(lines) else -1
        if begin >= 0:
            span = Span(file, at, begin + 1, end_line=at, end_column=begin + 2 + len(tag))
            notes = (Note(f"`<{tag}>` begins here", span),)
    sink.error(
        "xml-syntax", f"`{file}` is not XML: {message}", Span(file, line, column), notes=notes, help=help
    )


_OPENED = re.compile(r"(?:Opening and ending tag mismatch:|Premature end of data in tag|Couldn't find end of Start Tag)"
                     r" (?P<tag>\S+) line (?P<line>\d+)")  # fmt: skip


def _words(message: str, help: str | None = None) -> Callable[[re.Match[str]], _Words]:
    return lambda found: (found.expand(message), found.expand(help) if help else None)


def _plain(said: str) -> _Words:
    first = (said.strip().splitlines() or ["it cannot be read"])[0]
    return (first[:1].lower() + first[1:] if not first[:2].isupper() else first, None)


_KNOWN: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], _Words]], ...] = tuple(
    (re.compile(pattern), words)
    for pattern, words in (
        (r"Document is empty", _words("it is empty")),
        (r"Start tag expected, '<' not found", _words("it does not begin with `<`")),
        (
            r"Opening and ending tag mismatch: (\S+) line (\d+) and (\S+)",
            _words(
                r"`</\3>` stands where `<\1>` is still open", r"end the tag with `/>`, or write `</\1>` first"
            ),
        ),
        (r"Premature end of data in tag (\S+)", _words(r"`<\1>` is never closed", r"write `</\1>`")),
        (
            r"Couldn't find end of Start Tag (\S+)",
            _words(r"the tag `<\1` has no end", "end it with `>`, or with `/>` if nothing stands in it"),
        ),
        (
            r"Unescaped '<' not allowed in attributes values",
            _words(
                "a `<` stands in the value of an attribute", "close the quote before it; a real `<` is `&lt;`"
            ),
        ),
        (
            r"AttValue: \" or ' expected",
            _words("the value of an attribute has no quotes", 'write `name="value"`'),
        ),
        (
            r"AttValue: ' expected",
            _words("the value of an attribute is never closed", "add the closing quote"),
        ),
        (
            r"Specification mandates? value for attribute (\S+)",
            _words(r"the attribute `\1` has no value", r'write `\1="…"`'),
        ),
        (
            r"Attribute (\S+) redefined",
            _words(r"the attribute `\1` is written twice in one tag", "keep one of them"),
        ),
        (
            r"xmlParseEntityRef: no name|EntityRef: expecting ';'",
            _words("a `&` stands by itself", "write `&amp;`"),
        ),
        (r"Entity '(\S+)' not defined", _words(r"nothing is known of `&\1;`", "write the character itself")),
        (
            r"Comment not terminated|Comment must not contain",
            _words("a comment is never closed", "close it with `-->`"),
        ),
        (
            r"Extra content at the end of the document",
            _words("something stands after the end of its one outermost element"),
        ),
        (
            r"[Ee]xcessive depth in document: (\d+)",
            _words(r"elements stand more than \1 deep inside one another"),
        ),
        (r"CData section not finished", _words("a `<![CDATA[` is never closed", "close it with `]]>`")),
        (
            r"xmlParseCharRef: invalid|PCDATA invalid Char|[Ii]nvalid character",
            _words("a character stands there that XML cannot hold", "take it out"),
        ),
        (r"[Ee]xpected '>'", _words("a tag lacks its `>`")),
        (r"StartTag: invalid element name", _words("a `<` begins no tag", "a real `<` is `&lt;`")),
        (
            r"error parsing attribute name",
            _words("a tag is not ended before the next one begins", "end it with `>`, or with `/>`"),
        ),
        (
            r"attributes construct error",
            _words("attributes are not parted from one another", "put a space between"),
        ),
        (
            r"Input is not proper UTF-8|Invalid bytes in character encoding|switching encoding: encoder error",
            _words("it is not UTF-8 text, and does not say what else", "save the file as UTF-8"),
        ),
    )
)

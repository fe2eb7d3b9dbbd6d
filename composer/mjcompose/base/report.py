"""Diagnostics for people and programs: terminal, JSON lines, GitHub, Markdown, JUnit."""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import lru_cache, wraps
from typing import Any, ParamSpec, TypeVar
from xml.etree import ElementTree as Xml

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import CellName, Diagnostic, Severity, Span, listed, masked, plain_data
from mjcompose.base.limits import LimitAdvice
from mjcompose.base.naming import BIDIRECTIONAL, UNSEEN
from mjcompose.base.words import counted

_COLOR = {
    "error": "\x1b[1;31m",
    "warning": "\x1b[1;33m",
    "note": "\x1b[1;36m",
    "help": "\x1b[1;32m",
    "bold": "\x1b[1m",
    **dict.fromkeys(("cell", "cells", "recipe", "recipes"), "\x1b[1;36m"),
    "gutter": "\x1b[34m",
    "code": "\x1b[36m",
    "dim": "\x1b[2m",
    "added": "\x1b[32m",
    "removed": "\x1b[31m",
}


class Paint:
    """Wraps text in a color if enabled. The styles are the keys of `_COLOR`."""

    def __init__(self, enabled: bool) -> None:
        self._enabled = enabled

    def __call__(self, style: str, text: str) -> str:
        return f"{_COLOR[style]}{text}\x1b[0m" if self._enabled else text


ReadSource = Callable[[str], str | None]

_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_TAB = " " * 4
_WINDOW = 160  # screen columns of source shown at most
_BEFORE = 60  # of these, columns before the span
_NEAR = 2000  # characters on each side of a span that are read: a line may be as long as a file
_CONTROL = f"\\x00-\\x08\\x0b-\\x1a\\x1c-\\x1f\\x7f-\\x9f\u2028\u2029{BIDIRECTIONAL}{UNSEEN}"
_UNSAFE = re.compile(f"[\\x1b\ud800-\udfff{_CONTROL}]")
_UNSAFE_WITH_COLORS = re.compile(f"\\x1b(?!\\[[0-9;]*m)|[{_CONTROL}]")
_COMMAND_AT_START = re.compile(r"^(\s*:):", re.MULTILINE)
"""The start of a line that GitHub's runner carries out, such as `::add-mask::`."""
_COMMAND_ANYWHERE = re.compile(r"#(?=#\w*\[)")
"""The start of a command in the middle of a line: `##[error]` on GitHub, `##vso[…]` on Azure, `##teamcity[…]`."""


def render(diagnostic: Diagnostic, read_source: ReadSource | None = None, color: bool = False) -> str:
    """Return the diagnostic as several lines of text, without a final line break.

    `read_source(file)` returns the text of a file, or None if there is none to show; without it, no source lines
    are shown. `color` adds ANSI colors. No I/O of its own.
    """
    spans = [diagnostic.span, *(note.span for note in diagnostic.notes)]
    excerpts = [_excerpt(span, read_source) for span in spans if span is not None]
    margin = max((len(str(excerpt.number)) for excerpt in excerpts if excerpt), default=1)
    paint = Paint(color)
    block = _Block(paint, margin)
    kind = diagnostic.severity.value
    where = "" if diagnostic.span is None else _without_commands(_printable(f"{diagnostic.span}:"))
    place = f"{paint('bold', where)} " if where else ""
    message = paint("bold", " ".join(_printable_lines(diagnostic.message)))
    lines = [f"{place}{paint(kind, f'{kind}[{diagnostic.code}]')}: {message}"]

    following = iter(excerpts)
    if diagnostic.span is not None:
        lines += block.source(next(following), kind, "^")
    if diagnostic.cells:
        lines += block.remark("cell" if len(diagnostic.cells) == 1 else "cells", listed(diagnostic.cells))
    if diagnostic.recipes:
        lines += block.remark("recipe" if len(diagnostic.recipes) == 1 else "recipes", ", ".join(diagnostic.recipes))
    for note in diagnostic.listed():
        if note.span is None:
            lines += block.remark("note", note.message)
        else:
            lines += block.remark("note", f"{note.span}: {note.message}")
            lines += block.source(next(following), "note", "-")
    if diagnostic.help is not None:
        lines += block.remark("help", diagnostic.help)
    return "\n".join(lines)


class _Block(Struct):
    """Draws the parts of one diagnostic, to the right of its line numbers."""

    paint: Paint
    margin: int

    def source(self, excerpt: _Excerpt | None, style: str, mark: str) -> list[str]:
        """Return the line of a file, with marks under the place."""
        if excerpt is None:
            return []
        edge = self.paint("gutter", " " * (self.margin + 1) + "|")
        number = self.paint("gutter", f"{excerpt.number:>{self.margin}} |")
        underline = " " * excerpt.offset + self.paint(style, mark * excerpt.width)
        return [edge, f"{number} {excerpt.text}".rstrip(), f"{edge} {underline}"]

    def remark(self, kind: str, text: str) -> list[str]:
        """Return a note or a help, whose further lines are below the first."""
        first, *rest = _printable_lines(text)
        head = " " * (self.margin + 1) + "= "
        indent = " " * (len(head) + len(kind) + 2)
        return [f"{head}{self.paint(kind, kind)}: {first}", *(f"{indent}{line}".rstrip() for line in rest)]


def with_rest(lines: Sequence[str], shown: int = 8, what: str = "more") -> list[str]:
    """Return the first lines, and the number of the other lines.

    >>> with_rest(["a", "b", "c"], 2)
    ['a', 'b', 'and 1 more']
    """
    return [*lines[:shown], *([f"and {len(lines) - shown} {what}"] if len(lines) > shown else [])]


def printable(text: str, colors: bool = False) -> str:
    r"""Return a text without characters that control a terminal, hide or reorder text; line breaks and tabs stay.

    Commands for the machines of GitHub, Azure and TeamCity are broken. With `colors`, color codes stay too, and so do
    bytes of file names that are not text in this locale.
    """
    unsafe = _UNSAFE_WITH_COLORS if colors else _UNSAFE
    return _without_commands(unsafe.sub(lambda found: _stand_in(found[0]), text.replace("\r\n", "\n")))


def _without_commands(text: str) -> str:
    return _COMMAND_AT_START.sub("\\1\ufffd", _COMMAND_ANYWHERE.sub("\ufffd", text))


def one_line(text: str) -> str:
    r"""Return a text, such as a name or a path, on one line; `printable` replaces its other characters.

    >>> one_line("arm\n::error::")
    'arm␊::error::'
    """
    return re.sub(r"[\t\n\r]", lambda found: _stand_in(found[0]), text)


def as_lines(lines: Iterable[str]) -> str:
    """Return lines as a text. A line break in one of them comes from a name, and does not start another line."""
    return "\n".join(map(one_line, lines))


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    found = [each.severity for each in diagnostics]
    return ", ".join(counted(found.count(each), each.value) for each in Severity if each in found) or "no errors"


class _Excerpt(Struct):
    number: int
    text: str
    offset: int
    width: int


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
    text = _COMMAND_ANYWHERE.sub("\ufffd", "".join(shown for shown, _ in cells[left:right]))
    offset = sum(widths[left:start])
    width = max(sum(widths[start : min(end, right)]), 1)
    if left + skipped > 0:
        text = "…" + text
        offset = offset + 1
    if right < len(cells) or skipped + len(line) < len(whole):
        text += "…"
    return _Excerpt(span.line, text, offset, width=width)


def _window(widths: list[int], start: int) -> tuple[int, int]:
    if sum(widths) <= _WINDOW:
        return 0, len(widths)
    left = start
    used = 0
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
    if " " <= character <= "~":
        return character, 1
    if character == "\t":
        return _TAB, len(_TAB)
    category = unicodedata.category(character)
    if category in ("Cc", "Cs", "Zl", "Zp") or _UNSAFE.match(character):
        return _stand_in(character), 1
    if category in ("Mn", "Me", "Cf"):
        return character, 0
    return character, 2 if unicodedata.east_asian_width(character) in "WF" else 1


def _stand_in(character: str) -> str:
    return chr(0x2400 + ord(character)) if character < " " else "\ufffd"


def _printable(text: str) -> str:
    return "".join(_TAB if character == "\t" else _cell(character)[0] for character in text)


def _printable_lines(text: str) -> list[str]:
    return [_without_commands(_printable(line)) for line in _LINE_BREAK.split(text)]


def json_text(data: object, *, ensure_ascii: bool = True, **options: Any) -> str:
    r"""Return data as JSON that a terminal or a log can show: the escapes of JSON replace everything that acts on them.

    Bytes of file names that are not UTF-8 are escapes, too, so the text can be encoded.

    >>> json_text({"name": "##[add-mask]\u202e"}, ensure_ascii=False)
    '{"name": "\\u0023#[add-mask]\\u202e"}'
    """
    text = json.dumps(data, ensure_ascii=ensure_ascii, **options)
    text = _COMMAND_ANYWHERE.sub(r"\\u0023", text)
    return text if ensure_ascii else _UNSAFE.sub(lambda found: json.dumps(found[0])[1:-1], text)


_KEYS = ("severity", "code", "message", "span", "notes", "help", "fix", "others", "cells", "recipes")


def render_json_format(diagnostic: Diagnostic) -> str:
    """Return one JSON object on one line, ASCII only, with the same keys for every diagnostic."""
    known = {**plain_data(diagnostic), "fix": _fix(diagnostic)}
    return json_text({key: known[key] for key in _KEYS})


def _fix(diagnostic: Diagnostic) -> dict[str, Any] | None:
    fix = diagnostic.fix
    if fix is None or fix.replaces is not None:  # `tools.fix.exact` gives a name its quotes
        return None
    span = fix.span or diagnostic.span
    return {"replacement": fix.replacement, "span": span and plain_data(span)}


_COMMAND = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def render_github(diagnostic: Diagnostic) -> str:
    """Return one workflow command on one line; notes and help follow the message."""
    span = diagnostic.span
    properties: dict[str, str | int] = {}
    if span is not None:
        properties |= {"file": span.file, "line": span.line, "col": span.column}
        if span.end_line is not None:
            properties["endLine"] = span.end_line
        # GitHub accepts columns only within one line.
        if span.end_column is not None and span.end_line in (None, span.line):
            properties["endColumn"] = span.end_column
    cells = diagnostic.cells
    in_cells = f" in {cells[0].name if len(cells) == 1 else f'{len(cells)} cells'}" if cells else ""
    properties["title"] = diagnostic.code + in_cells

    return command(_COMMAND[diagnostic.severity], "\n".join([diagnostic.message, *remarks(diagnostic)]), properties)


def remarks(diagnostic: Diagnostic) -> Iterator[str]:
    """Yield the notes, the cells, the recipes and the help of a diagnostic as text."""
    for note in diagnostic.listed():
        yield f"note: {note.span}: {note.message}" if note.span else f"note: {note.message}"
    if len(diagnostic.cells) > 1:
        yield f"cells: {listed(diagnostic.cells)}"
    if diagnostic.recipes:
        yield f"recipes: {', '.join(diagnostic.recipes)}"
    if diagnostic.help is not None:
        yield f"help: {diagnostic.help}"


def render_markdown(diagnostic: Diagnostic) -> str:
    """Return an item of a list in Markdown, with the remarks below it.

    >>> print(render_markdown(Diagnostic("bad-name", "no", Span("a.yaml", 2, 1), help="rename it")))
    - `a.yaml:2:1`: **error** `bad-name`: no
      - help: rename it
    """
    place = f"{code_span(str(diagnostic.span))}: " if diagnostic.span else ""
    head = (
        f"- {place}**{diagnostic.severity.value}** `{diagnostic.code}`: {markdown_text(one_line(diagnostic.message))}"
    )
    items = [head, *(f"  - {markdown_text(each)}" for each in remarks(diagnostic))]
    return "\n".join(each.replace("\n", "\n    ") for each in items)


_MARKUP = re.compile(r"[\\*_<>#|\[\]~&]")
_BLOCK = re.compile(r"^(\s*\d*)([-+=.)])", re.MULTILINE)
"""A list item or an underlined heading."""


def markdown_text(text: str) -> str:
    r"""Return a text with names between backticks as Markdown that shows just this text.

    A code span shows its content as it is. Elsewhere, nothing is markup, HTML or a mention of a person.

    >>> print(markdown_text("`a*b` has a <b>, says @me"))
    `a*b` has a \<b\>, says `@`me
    """
    *pieces, last = printable(text).split("`")
    shown = [_plain(piece) if number % 2 == 0 else code_span(piece) for number, piece in enumerate(pieces)]
    if len(pieces) % 2:  # the last backtick has no partner
        shown[-1] += "\\`"
    return "".join([*shown, _plain(last)])


def _plain(text: str) -> str:
    text = _MARKUP.sub(r"\\\g<0>", text)
    return _BLOCK.sub(r"\1\\\2", text).replace("@", "`@`")


def code_span(text: str) -> str:
    """Return a text as a code span of Markdown, whatever backticks it has."""
    text = one_line(printable(text))
    if not text:
        return "\\`\\`"
    fence = "`" * (1 + max(map(len, re.findall("`*", text))))
    return f"{fence}{text}{fence}" if fence == "`" else f"{fence} {text} {fence}"


def command(kind: str, message: str, properties: Mapping[str, str | int]) -> str:
    values = {name: _data(str(value)).replace(":", "%3A").replace(",", "%2C") for name, value in properties.items()}
    return f"::{kind} {','.join(f'{name}={value}' for name, value in values.items())}::{_data(message)}"


def _data(text: str) -> str:
    return printable(text).replace("%", "%25").replace("\n", "%0A")


_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class Case(Struct):
    """One test: `kind` is the kind of test, and `errors` are its failures. Without errors it passes."""

    name: str
    kind: str
    errors: Sequence[Diagnostic] = ()
    file: str | None = None
    line: int | None = None


class Suite(Struct):
    """The tests of one file, or of one of its cells."""

    name: str
    cases: Sequence[Case]
    cell: CellName | None = None


def report(suites: Iterable[Suite], read: ReadSource) -> str:
    """Return the text of the whole file. No I/O except `read`."""
    root = Xml.Element("testsuites", {"name": "mjcompose"})
    for suite in suites:
        failures = sum(bool(case.errors) for case in suite.cases)
        counts = {"tests": str(len(suite.cases)), "failures": str(failures), "errors": "0", "skipped": "0"}
        element = Xml.SubElement(root, "testsuite", {"name": _text(suite.name), **counts})
        if suite.cell is not None:
            listed = Xml.SubElement(element, "properties")
            for name, value in asdict(suite.cell).items():
                if value is not None:
                    Xml.SubElement(listed, "property", {"name": name, "value": _text(str(value))})
        for case in suite.cases:
            place = {"file": case.file, "line": None if case.line is None else str(case.line)}
            about = {"classname": f"{suite.name}.{case.kind}", "name": case.name, **place}
            known = {key: _text(value) for key, value in about.items() if value is not None}
            row = Xml.SubElement(element, "testcase", known)
            if case.errors:
                first = case.errors[0]
                failure = Xml.SubElement(row, "failure", {"type": first.code, "message": _text(first.message)})
                failure.text = _text("\n\n".join(render(each, read) for each in case.errors))
    Xml.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{Xml.tostring(root, encoding="unicode")}\n'


def _text(text: str) -> str:
    """Replace control characters, and characters that XML does not allow."""
    return _NO_XML.sub("\ufffd", printable(text))


Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")


def short_traceback(function: Callable[Parameters, Result]) -> Callable[Parameters, Result]:
    """Make the tracebacks of a public function's errors end at the caller's line, without the lines in this package."""

    @wraps(function)
    def call(*arguments: Parameters.args, **named: Parameters.kwargs) -> Result:
        try:
            return function(*arguments, **named)
        except MjcomposeError as error:
            raise error.with_traceback(None)  # noqa: B904  # it is the same exception

    return call


class MjcomposeError(Exception):
    """Raised to Python callers if the input has errors; carries every diagnostic. `str()` has no source lines."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(
            replace(each, help=each.help.in_python) if isinstance(each.help, LimitAdvice) else each
            for each in diagnostics
        )
        super().__init__(self.diagnostics)

    def __str__(self) -> str:
        return "\n".join(render(each) for each in self.diagnostics)

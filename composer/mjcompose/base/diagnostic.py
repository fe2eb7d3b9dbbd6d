"""A finding about the user's input, as data: its place, its notes, its fix, and the exceptions that carry it."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable, Iterable
from dataclasses import asdict, field, replace
from enum import StrEnum
from types import FrameType
from typing import Any

from mjcompose.base.dataclass import Struct


class Span(Struct):
    """A stretch of characters in a file.

    Lines and columns count from 1, columns in characters (not bytes or screen cells). The end is exclusive; without
    an end the span is a single position. `file` is the path that the user can open. `template` is the text with `${…}`
    that is written there, or the first one in a list: it computes the value at this place.

    `turn` says which values a `for` has there, if the value depends on them; it is empty for other values that a `for`
    repeats. `source` is the place in a table that has the value.
    """

    file: str
    line: int
    column: int
    end_line: int | None = None
    end_column: int | None = None
    template: str | None = field(default=None, compare=False, repr=False)
    turn: str | None = field(default=None, compare=False, repr=False)
    source: Span | None = field(default=None, compare=False, repr=False)

    def is_in(self, file: str) -> bool:
        """Return whether the place is in a file; the first folders of its path may be left out."""
        return self.file == file or self.file.endswith(f"/{file}")

    def repeated(self, turn: str) -> Span:
        """Return the place with the values that a `for` has there."""
        return Span(self.file, self.line, self.column, self.end_line, self.end_column, self.template, turn, self.source)

    def taken_from(self, source: Span | None) -> Span:
        """Return the place with the place of its value in a table, if there is one."""
        if source is None:
            return self
        return Span(self.file, self.line, self.column, self.end_line, self.end_column, self.template, self.turn, source)

    @property
    def where(self) -> str:
        """The turn of a `for`, in words that follow the place."""
        return f" where {self.turn}" if self.turn else ""

    @property
    def origin(self) -> str:
        """The turn of a `for` and the row of a table that has the value, in words that follow the place."""
        return self.where + ("" if self.source is None else f", from {self.source.file}:{self.source.line}")

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


OWN_FIELDS = frozenset({"template", "turn", "source"})
"""The fields of a `Span` that only mjcompose uses."""


def plain_data(value: Any) -> dict[str, Any]:
    """Return a Struct with places as data for other programs.

    >>> plain_data(Span("a.yaml", 1, 7, template="${x}"))
    {'file': 'a.yaml', 'line': 1, 'column': 7, 'end_line': None, 'end_column': None}
    """
    data: dict[str, Any] = asdict(
        value, dict_factory=lambda items: {key: each for key, each in items if key not in OWN_FIELDS}
    )
    return data


class Fix(Struct):
    """A replacement for a stretch of text.

    If `replaces` is set, it is the name to replace, without quotes. The new name gets quotes if it needs them.
    Otherwise `replacement` is verbatim text. If `span` is None, the place of the diagnostic counts. An empty span is an
    insertion point.
    """

    replacement: str
    replaces: str | None = None
    span: Span | None = None


_LOGIN = re.compile(r"(?<=://)([^/\s@:]*:|(?=gh[opsur]_|github_pat_|glpat-))([^/\s@]+)(?=@)")
_PARAMETER = re.compile(r"""([?&;]([^=&;#?\s"'`]+)=)((?:(?!@sha256:)[^&;#\s"'`])+)""")
_NAME = re.compile(
    r".*(token|secret|password|passwd|passphrase|signature|(api|access|private)[-_]?key|credentials?|authorization)"
    r"|(.*[-_])?(sig|pwd|pass|auth|jwt)",
    re.IGNORECASE,
)


def hide(text: str, shown: Callable[[str], str] = lambda secret: "…") -> str:
    """Return a text in which `shown` replaces each secret of an address. No I/O.

    >>> hide("https://me:1234@host/a.zip?raw=1&Access_Token=5678#x.xml")
    'https://me:…@host/a.zip?raw=1&Access_Token=…#x.xml'
    """

    def parameter(found: re.Match[str]) -> str:
        from urllib.parse import unquote  # few texts have a query

        is_secret = _NAME.fullmatch(unquote(found[2]))
        return found[1] + shown(found[3]) if is_secret else found[0]

    if "=" in text:
        text = _PARAMETER.sub(parameter, text)
    return _LOGIN.sub(lambda found: found[1] + shown(found[2]), text) if "://" in text else text


def masked(line: str) -> str:
    """Return a source line with secrets as asterisks. Its length stays the same. No I/O."""
    return hide(line, lambda secret: "*" * len(secret))


def caller() -> FrameType:
    """Return the innermost frame of the call stack outside this package: the program's."""
    frame = sys._getframe(1)
    while frame.f_back is not None and f"{frame.f_globals.get('__name__', '')}.".startswith("mjcompose."):
        frame = frame.f_back
    return frame


def call_site() -> Span:
    """Return the innermost line of the call stack outside of this package."""
    frame = caller()
    return Span(frame.f_code.co_filename, frame.f_lineno, 1)


class CellName(Struct):
    """A model of a recipe; `name` is its argument for `--pick`.

    `cell` is the cell of the matrix, None without a matrix. `sample` is its number, None if nothing is drawn.
    """

    name: str
    cell: str | None = None
    sample: int | None = None


def listed(cells: Iterable[CellName]) -> str:
    """Return all of them on one line; consecutive samples of one cell become a range.

    >>> listed([CellName("a-1kg", "a-1kg"), CellName("a-2kg", "a-2kg")])
    'a-1kg, a-2kg'
    >>> listed([CellName(f"a-s000{n}", None, n) for n in (0, 1, 2, 4)])
    'a-s0000 … a-s0002, a-s0004'
    """
    ranges: list[list[CellName]] = []
    for each in cells:
        last = ranges[-1][-1] if ranges else None
        if last is not None and last.sample is not None and (each.cell, each.sample) == (last.cell, last.sample + 1):
            ranges[-1].append(each)
        else:
            ranges.append([each])
    named = ([each.name for each in cells] for cells in ranges)
    return ", ".join(f"{names[0]} … {names[-1]}" if len(names) > 2 else ", ".join(names) for names in named)


class Severity(StrEnum):
    """The severity of a diagnostic. Only an `ERROR` stops the work."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Note(Struct):
    """A remark that helps to understand a diagnostic, with the place that it is about, if any."""

    message: str
    span: Span | None = None


class Cause(Struct):
    """Merges findings with the same code, severity and `key`; `subject` names a later finding in the list."""

    key: str
    subject: str


class Diagnostic(Struct):
    """A message with its code, its place, remarks such as the existing names (`notes`), and instructions (`help`).

    `code` is one of `CODES`. The first line of `help` is a sentence, and further lines are text to paste into the file.
    `others` lists further places with the same cause. `cells` are the models that it is about, in a run over several
    models of a recipe. It is empty if the diagnostic is about the recipe as a whole. `recipes` are its recipes, in a
    run over several. `subjects` are the names that it is about: if an earlier error removed one of them, this error
    only follows from that one. `fix` is the exact change that `help` describes, if there is one.
    """

    code: str
    message: str
    span: Span | None = None
    severity: Severity = Severity.ERROR
    notes: tuple[Note, ...] = ()
    help: str | None = None
    others: tuple[Note, ...] = ()
    cells: tuple[CellName, ...] = ()
    recipes: tuple[str, ...] = ()
    subjects: frozenset[str] = field(default=frozenset(), compare=False)
    fix: Fix | None = field(default=None, compare=False)

    def listed(self) -> tuple[Note, ...]:
        """Return the notes, and a note that lists the first of the `others`, one on each line."""
        if not self.others:
            return self.notes
        lines = [f"{len(self.others)} more like this:"]
        for each in self.others[:_SHOWN]:
            message = " ".join(each.message.splitlines())
            lines.append(f"{each.span}: {message}" if each.span else message)
        if len(self.others) > _SHOWN:
            lines.append(f"… and {len(self.others) - _SHOWN} more")
        return (*self.notes, Note("\n".join(lines)))


_SHOWN = 8


class DiagnosticError(Exception):
    """An error in the input that the caller reports; `code` is one of `CODES`.

    >>> error = DiagnosticError("bad-name", "no", notes=["why"])
    >>> str(error), error.at(Span("a.yaml", 1, 2)).span
    ('no', Span(file='a.yaml', line=1, column=2, end_line=None, end_column=None))
    """

    def __init__(self, code: str, message: str, help: str | None = None, *, notes: Iterable[str | Note] = ()) -> None:
        super().__init__(message)
        all_notes = tuple(Note(each) if isinstance(each, str) else each for each in notes)
        self.diagnostic = Diagnostic(code, message, notes=all_notes, help=help)
        self.code = code
        self.message = message
        self.help = help
        self.notes = tuple(note.message for note in all_notes)

    def at(self, span: Span, notes: Iterable[Note] = ()) -> Diagnostic:
        """Return the diagnostic at the caller's place, with the caller's notes after its own."""
        return replace(self.diagnostic, span=span, notes=(*self.diagnostic.notes, *notes))


Path = tuple[str | int, ...]


class Fault(Struct):
    """A diagnostic whose place in the file is not looked up yet.

    `at` is the path from the validated value; with `key` the fault lies in the key at the end of `at`. `related`
    are further notes, each with a path from the same value. `within` has line, column and width of the fault in a
    text of several lines. `lacks` is the key that is missing in the mapping at `at`, or with `beside` in the
    mapping that has the key at the end of `at`. `names` are the missing or superfluous keys. A `fix` without a span
    applies to the place of the fault.
    """

    code: str
    message: str
    at: Path = ()
    key: bool = False
    notes: tuple[Note, ...] = ()
    help: str | None = None
    related: tuple[tuple[str, Path], ...] = ()
    within: tuple[int, int, int] | None = None
    lacks: str | None = None
    beside: bool = False
    names: tuple[str, ...] = ()
    fix: Fix | None = None

    def all_notes(self) -> list[Note]:
        """Return the notes, followed by the related ones without their places."""
        return [*self.notes, *(Note(message) for message, _ in self.related)]


def log(message: str, *arguments: object, level: int = 20) -> None:
    """Log a message under `mjcompose`. The default level is that of `logging.INFO`; 10 is `logging.DEBUG`.

    >>> import logging
    >>> handler = logging.StreamHandler(sys.stdout)
    >>> logger = logging.getLogger("mjcompose")
    >>> logger.addHandler(handler)
    >>> log("built %s", "cell", level=logging.WARNING)
    built cell
    >>> logger.removeHandler(handler)
    """
    logging = sys.modules.get("logging")
    if logging is not None:
        logging.getLogger("mjcompose").log(level, message, *arguments)


def warn(message: str, category: type[Warning]) -> None:
    """Warn at the innermost line of the call stack outside this package, as Python's own warnings do."""
    frame = caller()
    module = str(frame.f_globals.get("__name__", "<unknown>"))
    registry = frame.f_globals.setdefault("__warningregistry__", {})
    warnings.warn_explicit(
        message, category, frame.f_code.co_filename, frame.f_lineno, module=module, registry=registry
    )

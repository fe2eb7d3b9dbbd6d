"""Apply the fixes of diagnostics until there is nothing left to fix."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import field, replace
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Fix, Severity, Span
from mjcompose.base.files import RECIPES, read_regular, unsaved
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.build.plan.read import Given
from mjcompose.build.stages import Request, build
from mjcompose.sources.context import Context
from mjcompose.text.faults import quoted, word

_CLOSING = {"[": "]", "{": "}"}


class Edit(Struct):
    """Replaces the characters from `start` up to `end` by `text`."""

    start: int
    end: int
    text: str

    def meets(self, other: Edit) -> bool:
        return self.start == other.start or (self.start < other.end and other.start < self.end)


def edit_of(diagnostic: Diagnostic, source: str) -> Edit | None:
    """Return the change to a file's text for a diagnostic's fix, or None if there is no fix or it does not fit.

    >>> span = Span("a.yaml", 1, 7, 1, 13)
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("arm/tip", "tipp")), 'site: "tipp"')
    Edit(start=6, end=12, text='"arm/tip"')
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("tip", "tipp")), 'site: "other"')
    """
    fix, span = diagnostic.fix, place_of(diagnostic)
    if fix is None or span is None:
        return None
    bounds = _bounds(span, source, is_verbatim=fix.replaces is None and fix.span is not None)
    if bounds is None:
        return None
    start, end = bounds
    written = source[start:end]
    text = fix.replacement if fix.replaces is None else _renamed(written, fix, span.file.endswith(RECIPES))
    # The span of a list over several lines ends with its first line.
    if text is None or (fix.replaces is None and written[:1] in _CLOSING and written[-1] != _CLOSING[written[0]]):
        return None
    return Edit(start, end, text)


def exact(diagnostic: Diagnostic, source: str) -> Diagnostic:
    """Return the diagnostic with the verbatim text of its fix, including quotes, or without a fix that does not fit."""
    if diagnostic.fix is None:
        return diagnostic
    edit = edit_of(diagnostic, source)
    return replace(diagnostic, fix=None if edit is None else Fix(edit.text, None, place_of(diagnostic)))


def place_of(diagnostic: Diagnostic) -> Span | None:
    return diagnostic.fix.span or diagnostic.span if diagnostic.fix is not None else None


def applied(source: str, edits: Iterable[Edit]) -> str:
    """Return the text with all changes; if two changes overlap, only the first one is made.

    >>> applied("a b c", [Edit(0, 1, "x"), Edit(4, 5, "z"), Edit(0, 3, "y")])
    'x b z'
    """
    result, done = "", 0
    for edit in sorted(dict.fromkeys(edits), key=lambda each: (each.start, each.end)):
        if edit.start >= done:
            result += source[done : edit.start] + edit.text
            done = edit.end
    return result + source[done:]


def _bounds(span: Span, source: str, is_verbatim: bool = False) -> tuple[int, int] | None:
    """Return the positions of a span, or None for several lines of a text that is not replaced verbatim.

    A span without an end is empty.
    """
    last = span.end_line or span.line
    if last != span.line and not is_verbatim:
        return None
    begins = [0, *(found.end() for found in re.finditer(r"\r\n|\n|\r", source))]
    if not 1 <= span.line <= last <= len(begins):
        return None
    start = begins[span.line - 1] + span.column - 1
    end = start if span.end_column is None else begins[last - 1] + span.end_column - 1
    line_end = begins[last] if last < len(begins) else len(source)
    return (start, end) if start <= end <= line_end else None


def _renamed(written: str, fix: Fix, is_yaml: bool) -> str | None:
    """Return another name in the necessary quotes, or None if the old one is not in the text."""
    quotes = written[:1] if written[:1] in ("'", '"') and written[-1:] == written[:1] and len(written) > 1 else ""
    if (written[1:-1] if quotes else written) != fix.replaces:
        return None
    if not is_yaml:
        return f"{quotes}{fix.replacement}{quotes}"
    return quoted(fix.replacement) if quotes else word(fix.replacement)


_ROUNDS = 50


class Fixed(Struct, frozen=False):
    """The result of fixing a recipe.

    `files` has the texts before and after by path. `fixed` has the fixed diagnostics, and `left` has the others.
    """

    files: dict[Path, tuple[bytes, bytes]] = field(default_factory=dict)
    fixed: list[Diagnostic] = field(default_factory=list)
    left: tuple[Diagnostic, ...] = ()


def fix(recipe: Path, context: Context, given: Given | None = None) -> Fixed:
    """Return the fixed texts of a recipe and of the user's own recipes that it uses; nothing is written.

    A fix that does not remove its fault is reverted. MuJoCo compiles only the units that the linker has to measure.
    """

    def look(context: Context) -> list[Diagnostic]:
        build(Request(recipe, given or {}, verified=False), context)
        return context.sink.sorted()

    return Fixing(look, context).fixed()


class Fixing(Struct, frozen=False):
    """Applies the fixes of the diagnostics that `look` finds, in files with these suffixes."""

    look: Callable[[Context], list[Diagnostic]]
    context: Context
    suffixes: tuple[str, ...] = RECIPES
    now: dict[Path, bytes] = field(default_factory=dict)
    before: dict[Path, bytes] = field(default_factory=dict)
    useless: set[tuple[str, str, str]] = field(default_factory=set)
    at_once: int | None = None

    def fixed(self) -> Fixed:
        result, left = Fixed(), self.found()
        for _ in range(_ROUNDS):
            earlier = dict(self.now)
            tried = self.carry_out(left)
            if not tried:
                break
            after = self.found()
            useless = _persisting(left, tried, after)
            known = set(map(_identity, left))
            if self._breaks(left, [each for each in after if _identity(each) not in known]):
                useless = set(map(_identity, tried)) if len(tried) == 1 else set()
                self.at_once = 1  # trying single fixes shows which of them fails
            elif not useless:
                result.fixed += tried
                left = after
                continue
            self.now = earlier
            self.useless |= useless
        result.left = tuple(left)
        result.files = {
            path: (text, self.now[path]) for path, text in self.before.items() if self.now.get(path, text) != text
        }
        return result

    def _breaks(self, before: list[Diagnostic], new: list[Diagnostic]) -> bool:
        """Return whether a correct file has become wrong, because a corrected name may exist already."""
        was_right = not any(each.severity is Severity.ERROR for each in before)
        return any(
            each.code.startswith(("yaml-", "xml-")) or (was_right and each.severity is Severity.ERROR) for each in new
        )

    def found(self) -> list[Diagnostic]:
        """Return the diagnostics for the current texts."""
        texts = {os.path.realpath(path): text for path, text in self.now.items()}
        context = replace(self.context, sink=Sink(), recipes={}, concrete={})
        with unsaved(texts):
            return self.look(context)

    def carry_out(self, found: list[Diagnostic]) -> list[Diagnostic]:
        """Apply the fixes that fit and do not overlap; return their diagnostics."""
        edits: dict[Path, dict[Edit, Diagnostic]] = {}
        for diagnostic in found:
            span = place_of(diagnostic)
            if span is None or _identity(diagnostic) in self.useless:
                continue
            path = Path(os.path.normpath(self.context.folder / span.file))
            if self.at_once is not None and sum(map(len, edits.values())) == self.at_once:
                break
            edit = edit_of(diagnostic, _decoded(self.text(path))) if self.is_own(path) else None
            if edit is not None and not any(edit.meets(other) for other in edits.get(path, ())):
                edits.setdefault(path, {})[edit] = diagnostic
        for path, each in edits.items():
            mark = b"\xef\xbb\xbf" if self.text(path).startswith(b"\xef\xbb\xbf") else b""
            self.now[path] = mark + applied(_decoded(self.text(path)), each).encode()
        return [diagnostic for each in edits.values() for diagnostic in each.values()]

    def text(self, path: Path) -> bytes:
        if path not in self.now:
            self.now[path] = read_regular(path, in_force().xml_size)
        self.before.setdefault(path, self.now[path])
        return self.now[path]

    def is_own(self, path: Path) -> bool:
        """Return whether it is the user's own file, not a fetched or installed file."""
        fetching = self.context.fetching
        fetched = fetching is not None and fetching.around(path) is not None
        return path.suffix.lower() in self.suffixes and os.path.isfile(path) and not fetched


def _identity(diagnostic: Diagnostic) -> tuple[str, str, str]:
    """Return a finding without its place, which a fix above it moves."""
    return (diagnostic.span.file if diagnostic.span is not None else ""), diagnostic.code, diagnostic.message


def _persisting(
    before: list[Diagnostic], tried: list[Diagnostic], after: list[Diagnostic]
) -> set[tuple[str, str, str]]:
    """Return the findings in `tried` that still occur; equal findings are counted."""
    made = Counter(map(_identity, tried))
    others = Counter(map(_identity, before)) - made
    now = Counter(map(_identity, after))
    return {each for each in made if now[each] > others[each]}


def _decoded(text: bytes) -> str:
    """Return the text of a recipe; text that is not UTF-8 has no fixes."""
    with suppress(UnicodeDecodeError):
        return text.decode("utf-8-sig")
    return ""

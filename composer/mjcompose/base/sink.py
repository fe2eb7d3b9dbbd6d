"""A `Sink` collects the diagnostics of all stages, so one run reports all of them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any, NamedTuple

from mjcompose.base.codes import CODES
from mjcompose.base.diagnostic import Cause, CellName, Diagnostic, DiagnosticError, Fix, Note, Severity, Span
from mjcompose.base.files import MJCF_FILES, URDF_FILES
from mjcompose.base.limits import advice, in_force
from mjcompose.base.suggest import without_constant

_OF_UNKNOWN_NAMES = ("unknown-name", "attach-place", "selector")
_STEP = re.compile(r"[/:.\s]")
_SEVERITIES = tuple(Severity)


class TooManyFaults(Exception):
    """There are more errors than the limit; `sink` has the errors found so far."""

    def __init__(self, sink: Sink) -> None:
        super().__init__(f"more than {in_force().faults} errors; the first one is: {sink.errors[0].message}")
        self.sink = sink


class LaterName(NamedTuple):
    """The names that the entry at `span` gives elements when it is carried out, and the text that gives them."""

    text: str
    names: re.Pattern[str]
    span: Span


class Sink:
    """Collects diagnostics in the order they are found; equal diagnostics are kept once.

    A code that is not in `CODES` is a bug of the caller and raises `KeyError`. Exceeding the limit `faults` raises
    `TooManyFaults`. A block `with sink:` ends at a `DiagnosticError`, whose diagnostic is added.
    """

    def __init__(self) -> None:
        # A dict keeps the order of insertion and finds repetitions; its values are further findings of one cause.
        self._found: dict[Diagnostic, dict[Note, None]] = {}
        self._causes: dict[tuple[str, Severity, str], Diagnostic] = {}
        self._cells: dict[Diagnostic, dict[CellName, None]] = {}
        self._kin: dict[tuple[str, Severity, Span | str], list[Diagnostic]] = {}
        self._recipes: dict[Diagnostic, dict[str, None]] = {}
        self.error_count = 0
        """The number of errors, including reported and suppressed ones."""
        self._lost: set[str] = set()
        self._later: list[LaterName] = []
        self._errors = 0

    def suppress_about(self, names: Iterable[str]) -> None:
        """Suppress errors about names that an earlier error removed, and names below; they still stop the work."""
        self._lost.update(names)

    def marked(self) -> Callable[[], None]:
        """Return a function that removes everything added from now on."""

        def copied(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: copied(each) for key, each in value.items()}
            return value.copy() if isinstance(value, list | set) else value

        before = copied(vars(self))
        return lambda: vars(self).update(before)

    def fork(self) -> Sink:
        """Return an empty `Sink` that suppresses the same names."""
        sink = Sink()
        sink.suppress_about(self._lost)
        sink._later = [*self._later]
        return sink

    @contextmanager
    def naming_later(self, names: Iterable[LaterName]) -> Iterator[None]:
        """Note with errors about unknown names that these entries give elements such names, until they have done so."""
        before = self._later
        self._later = [*before, *names]
        try:
            yield
        finally:
            self._later = before

    def has_named(self, span: Span) -> None:
        """Remember that the entry at `span` is carried out."""
        self._later = [later for later in self._later if (later.span, later.span.turn) != (span, span.turn)]

    def suppresses(self, name: str) -> bool:
        """Return whether an earlier error may be the reason that this name does not exist."""
        return name in self._lost or not self._lost.isdisjoint(_STEP.split(name))

    def add(self, diagnostic: Diagnostic, cause: Cause | None = None) -> None:
        if diagnostic.code not in CODES:
            raise KeyError(diagnostic.code)
        if cause is None:
            cause = _cause(diagnostic)
        diagnostic = _at_source(_with_turn(self._with_later_names(without_constant(diagnostic))))
        if diagnostic.severity is Severity.ERROR:
            self.error_count += 1
        if diagnostic in self._found:
            return
        if self._lost and (diagnostic.severity is not Severity.ERROR or any(map(self.suppresses, diagnostic.subjects))):
            return
        if cause is not None:
            first = self._causes.setdefault((diagnostic.code, diagnostic.severity, cause.key), diagnostic)
            if first is not diagnostic and Note(cause.subject) not in first.notes:  # two faults of one turn differ
                self._found[first][Note(cause.subject, diagnostic.span)] = None
                return
        self._found[diagnostic] = {}
        if diagnostic.severity is Severity.ERROR:
            self._errors += 1
            most = in_force().faults
            if self._errors == most + 1:
                message = f"there are more than {most} errors; mjcompose stopped looking for others"
                self._found[Diagnostic("limit-exceeded", message, None, help=advice("faults"))] = {}
                raise TooManyFaults(self)

    def _with_later_names(self, diagnostic: Diagnostic) -> Diagnostic:
        """Return an error about an unknown name with a note on the entry that gives an element this name later."""
        if not self._later or diagnostic.code not in _OF_UNKNOWN_NAMES:
            return diagnostic
        for later in self._later:
            note = Note(f"`rename: {later.text}` comes after this: write the name before it here", later.span)
            # An error that a fork has added has the note already.
            if any(map(later.names.fullmatch, diagnostic.subjects)) and note not in diagnostic.notes:
                return replace(diagnostic, notes=(*diagnostic.notes, note))
        return diagnostic

    def __enter__(self) -> Sink:
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if isinstance(error, DiagnosticError):
            self.add(error.diagnostic)
        return isinstance(error, DiagnosticError)

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        for each in diagnostics:
            self.add(each)

    def drop(self, diagnostic: Diagnostic) -> None:
        """Remove a warning or a note, and all findings with the same cause, because the user has accepted it."""
        if diagnostic.severity is Severity.ERROR:
            raise ValueError("an error cannot be dropped")
        for found in [each for each in self._found if self._whole(each) == diagnostic]:
            del self._found[found]
            self._causes = {key: first for key, first in self._causes.items() if first is not found}

    def promote(self) -> None:
        """Turn all warnings into errors."""
        found = self._found
        self._found = {}
        for diagnostic, others in found.items():
            if diagnostic.severity is not Severity.WARNING:
                self._found[diagnostic] = others
                continue
            self.error_count += 1
            promoted = replace(diagnostic, severity=Severity.ERROR)
            self._found[promoted] = others
            self._causes = {key: promoted if first is diagnostic else first for key, first in self._causes.items()}
            if diagnostic in self._cells:
                self._cells[promoted] = self._cells.pop(diagnostic)

    def add_of_cell(self, cell: CellName, diagnostic: Diagnostic) -> None:
        """Add a finding of one cell; findings of several cells with the same code and place become one that lists the
        cells.

        Its `others` have messages about a cell that differ, for example in a number. Diagnostics about the recipe as a
        whole stay without a cell.
        """
        if diagnostic in self._found and diagnostic not in self._cells:
            return
        place = diagnostic.span or diagnostic.help  # without a place, the help identifies it
        kin = [] if place is None else self._kin.setdefault((diagnostic.code, diagnostic.severity, place), [])
        first = next((each for each in kin if cell not in self._cells.get(each, ())), None)
        if diagnostic in self._found or first is None:
            self.add(diagnostic)
            if diagnostic in self._found:
                if diagnostic not in self._cells:
                    kin.append(diagnostic)
                self._cells.setdefault(diagnostic, {})[cell] = None
            return
        self.error_count += diagnostic.severity is Severity.ERROR
        self._cells[first][cell] = None
        said = diagnostic.message
        if said == first.message:  # the notes may list other names there
            said = "; ".join(note.message for note in diagnostic.notes if note not in first.notes)
        more = [Note(f"{cell.name}: {said}")] if said else []
        self._found[first].update(dict.fromkeys([*more, *diagnostic.others]))

    def add_of_recipe(self, recipe: str, diagnostic: Diagnostic) -> None:
        """Add a finding of one of several recipes; equal findings become one that lists the recipes."""
        self.add(diagnostic)
        if diagnostic in self._found:
            self._recipes.setdefault(diagnostic, {})[recipe] = None

    def error(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
        cause: Cause | None = None,
        subjects: Iterable[str | None] = (),
        fix: Fix | None = None,
    ) -> None:
        names = frozenset(name for name in subjects if name)
        self.add(Diagnostic(code, message, span, notes=tuple(notes), help=help, subjects=names, fix=fix), cause)

    def warning(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
        cause: Cause | None = None,
        fix: Fix | None = None,
    ) -> None:
        severity = Severity.WARNING
        self.add(Diagnostic(code, message, span, severity=severity, notes=tuple(notes), help=help, fix=fix), cause)

    def note(
        self,
        code: str,
        message: str,
        span: Span | None = None,
        *,
        notes: Iterable[Note] = (),
        help: str | None = None,
        cause: Cause | None = None,
    ) -> None:
        self.add(Diagnostic(code, message, span, severity=Severity.NOTE, notes=tuple(notes), help=help), cause)

    @property
    def diagnostics(self) -> list[Diagnostic]:
        return [self._whole(each) for each in self._found]

    def sorted(self) -> list[Diagnostic]:
        """Return errors, then warnings, then notes.

        Within each, files that a person wrote for this run (recipes, options, a program) come before files of
        models, by file, line and column. Diagnostics without a place come last, in the order they were found.
        """
        return sorted(self.diagnostics, key=_rank)

    @property
    def errors(self) -> list[Diagnostic]:
        return [each for each in self.diagnostics if each.severity is Severity.ERROR]

    def _whole(self, diagnostic: Diagnostic) -> Diagnostic:
        others = self._found[diagnostic]
        cells = self._cells.get(diagnostic)
        recipes = self._recipes.get(diagnostic)
        if recipes:
            diagnostic = replace(diagnostic, recipes=tuple(recipes))
        if others:
            diagnostic = replace(diagnostic, others=(*diagnostic.others, *others))
        return replace(diagnostic, cells=tuple(cells)) if cells else diagnostic

    @property
    def has_errors(self) -> bool:
        return self.error_count > 0


def _cause(diagnostic: Diagnostic) -> Cause | None:
    """Return the cause that merges findings at a place that a `for` repeats, or None for other places."""
    span = diagnostic.span
    if span is None or span.turn is None:
        return None
    return Cause(f"for {span!r}", f"where {span.turn}" if span.turn else diagnostic.message)


def _with_turn(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic with a note that names the values of `for` at its place."""
    turn = None if diagnostic.span is None else diagnostic.span.turn
    note = Note(f"where {turn}")
    if not turn or note in diagnostic.notes:
        return diagnostic
    return replace(diagnostic, notes=(*diagnostic.notes, note))


def _at_source(diagnostic: Diagnostic) -> Diagnostic:
    """Return a diagnostic about a value of a table at the place in the table."""
    span = diagnostic.span
    if span is None or span.source is None:
        return diagnostic
    return replace(diagnostic, span=span.source, notes=(*diagnostic.notes, Note("the value is used here", span)))


def _rank(diagnostic: Diagnostic) -> tuple[int, bool, bool, str, int, int]:
    severity = _SEVERITIES.index(diagnostic.severity)
    span = diagnostic.span
    if span is None:
        return severity, True, True, "", 0, 0
    return severity, False, span.file.lower().endswith((*MJCF_FILES, *URDF_FILES)), span.file, span.line, span.column

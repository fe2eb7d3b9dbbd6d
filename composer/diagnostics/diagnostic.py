"""One finding about the user's input: an error, a warning or a remark."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from composer.diagnostics.cell_name import CellName
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span


class Severity(StrEnum):
    """How bad a diagnostic is. Only an `ERROR` stops the work."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Note:
    """Something that helps to understand a diagnostic, with the place it speaks of if there is one."""

    message: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Cause:
    """Why several findings are one diagnostic: those of one code and severity with an equal `key` are one.

    `subject` is what this one is about, in a few words; it is listed where this one is not the first.
    """

    key: str
    subject: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A message with its code, its place, what exists instead (`notes`) and what to write (`help`).

    `code` is one of `CODES`. The first line of `help` is a sentence; further lines, if any, are text that
    may be pasted into the file. `others` are what else the message is true of, by the same cause. `cells` are the
    models that it is about, in a run that looks at several of a recipe; it is empty where the diagnostic is about the
    recipe as a whole. `subjects` are the names that it is about: where an earlier error took one of them away, this one
    only follows from it. `fix` is the exact change that `help` describes, where there is one.
    """

    code: str
    message: str
    span: Span | None = None
    severity: Severity = Severity.ERROR
    notes: tuple[Note, ...] = ()
    help: str | None = None
    others: tuple[Note, ...] = ()
    cells: tuple[CellName, ...] = ()
    subjects: frozenset[str] = field(default=frozenset(), compare=False)
    fix: Fix | None = field(default=None, compare=False)

    def listed(self) -> tuple[Note, ...]:
        """The notes with one that lists the first of the `others`, one a line."""
        if not self.others:
            return self.notes
        lines = [f"{len(self.others)} more like this:"]
        lines += [
            f"{each.span}: {each.message}" if each.span else each.message for each in self.others[:_SHOWN]
        ]
        if len(self.others) > _SHOWN:
            lines.append(f"… and {len(self.others) - _SHOWN} more")
        return (*self.notes, Note("\n".join(lines)))


_SHOWN = 8

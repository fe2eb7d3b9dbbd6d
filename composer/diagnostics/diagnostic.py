"""One finding about the user's input: an error, a warning or a note."""

from __future__ import annotations

from dataclasses import field
from enum import StrEnum

from composer.dataclass import dataclass
from composer.diagnostics.cell_name import CellName
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span


class Severity(StrEnum):
    """The severity of a diagnostic. Only an `ERROR` stops the work."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Note:
    """A remark that helps to understand a diagnostic, with the place that it is about, if any."""

    message: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Cause:
    """Merges findings into one diagnostic: those with the same code, severity and `key`.

    `subject` names in a few words what this finding is about; it is listed if this one is not the first.
    """

    key: str
    subject: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """A message with its code, its place, what exists instead (`notes`) and what to write (`help`).

    `code` is one of `CODES`. The first line of `help` is a sentence; further lines are text to paste into the file.
    `others` lists further places with the same cause. `cells` are the models that it is about, in a run over
    several models of a recipe; it is empty if the diagnostic is about the recipe as a whole. `recipes` are those that
    it was found for, in a run over several. `subjects` are the
    names that it is about: if an earlier error removed one of them, this error only follows from that one. `fix` is
    the exact change that `help` describes, if there is one.
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
        """Return the notes, with one that lists the first of the `others`, one on each line."""
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

"""What is wrong with a value of a recipe, or what a check found, by its path; a diagnostic once its place is known."""

from __future__ import annotations

from dataclasses import dataclass

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fix import Fix

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Fault:
    """What becomes a diagnostic once its place in the file is looked up.

    `at` starts from the value that was validated; with `key` the fault lies in the key at the end of `at`. `related`
    are further notes, each with the path of what it is about, which starts from the same place. `within` is
    the line, the column and the width of what is wrong in a text of several lines. `lacks` is the key that is missing
    in the mapping at `at`, or with `beside` in that which has the key at the end of `at`. `names` are the keys that are
    missing, or too many. A `fix` without a span is about the place of the fault.
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
        """The notes, and without their places the related ones."""
        return [*self.notes, *(Note(message) for message, _ in self.related)]

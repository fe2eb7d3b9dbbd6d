"""A fault in a value of a recipe, or a finding of a check, by its path.

It becomes a diagnostic once its place is known.
"""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fix import Fix

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Fault:
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

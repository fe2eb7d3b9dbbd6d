"""What a check found, as data that goes through the pipe of the child process."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from composer.diagnostics.unknown import unknown_name


@dataclass(frozen=True, slots=True)
class Finding:
    """What does not hold. `at` is the path below the check's kind of what asks for it."""

    message: str
    at: tuple[str | int, ...] = ()
    notes: tuple[str, ...] = ()
    code: str = "check-failed"
    help: str | None = None

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Finding:
        return cls(**{**data, "at": tuple(data["at"]), "notes": tuple(data["notes"])})


def failed(message: str, expected: str, actual: str, *at: str | int, more: Iterable[str] = ()) -> Finding:
    """A check that does not hold: what was expected, and what is."""
    return Finding(message, at, (f"expected: {expected}", f"actual: {actual}", *more))


def unknown(kind: str, name: str, known: Iterable[str], *at: str | int) -> Finding:
    """A name that nothing has. `known` are the names as the recipe would write them."""
    found = unknown_name(kind, name, [each for each in known if each])
    return Finding(found.message, at, tuple(note.message for note in found.notes), found.code, found.help)

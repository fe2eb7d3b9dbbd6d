"""What a check found that does not hold, as faults and as data that goes through the pipe of the child process."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.fault import Fault
from composer.diagnostics.unknown import unknown_name


def failed(
    message: str,
    expected: str,
    actual: str,
    *at: str | int,
    more: Iterable[str] = (),
    help: str | None = None,
) -> Fault:
    """A check that does not hold: what was expected, and what is.

    `at` is the path, below the check's kind, of the value that is not met.
    """
    notes = (f"expected: {expected}", f"actual: {actual}", *more)
    return Fault("check-failed", message, at, notes=tuple(map(Note, notes)), help=help)


def unknown(kind: str, name: str, known: Iterable[str], *at: str | int) -> Fault:
    """A name that nothing has. `known` are the names as the recipe would write them."""
    found = unknown_name(kind, name, [each for each in known if each])
    return Fault(found.code, found.message, at, notes=found.notes, help=found.help)


def to_json(fault: Fault) -> dict[str, Any]:
    """The fields that a check may set: the others are the recipe's."""
    return {name: value for name, value in asdict(fault).items() if name in _FIELDS}


def from_json(data: dict[str, Any]) -> Fault:
    """What `to_json` gave."""
    notes = tuple(Note(each["message"]) for each in data["notes"])
    return Fault(**{**data, "at": tuple(data["at"]), "notes": notes})


_FIELDS = ("code", "message", "at", "notes", "help")

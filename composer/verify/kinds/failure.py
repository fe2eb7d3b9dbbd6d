"""The findings of a check as faults, and as JSON data for the child process."""

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
    """Return a finding with the expected and the actual value.

    `at` is the path of the value that does not hold, below the check's kind.
    """
    notes = (f"expected: {expected}", f"actual: {actual}", *more)
    return Fault("check-failed", message, at, notes=tuple(map(Note, notes)), help=help)


def beside(value: float, *bounds: float, digits: int = 4) -> str:
    """Return a number in as many digits as it takes to see that it is none of the bounds, and no fewer than `digits`.

    >>> beside(0.05, 0.001), beside(0.00100002, 0.001), beside(0.001, 0.001)
    ('0.05', '0.00100002', '0.001')
    """
    for count in range(digits, 17):
        text = f"{value:.{count}g}"
        if all(float(text) != bound for bound in bounds if bound != value):
            return text
    return repr(value)


def unknown(kind: str, name: str, known: Iterable[str], *at: str | int) -> Fault:
    """Return a finding for an unknown name. `known` are the existing names as the recipe would write them."""
    found = unknown_name(kind, name, [each for each in known if each])
    return Fault(found.code, found.message, at, notes=found.notes, help=found.help)


def to_json(fault: Fault) -> dict[str, Any]:
    """Return the fields that a check may set; the recipe's side fills in the others."""
    return {name: value for name, value in asdict(fault).items() if name in _FIELDS}


def from_json(data: dict[str, Any]) -> Fault:
    """Return the fault that `to_json` turned into data."""
    notes = tuple(Note(each["message"]) for each in data["notes"])
    return Fault(**{**data, "at": tuple(data["at"]), "notes": notes})


_FIELDS = ("code", "message", "at", "notes", "help")

"""Faults of a recipe on their way through pydantic, which knows only error types, paths and contexts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import ValidationError, ValidatorFunctionWrapHandler
from pydantic_core import InitErrorDetails, PydanticCustomError

from composer.diagnostics.diagnostic import Diagnostic

Path = tuple[str | int, ...]

# Two keys of which only one may stand.
EXCLUSIVE = "wrong-type"


@dataclass(frozen=True, slots=True)
class Remark:
    """A note of a fault; `at`, where there is one, starts from the same place as that of the fault."""

    message: str
    at: Path | None = None


@dataclass(frozen=True, slots=True)
class Fault:
    """What becomes a diagnostic once its place in the file is looked up.

    `at` starts from the value that was validated; with `key` the fault lies in the key at the end of `at`. `within` is
    the line, the column and the width of what is wrong in a text of several lines. `lacks` is the key that is missing
    in the mapping at `at`, or with `beside` in that which has the key at the end of `at`. `names` are the keys that are
    missing, or too many.
    """

    code: str
    message: str
    at: Path = ()
    key: bool = False
    remarks: tuple[Remark, ...] = ()
    help: str | None = None
    within: tuple[int, int, int] | None = None
    lacks: str | None = None
    beside: bool = False
    names: tuple[str, ...] = ()


def unplaced(diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None) -> Fault:
    """A diagnostic of which only the path in the recipe is known; with `help` in place of its own."""
    remarks = tuple(Remark(note.message) for note in diagnostic.notes)
    names = tuple(sorted(diagnostic.subjects))
    return Fault(diagnostic.code, diagnostic.message, at, key, remarks, help or diagnostic.help, names=names)


def refusal(faults: Sequence[Fault], value: object) -> ValidationError:
    """One exception for all faults of a value; pydantic puts the value's own path in front of each `at`."""
    return ValidationError.from_exception_data("recipe", _lines(faults, value))


def checked(handler: ValidatorFunctionWrapHandler, value: Any, faults: Sequence[Fault]) -> Any:
    """What pydantic makes of a value, or its errors and the faults together."""
    try:
        result = handler(value)
    except ValidationError as error:
        if not faults:
            raise
        known = [_again(each) for each in error.errors(include_url=False)]
        raise ValidationError.from_exception_data("recipe", [*known, *_lines(faults, value)]) from None
    if faults:
        raise refusal(faults, value)
    return result


def _lines(faults: Iterable[Fault], value: object) -> list[InitErrorDetails]:
    return [
        InitErrorDetails(
            # Not the message itself: it is a template to pydantic, and braces in it would be filled in.
            type=PydanticCustomError("fault", "{message}", {"message": fault.message, "fault": fault}),
            loc=fault.at,
            input=value,
        )
        for fault in faults
    ]


def _again(error: Any) -> InitErrorDetails:
    """An error that `errors()` gave, as something to raise."""
    kind = error["type"]
    context = error.get("ctx", {})
    if kind == "fault":
        kind = PydanticCustomError("fault", "{message}", context)
    return InitErrorDetails(type=kind, loc=error["loc"], input=error["input"], ctx=context)

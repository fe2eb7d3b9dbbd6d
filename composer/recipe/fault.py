"""Carry faults of a recipe through pydantic, which only knows error types, paths and contexts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import ValidationError, ValidatorFunctionWrapHandler
from pydantic_core import InitErrorDetails, PydanticCustomError

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.fault import Fault, Path
from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import advised, exists_note

__all__ = ["EXCLUSIVE", "Fault", "Path", "fault_at", "unknown_key", "validated_with", "validation_error"]

# Two keys exclude each other.
EXCLUSIVE = "wrong-type"


def fault_at(
    diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None, fix: Fix | None = None
) -> Fault:
    """Return a diagnostic as a fault at a path. `help` and `fix` replace those of the diagnostic."""
    names = tuple(sorted(diagnostic.subjects))
    fix = fix if help else diagnostic.fix
    help = help or diagnostic.help
    return Fault(
        diagnostic.code,
        diagnostic.message,
        at,
        key=key,
        notes=diagnostic.notes,
        help=help,
        names=names,
        fix=fix,
    )


def unknown_key(message: str, name: str, known: Iterable[str], at: Path, *, noun: str = "key") -> Fault:
    """Return the fault of an unknown key. `known` are the allowed keys, which messages call a `noun`."""
    known = list(known)
    help, fix = advised(name, known)
    note = exists_note(noun, known, name)
    return Fault("unknown-key", message, at, key=True, notes=(note,), help=help, fix=fix)


def validation_error(faults: Sequence[Fault], value: object) -> ValidationError:
    """Return one exception for all faults of a value. Pydantic puts the path of the value in front of each `at`."""
    return ValidationError.from_exception_data("recipe", _lines(faults, value))


def validated_with(handler: ValidatorFunctionWrapHandler, value: Any, faults: Sequence[Fault]) -> Any:
    """Return what pydantic's handler returns. Raise its errors and the faults together, if there are any."""
    try:
        result = handler(value)
    except ValidationError as error:
        if not faults:
            raise
        known = [_again(each) for each in error.errors(include_url=False)]
        raise ValidationError.from_exception_data("recipe", [*known, *_lines(faults, value)]) from None
    if faults:
        raise validation_error(faults, value)
    return result


def _lines(faults: Iterable[Fault], value: object) -> list[InitErrorDetails]:
    return [
        InitErrorDetails(
            # Not the message itself: for pydantic it is a template, in which it would replace braces.
            type=PydanticCustomError("fault", "{message}", {"message": fault.message, "fault": fault}),
            loc=fault.at,
            input=value,
        )
        for fault in faults
    ]


def _again(error: Any) -> InitErrorDetails:
    """Return an error of `errors()` in a form that can be raised."""
    kind = error["type"]
    context = error.get("ctx", {})
    if kind == "fault":
        kind = PydanticCustomError("fault", "{message}", context)
    return InitErrorDetails(type=kind, loc=error["loc"], input=error["input"], ctx=context)

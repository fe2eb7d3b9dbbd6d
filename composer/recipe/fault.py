"""Faults of a recipe on their way through pydantic, which knows only error types, paths and contexts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pydantic import ValidationError, ValidatorFunctionWrapHandler
from pydantic_core import InitErrorDetails, PydanticCustomError

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.fault import Fault, Path
from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import advised, exists_note

__all__ = ["EXCLUSIVE", "Fault", "Path", "checked", "refusal", "unknown_key", "unplaced"]

# Two keys of which only one may stand.
EXCLUSIVE = "wrong-type"


def unplaced(
    diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None, fix: Fix | None = None
) -> Fault:
    """A diagnostic of which only the path in the recipe is known; with `help` and `fix` in place of its own."""
    names = tuple(sorted(diagnostic.subjects))
    fix = fix if help else diagnostic.fix
    help = help or diagnostic.help
    return Fault(diagnostic.code, diagnostic.message, at, key, diagnostic.notes, help, names=names, fix=fix)


def unknown_key(message: str, name: str, known: Iterable[str], at: Path, *, noun: str = "key") -> Fault:
    """The fault of a key that a mapping cannot have; `known` are those that it may have, each a `noun`."""
    known = list(known)
    help, fix = advised(name, known)
    note = exists_note(noun, known, name)
    return Fault("unknown-key", message, at, key=True, notes=(note,), help=help, fix=fix)


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

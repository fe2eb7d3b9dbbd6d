"""Describe the faults in a manifest's text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import ValidationError

from composer.bundle.manifest import FORMAT

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


def faults_of(error: ValueError) -> tuple[str, ...]:
    """Return the faults in a manifest that `from_json` refused, in words."""
    if not isinstance(error, ValidationError):
        return (str(error),)
    return tuple(_in_words(each) for each in error.errors(include_url=False, include_context=False))


def newer_format(error: ValueError) -> int | None:
    """Return the format version of a refused manifest if it is newer than ours, else None."""
    if isinstance(error, ValidationError):
        for each in error.errors():
            if each["loc"] == ("manifest",) and isinstance(each["input"], int) and each["input"] > FORMAT:
                return each["input"]
    return None


def _in_words(fault: ErrorDetails) -> str:
    place = "`" + "/".join(map(str, fault["loc"])) + "`"
    if fault["type"] == "json_invalid":
        return "it is not JSON: " + fault["msg"].removeprefix("Invalid JSON: ")
    if not fault["loc"]:
        return "it is not a mapping"
    if fault["type"] == "extra_forbidden":
        return f"{place} is not a key of a manifest"
    if fault["type"] == "missing":
        return f"{place} is missing"
    message = fault["msg"]
    return f"{place}: {message[:1].lower()}{message[1:]}"

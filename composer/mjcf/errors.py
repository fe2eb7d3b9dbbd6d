"""The exceptions and warnings of `composer.mjcf`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.failure import MjcomposeError
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span


class MjcfError(MjcomposeError, ValueError):
    """A model, or a call on one, is wrong. After a failed call the model is unchanged.

    `diagnostics` has every fault with its code, its place, the names that exist and advice; `str()` is all of them
    as text.
    """


class MjcfAttributeError(MjcfError, AttributeError):
    """Elements of this tag do not have this attribute. It is an `AttributeError`, as `hasattr` and `getattr` expect."""


class MjcfKeyError(MjcfError, KeyError):
    """No element of a list has this name."""


class MjcfFileError(MjcfError, OSError):
    """A file cannot be read."""


class MjcfFileNotFoundError(MjcfFileError, FileNotFoundError):
    """A file does not exist."""


class MjcfWarning(UserWarning):
    """Something in a model was resolved as requested, but its author may want to know."""


_OF_CODES: dict[str, type[MjcfError]] = {
    "file-not-found": MjcfFileNotFoundError,
    "file-unreadable": MjcfFileError,
    "asset-missing": MjcfFileNotFoundError,
}


def failure(
    code: str,
    message: str,
    span: Span | None = None,
    *,
    notes: Iterable[Note] = (),
    help: str | None = None,
    kind: type[MjcfError] | None = None,
) -> MjcfError:
    """Return an exception for one error."""
    return failed(Diagnostic(code, message, span, notes=tuple(notes), help=help), kind)


def failed(diagnostic: Diagnostic, kind: type[MjcfError] | None = None) -> MjcfError:
    """Return the exception that carries a diagnostic. Its class is `kind`, or by default that of the error code."""
    return (kind or _OF_CODES.get(diagnostic.code, MjcfError))([diagnostic])


def raise_errors(sink: Sink, otherwise: Callable[[], Span] | None = None) -> None:
    """Raise all errors in the sink, if any, as one exception. Errors without a place get the one of `otherwise`."""
    if sink.has_errors:
        errors = [each for each in sink.sorted() if each.severity == "error"]
        if otherwise is not None:
            place = otherwise()
            errors = [replace(each, span=each.span or place) for each in errors]
        raise _OF_CODES.get(errors[0].code, MjcfError)(errors)

"""What `composer.mjcf` raises and warns with."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.failure import MjcomposeError
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span


class MjcfError(MjcomposeError, ValueError):
    """A model, or a call on one, that is wrong; after a failed call the model is as it was.

    `diagnostics` holds every fault with its code, place, what exists instead and what to write; `str()` is
    all of them as text.
    """


class MjcfAttributeError(MjcfError, AttributeError):
    """An attribute that elements of this tag do not have; `hasattr` and `getattr` with a default know it."""


class MjcfKeyError(MjcfError, KeyError):
    """A name that no element of a list has."""


class MjcfFileError(MjcfError, OSError):
    """A file that cannot be read."""


class MjcfFileNotFoundError(MjcfFileError, FileNotFoundError):
    """A file that does not exist."""


class MjcfWarning(UserWarning):
    """Something about a model that was settled as asked, and that its author may want to know."""


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
    """The exception of one error, to be raised."""
    return failed(Diagnostic(code, message, span, notes=tuple(notes), help=help), kind)


def failed(diagnostic: Diagnostic, kind: type[MjcfError] | None = None) -> MjcfError:
    """The exception that carries a diagnostic, to be raised."""
    return (kind or _OF_CODES.get(diagnostic.code, MjcfError))([diagnostic])


def raise_errors(sink: Sink, otherwise: Callable[[], Span] | None = None) -> None:
    """Raise all errors that have been found, if any, as one exception; those without a place get another one."""
    if sink.has_errors:
        errors = [each for each in sink.sorted() if each.severity == "error"]
        if otherwise is not None:
            place = otherwise()
            errors = [replace(each, span=each.span or place) for each in errors]
        raise _OF_CODES.get(errors[0].code, MjcfError)(errors)

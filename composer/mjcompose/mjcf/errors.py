"""The exceptions and warnings of `mjcompose.mjcf`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from mjcompose.base.diagnostic import Diagnostic, Note, Span, call_site
from mjcompose.base.report import MjcomposeError
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, exists_note, unknown_attribute
from mjcompose.tree.grammar import ElementType
from mjcompose.tree.select import spoken


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

    # Programs that copy exceptions (tblib, with Dask) call it, and ValueError's method refuses an OSError.
    __new__ = OSError.__new__  # type: ignore[assignment]


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
    """Return an exception for one error, by default at the line of the caller's program."""
    return error_of(Diagnostic(code, message, span or call_site(), notes=tuple(notes), help=help), kind)


def error_of(diagnostic: Diagnostic, kind: type[MjcfError] | None = None) -> MjcfError:
    """Return the exception that carries a diagnostic. Its class is `kind`, or by default the error code's class."""
    return (kind or _OF_CODES.get(diagnostic.code, MjcfError))([diagnostic])


def raise_errors(sink: Sink, otherwise: Callable[[], Span] | None = None) -> None:
    """Raise all reported errors, if any, as one exception. Errors without a place get the place of `otherwise`."""
    if sink.has_errors:
        errors = [each for each in sink.sorted() if each.severity == "error"]
        if otherwise is not None:
            place = otherwise()
            errors = [replace(each, span=each.span or place) for each in errors]
        raise _OF_CODES.get(errors[0].code, MjcfError)(errors)


def unknown_tag(tag: object, message: str, known: Iterable[str]) -> MjcfError:
    """Return the error for an element that does not exist here, with the elements that do."""
    names = sorted(known)
    written = tag if isinstance(tag, str) else None
    near = closest(written, names) if written else []
    help = TAGS.get(str(tag)) or (f"did you mean `{near[0]}`?" if near else None)
    return failure("unknown-element", message, notes=(exists_note("element", names, written),), help=help)


def no_attribute(kind: ElementType, name: str, members: Iterable[str] = ()) -> MjcfError:
    """Return the error for an unknown attribute of a kind; with other `members`, children are suggested too."""
    meant = list(members)
    known = sorted(map(spoken, kind.attributes))
    tags = sorted(map(spoken, kind.children)) if meant else []
    other = ATTRIBUTES.get(name) if meant else None
    found = unknown_attribute(name, f"`<{kind.tag}>`", known, span=call_site(), help=other, near=[*tags, *meant])
    notes = (*found.notes, exists_note("element", tags, name)) if tags else found.notes
    return error_of(replace(found, notes=notes), MjcfAttributeError)


ATTRIBUTES = {
    "get_assets": "`assets`, a property, has the bytes of all files by name",
    "get_attribute_xml_string": "`repr(element)` shows attributes as they are written",
    "get_children": "children are attributes: `body.geom`",
    "get_init_stack": "`origin` is where an element came from, `origin_of(attribute)` an attribute",
    "is_removed": "using an element that was removed says so",
    "is_same_as": "compare the printed text: `str(a) == str(b)`",
    "namescope": "`root` is the model of an element, `find` and `enter_scope` look by name",
    "prefixed_identifier": "`full_identifier` is the name in the output",
    "resolve_references": "references are always resolved",
    **dict.fromkeys(
        ("to_xml", "to_xml_string"), "`str(element)` is its text, `root.to_xml_string()` the whole composition"
    ),
}
"""Members of its elements, and what to write instead."""

TAGS = {
    "attachment_frame": "`get_attachment_frame(model)` is the frame, `enter_scope(name)` the attached model",
    "attached_model": "`enter_scope(name)` is the attached model",
}
"""Words that its `find` knows in addition to tags."""

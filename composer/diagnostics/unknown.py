"""Diagnostics for names that do not exist, in one wording: what is wrong, what exists, what was probably meant."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import did_you_mean, exists_note, renaming


def unknown_name(
    kind: str,
    name: str,
    known: Iterable[str],
    span: Span | None = None,
    *,
    purpose: str = "",
    message: str | None = None,
    written: str = "{}",
    help: str | None = None,
    otherwise: str | None = None,
    notes: Iterable[Note] = (),
    about: Iterable[str] = (),
    fix: Fix | None = None,
) -> Diagnostic:
    """Return the diagnostic for a name that no `body` or other kind has; `known` are the names that exist.

    `purpose` continues the sentence, `message` replaces it. `written` is the format of the name in the file. `help`
    and `fix` replace the suggestion, `otherwise` is the help if no name is similar. `notes` follow the note that
    lists what exists; `about` are further subjects.

    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to", written="site: {}").help
    'did you mean `site: tip`?'
    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to").message
    'the site `tpi` to attach `a` to does not exist'
    """
    known = list(known)
    return Diagnostic(
        "unknown-name",
        message or f"the {kind} `{name}`{purpose} does not exist",
        span,
        notes=(exists_note(kind, known, name), *notes),
        help=help or did_you_mean(name, known, written) or otherwise,
        subjects=frozenset((name, *about)),
        fix=fix if help else renaming(name, known),
    )


def unknown_key(name: str, known: Iterable[str], span: Span, message: str) -> Diagnostic:
    """Return the diagnostic for a key that a mapping of a recipe does not have; `known` are the keys it may have.

    >>> from composer.diagnostics.span import Span
    >>> unknown_key("axis", ["axes", "name"], Span("r.yaml", 1, 1), "`matrix` has no key `axis`").help
    'did you mean `axes`?'
    """
    known = list(known)
    return Diagnostic(
        "unknown-key",
        message,
        span,
        notes=(exists_note("key", known, name),),
        help=did_you_mean(name, known),
        fix=renaming(name, known),
    )


def unknown_attribute(
    name: str,
    owner: str,
    known: Iterable[str],
    span: Span | None = None,
    *,
    help: str | None = None,
    otherwise: str | None = None,
    near: Iterable[str] = (),
) -> Diagnostic:
    """Return the diagnostic for an attribute that a kind of element does not have; `owner` names the kind.

    `known` are the attributes that exist, `near` are further suggestions; `help` and `otherwise` are as above.

    >>> unknown_attribute("colour", "`<geom>`", ["rgba", "size"]).help
    'did you mean `rgba`?'
    """
    known = list(known)
    return Diagnostic(
        "unknown-attribute",
        f"`{name}` is not an attribute of {owner}",
        span,
        notes=(exists_note("attribute", known, name),) if known else (),
        help=help or did_you_mean(name, [*known, *near]) or otherwise,
        fix=None if help else renaming(name, [*known, *near]),
    )

"""A name that does not exist, in the same words everywhere: what is wrong, what exists, what was probably meant."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diagnostics.diagnostic import Diagnostic, Note
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import did_you_mean, exists_note


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
) -> Diagnostic:
    """Nothing of a kind, such as `body`, has a name; `known` are the names that exist.

    `purpose` continues the sentence, `message` replaces it. `written` is how the name is written there. `help` replaces
    what was probably meant, `otherwise` stands where nothing is near. `notes` come behind the one that lists what
    exists; `about` are further subjects.

    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to", written="site: {}").help
    'did you mean `site: tip`?'
    >>> unknown_name("site", "tpi", ["tip"], purpose=" to attach `a` to").message
    'there is no site `tpi` to attach `a` to'
    """
    known = list(known)
    return Diagnostic(
        "unknown-name",
        message or f"there is no {kind} `{name}`{purpose}",
        span,
        notes=(exists_note(kind, known, name), *notes),
        help=help or did_you_mean(name, known, written) or otherwise,
        subjects=frozenset((name, *about)),
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
    """Elements of a kind do not have an attribute; `owner` is what a message calls them.

    `known` are the attributes that exist, `near` what else may have been meant; `help` and `otherwise` are as above.

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
    )

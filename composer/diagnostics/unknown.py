"""A name that does not exist, in the same words everywhere: what is wrong, what exists, what was probably meant."""

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
    """Nothing of a kind, such as `body`, has a name; `known` are the names that exist.

    `purpose` continues the sentence, `message` replaces it. `written` is how the name is written there. `help` and
    `fix` replace what was probably meant, `otherwise` stands where nothing is near. `notes` come behind the one that
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
    """A mapping of a recipe has no key of that name; `known` are those that it may have.

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
        fix=None if help else renaming(name, [*known, *near]),
    )

"""All kinds of model reference, and the parser that selects one."""

from __future__ import annotations

import re

from mjcompose.base.diagnostic import DiagnosticError, hide
from mjcompose.base.extensions import Table, is_registered, refuse
from mjcompose.base.suggest import closest
from mjcompose.sources import archives, git, packages, path
from mjcompose.sources.reference import CONTROL, Reference, SourceError, SourceKind, is_this_machine

KINDS: tuple[SourceKind, ...] = (
    path.KIND, packages.PACKAGE, packages.MENAGERIE, packages.DESCRIPTIONS, git.GIT, archives.ARCHIVE, git.HF,
    archives.BUCKET, archives.OCI,
)  # fmt: skip
"""A kind exists if its row is here; messages and docs list kinds in this order."""

_BY_NAME = {kind.name: kind for kind in KINDS}
_BY_SCHEME = {form.scheme: kind for kind in KINDS for form in kind.forms if form.scheme}
EXTENDED: Table[SourceKind] = Table("sources", {}, "KIND", kind=SourceKind)
"""The kinds of other packages, by their schemes, which are their names."""
_ON_THIS_MACHINE = {scheme: kind for kind in KINDS for scheme in kind.local_schemes}
_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):(.*)", re.DOTALL)
"""At least two characters, because one letter before a colon is a Windows drive."""

if len(_BY_NAME) < len(KINDS):
    raise ValueError("two kinds of model reference have one name")
for _kind in KINDS:
    for _scheme in (*(form.scheme for form in _kind.forms), *_kind.local_schemes):
        if _scheme and {**_ON_THIS_MACHINE, **_BY_SCHEME}[_scheme] is not _kind:
            raise ValueError(f"two kinds of model reference begin with `{_scheme}:`")


def kind_called(name: str) -> SourceKind | None:
    """Return the kind of that name in a lock or manifest, or None if there is none."""
    return _BY_NAME.get(name) or EXTENDED.get(name)


def parse(text: str, fetched: str | None = None) -> Reference:
    """Parse a model reference. No I/O, except that it loads the kind of another package.

    `fetched` is the id of the origin if the recipe with the reference was fetched: it may name no such kind.

    Text without a scheme is a path; a path with a colon in its first component needs `./` before it. Raises
    SourceError (`source-kind`) for a text that has none of the forms.

    >>> parse("menagerie:universal_robots_ur5e/ur5e").name
    'universal_robots_ur5e'
    >>> parse("git+https://host/robots@v1.2#arm/arm.xml").revision
    'v1.2'
    >>> parse("./parts/table.xml").kind.name
    'path'
    """
    if not text.strip():
        raise SourceError("source-kind", "a model reference is empty", notes=(_forms_note(),))
    if CONTROL.search(text):
        raise SourceError("source-kind", f"the model reference `{CONTROL.sub('?', text)}` holds a control character")
    scheme = None if text.startswith((".", "/", "\\")) else _SCHEME.fullmatch(text)
    if scheme is None:
        return path.KIND.parse(text)
    kind = _BY_SCHEME.get(scheme[1])
    if kind is None and is_registered("sources", scheme[1]):
        try:
            if fetched is not None:
                raise refuse("sources", scheme[1], fetched)
            kind = EXTENDED[scheme[1]]
        except DiagnosticError as error:
            raise SourceError(error.code, error.message, error.diagnostic.help) from error
    if kind is None and is_this_machine(scheme[2].removeprefix("//").partition("/")[0]):
        kind = _ON_THIS_MACHINE.get(scheme[1])
    if kind is None:
        raise _unknown_kind(text, scheme[1], scheme[2])
    return kind.parse(text)


def _unknown_kind(text: str, scheme: str, rest: str) -> SourceError:
    help = None
    text, rest = hide(text), hide(rest)
    if near := closest(scheme, [*_BY_SCHEME, *EXTENDED]):
        help = f"write `{near[0]}:{rest}`"
    elif scheme.lower() == "file":
        help = "write the path alone"
    elif "/" not in scheme and not rest.startswith("//"):
        help = f"if it is a path, write `./{text}`"
    message = f"`{scheme}:` is not a kind of model reference, in `{text}`"
    return SourceError("source-kind", message, notes=(_forms_note(),), help=help)


def _forms_note() -> str:
    first = {form.scheme: form.example for kind in KINDS for form in reversed(kind.forms)}
    shown = (first.pop(form.scheme, None) for kind in KINDS for form in kind.forms)
    return "forms that exist: " + ", ".join(f"`{example}`" for example in shown if example)

"""Model references to git repositories, at a branch, a tag or a commit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mjcompose.sources.reference import (
    CONTROL,
    Form,
    Reference,
    SourceKind,
    check_secrets,
    host_of_url,
    malformed,
    take_apart,
)  # fmt: skip

if TYPE_CHECKING:
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source

_FORMS = (
    Form(
        "git+https://host/repo@REV#path/model.xml",
        "a file in a git repository; REV is a branch, a tag or a commit. An `@`, `#` or `%` in it is written `%40`,"
        " `%23`, `%25`",
    ),
    Form("git+ssh://git@host/repo@REV#path/model.xml", "the same over ssh"),
    Form("git+file:///path/to/repo@REV#path/model.xml", "the same in a repository on this machine"),
)


def _parse(text: str) -> Reference:
    scheme, _, rest = text.partition(":")
    form = next((each for each in _FORMS if each.scheme == scheme), _FORMS[0])
    location, _, path = rest.partition("#")
    host, _, tail = location.removeprefix("//").partition("/")
    check_secrets(text, host)
    # Only an `@` after the host starts a revision; before it, an `@` ends a user name.
    repository, at, revision = tail.rpartition("@")
    if not at:
        repository, revision = tail, ""
    if not repository or bool(host) == (scheme == "git+file"):
        raise malformed(text, form, "does not say the repository")
    if host and take_apart(f"https://{host}/") is None:
        raise malformed(text, form, "names a host that cannot be one")
    if not (revision := revision_in(revision)):
        raise malformed(text, form, "does not say the revision")
    if not path:
        raise malformed(text, form, "does not say the file inside the repository")
    return Reference(text, KIND, f"{scheme.removeprefix('git+')}://{host}/{repository}", path=path, revision=revision)


def revision_in(text: str) -> str:
    """Return the name of a revision from its escaped form; empty if it cannot be a revision. No I/O."""
    if "%" in text:
        from urllib.parse import unquote  # most builds fetch nothing

        text = unquote(text)
    return "" if text.startswith("-") or CONTROL.search(text) else text


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup)


KIND = SourceKind(
    name="git", forms=_FORMS, local_schemes=("git+http",), separator="#", is_local=False, is_fetched=True,
    runs_code=False, pins=frozenset({"commit", "tree"}), variables=(), libraries=(), parse=_parse,
    resolve=_resolve, host=host_of_url, is_of_this_machine=lambda reference: reference.name.startswith("file:"),
)  # fmt: skip

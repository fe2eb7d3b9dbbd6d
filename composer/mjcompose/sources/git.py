"""Model references to git repositories, at a branch, a tag or a commit, and to the Hugging Face Hub (with Git LFS)."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import hide
from mjcompose.sources import license
from mjcompose.sources.reference import (
    CONTROL,
    Form,
    Reference,
    SourceError,
    SourceKind,
    bare,
    check_secrets,
    host_of_url,
    is_this_machine,
    malformed,
    never,
    take_apart,
)  # fmt: skip

if TYPE_CHECKING:
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source


_GIT_FORMS = (
    Form(
        "git+https://host/repo@REV#path/model.xml",
        "a file in a git repository; REV is a branch, a tag or a commit. An `@`, `#` or `%` in it is written `%40`,"
        " `%23`, `%25`",
    ),
    Form("git+ssh://git@host/repo@REV#path/model.xml", "the same over ssh"),
    Form("git+file:///path/to/repo@REV#path/model.xml", "the same in a repository on this machine"),
)


def _parse_git(text: str) -> Reference:
    scheme, _, rest = text.partition(":")
    form = next((each for each in _GIT_FORMS if each.scheme == scheme), _GIT_FORMS[0])
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
    return Reference(text, GIT, f"{scheme.removeprefix('git+')}://{host}/{repository}", path=path, revision=revision)


def revision_in(text: str) -> str:
    """Return the name of a revision from its escaped form; empty if it cannot be a revision. No I/O."""
    if "%" in text:
        from urllib.parse import unquote  # most builds fetch nothing

        text = unquote(text)
    return "" if text.startswith("-") or CONTROL.search(text) else text


def _resolve_git(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup)


GIT = SourceKind(
    name="git", forms=_GIT_FORMS, local_schemes=("git+http",), separator="#", is_local=False, is_fetched=True,
    runs_code=False, pins=frozenset({"commit", "tree"}), variables=(), libraries=(), parse=_parse_git,
    resolve=_resolve_git, host=host_of_url, is_of_this_machine=lambda reference: reference.name.startswith("file:"),
)  # fmt: skip


_HF_FORM = Form(
    "hf:org/repo@REV#path/model.xml",
    "a file in a repository of Hugging Face; REV is a branch, a tag or a commit. `hf:datasets/org/repo` is a data set",
)
_HUB = "https://huggingface.co"
_HUB_REPOSITORY = re.compile(r"((datasets|spaces)/)?[A-Za-z0-9_-][\w.-]*/[A-Za-z0-9_-][\w.-]*", re.ASCII)


def _parse_hf(text: str) -> Reference:
    location, _, path = bare(text, _HF_FORM).partition("#")
    check_secrets(text, "")
    repository, _, revision = location.partition("@")
    if not _HUB_REPOSITORY.fullmatch(repository):
        raise malformed(text, _HF_FORM, "does not say the organization and the repository")
    if not (revision := revision_in(revision)):
        raise malformed(text, _HF_FORM, "does not say the revision")
    if not path:
        raise malformed(text, _HF_FORM, "does not say the file inside the repository")
    return Reference(text, HF, repository, path=path, revision=revision)


def _resolve_hf(reference: Reference, lookup: Lookup) -> Source:
    """Return the file, from the repository that git fetches: its commit is checked by its hash. Raises SourceError."""
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    hub = _hub(reference, lookup)
    source = resolve(replace(reference, name=f"{hub}/{reference.name}"), lookup)
    assert source.origin is not None, "what is fetched has an origin"
    return replace(source, license=license.of_card(source.origin.root / "README.md"))


def _hub(reference: Reference, lookup: Lookup) -> str:
    """Return the address of the hub; a fetched recipe may not reach one in this network."""
    from mjcompose.sources.reference import is_private

    hub = (lookup.environment.get("HF_ENDPOINT") or _HUB).rstrip("/")
    parts = take_apart(hub)
    is_open = parts is not None and parts.scheme == "http" and is_this_machine(parts.netloc)
    if parts is None or "@" in parts.netloc or parts.query or not (parts.scheme == "https" or is_open):
        message = f"`HF_ENDPOINT` is `{hide(hub)}`, which is not an https address of a server without a login"
        raise SourceError("source-fetch", message, help=f"write it as `{_HUB}`, or unset it")
    if lookup.is_confined and is_private(parts.netloc, lookup.fetching.offline):
        message = f"`{reference.text}`, which a fetched recipe names, is at `{hub}`, in the network of this machine"
        help = f'if you trust it with that, write in your own recipe `trust: {{references: ["{reference.id}"]}}`'
        raise SourceError("source-outside", message, help=help)
    return hub


HF = SourceKind(
    name="hf", forms=(_HF_FORM,), local_schemes=(), separator="#", is_local=False, is_fetched=True, runs_code=False,
    pins=frozenset({"commit", "tree"}), variables=("HF_ENDPOINT",), libraries=(), parse=_parse_hf, resolve=_resolve_hf,
    host=lambda reference: "huggingface.co", is_of_this_machine=never,
)  # fmt: skip

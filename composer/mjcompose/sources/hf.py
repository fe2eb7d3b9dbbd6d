"""Model references to repositories of the Hugging Face Hub, which are git repositories with Git LFS."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import hide
from mjcompose.sources import license
from mjcompose.sources.git import revision_in
from mjcompose.sources.reference import (
    Form,
    Reference,
    SourceError,
    SourceKind,
    bare,
    check_secrets,
    is_this_machine,
    malformed,
    never,
    take_apart,
)

if TYPE_CHECKING:
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source

_FORM = Form(
    "hf:org/repo@REV#path/model.xml",
    "a file in a repository of Hugging Face; REV is a branch, a tag or a commit. `hf:datasets/org/repo` is a data set",
)
_HUB = "https://huggingface.co"
_REPOSITORY = re.compile(r"((datasets|spaces)/)?[A-Za-z0-9_-][\w.-]*/[A-Za-z0-9_-][\w.-]*", re.ASCII)


def _parse(text: str) -> Reference:
    location, _, path = bare(text, _FORM).partition("#")
    check_secrets(text, "")
    repository, _, revision = location.partition("@")
    if not _REPOSITORY.fullmatch(repository):
        raise malformed(text, _FORM, "does not say the organization and the repository")
    if not (revision := revision_in(revision)):
        raise malformed(text, _FORM, "does not say the revision")
    if not path:
        raise malformed(text, _FORM, "does not say the file inside the repository")
    return Reference(text, KIND, repository, path=path, revision=revision)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the file, from the repository that git fetches: its commit is checked by its hash. Raises SourceError."""
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    hub = _hub(reference, lookup)
    source = resolve(replace(reference, name=f"{hub}/{reference.name}"), lookup)
    assert source.origin is not None, "what is fetched has an origin"
    return replace(source, license=license.of_card(source.origin.root / "README.md"))


def _hub(reference: Reference, lookup: Lookup) -> str:
    """Return the address of the hub; a fetched recipe may not reach one in this network."""
    from mjcompose.sources.trust import is_private

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


KIND = SourceKind(
    name="hf", forms=(_FORM,), local_schemes=(), separator="#", is_local=False, is_fetched=True, runs_code=False,
    pins=frozenset({"commit", "tree"}), variables=("HF_ENDPOINT",), libraries=(), parse=_parse, resolve=_resolve,
    host=lambda reference: "huggingface.co", is_of_this_machine=never,
)  # fmt: skip

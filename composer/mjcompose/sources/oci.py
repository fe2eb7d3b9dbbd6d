"""Model references to artifacts of OCI registries, by the digest of their manifest."""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import hide
from mjcompose.sources.blobs import files_below, sha256_of
from mjcompose.sources.fetching import Lookup, not_at_hand, source_in, unlocked
from mjcompose.sources.reference import (
    Form,
    Origin,
    Reference,
    Source,
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
    from mjcompose.sources.store import Entry, Store

_FORM = Form(
    "oci:registry.io/repo@sha256:HEX#path/model.xml",
    "a file of an artifact in an OCI registry, in a layer that is a tar or a file; HEX is the digest of the manifest",
)
_REPOSITORY = re.compile(r"[a-z0-9]+((\.|_{1,2}|-+|/)[a-z0-9]+)*")
_DIGEST = re.compile(r"sha256:([0-9a-f]{64})")
_ACCEPT = "application/vnd.oci.image.manifest.v1+json, application/vnd.docker.distribution.manifest.v2+json"
_BEARER = re.compile(r'(realm|service|scope)="([^"]*)"')
_TOKEN = re.compile(r"[\x21-\x7e]+")
_TITLE = "org.opencontainers.image.title"
_MOST_LAYERS = 1000


def _parse(text: str) -> Reference:
    location, _, path = bare(text, _FORM).partition("#")
    address, _, digest = location.partition("@")
    registry, _, repository = address.partition("/")
    check_secrets(text, "")
    is_host = "." in registry or ":" in registry or registry == "localhost"
    if not is_host or take_apart(f"https://{registry}/") is None or not _REPOSITORY.fullmatch(repository):
        raise malformed(text, _FORM, "does not say the registry and the repository")
    if (found := _DIGEST.fullmatch(digest)) is None:
        raise malformed(text, _FORM, "does not say the digest, which is sha256: and 64 digits of 0-9 and a-f")
    if not path:
        raise malformed(text, _FORM, "does not say the file inside the artifact")
    return Reference(text, KIND, address, path=path, revision=found[1])


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    """Return the file, from the store or else from the registry. Raises SourceError."""
    from mjcompose.sources.store import Store, name_of  # a model that the cache knows is not fetched

    id, fetching = reference.id, lookup.fetching
    if id not in fetching.origins:
        if fetching.pin(id) is None and fetching.locked:
            raise unlocked(reference, fetching)
        store, key = Store.of(lookup.environment), name_of(f"oci:sha256:{reference.revision}")
        entry = store.get("archive", key)
        if entry is None and fetching.offline:
            raise not_at_hand(reference)
        if entry is None:
            with store.lock(key, fetching.progress), store.usable():
                entry = store.get("archive", key) or _Artifact(reference, store, lookup).fetched(key)
        pin = reference.revision
        fetching.origins[id] = Origin(id, reference.kind, entry.content, sha256=pin, stored=entry.files)
    return source_in(fetching.origins[id], reference)


@dataclass(frozen=True, slots=True)
class _Artifact:
    reference: Reference
    store: Store
    lookup: Lookup

    def fetched(self, key: str) -> Entry:
        self.lookup.fetching.progress(f"fetching {self.reference.id}")
        registry, _, repository = self.reference.name.partition("/")
        scheme = "http" if is_this_machine(registry) else "https"
        base = f"{scheme}://{registry}/v2/{repository}"
        content, headers = self._manifest(f"{base}/manifests/sha256:{self.reference.revision}")
        layers = self._layers(content)

        def fill(target: Path) -> None:
            self._fill(target, base, layers, headers=headers)

        return self.store.add("archive", key, self.reference.id, fill=fill, about={})

    def _manifest(self, url: str) -> tuple[bytes, dict[str, str]]:
        """Return the manifest, and the header with the token that anybody gets, if the registry wants one."""
        from mjcompose.sources.download import ask

        headers: dict[str, str] = {}
        answer = ask(url, {"Accept": _ACCEPT}, self.lookup)
        if answer.status == 401:
            headers = self._token(answer.headers.get("WWW-Authenticate", ""), url)
            answer = ask(url, {"Accept": _ACCEPT, **headers}, self.lookup)
        if answer.status == 404:
            raise SourceError("source-not-found", f"`{self.reference.id}` does not exist: the registry answered 404")
        if answer.status != 200:
            why = f"the registry answered {answer.status}"
            raise SourceError("source-fetch", f"`{self.reference.id}` cannot be fetched: {why}")
        self._check(hashlib.sha256(answer.body).hexdigest(), self.reference.revision)
        return answer.body, headers

    def _token(self, challenge: str, url: str) -> dict[str, str]:
        from mjcompose.sources.download import ask

        told = dict(_BEARER.findall(challenge)) if challenge.lower().startswith("bearer ") else {}
        realm = take_apart(told.pop("realm", ""))
        is_open = realm is not None and url.startswith("http:") and is_this_machine(realm.netloc)
        if realm is None or not (realm.scheme == "https" or (realm.scheme == "http" and is_open)):
            message = f"`{self.reference.id}` cannot be fetched: the registry requires a login, which is not supported"
            raise SourceError("source-fetch", message)
        answer = ask(f"{realm.geturl()}?{urlencode(told)}", {}, self.lookup)
        try:
            found: Any = json.loads(answer.body) if answer.status == 200 else {}
            token = found.get("token") or found.get("access_token")
        except (ValueError, RecursionError, AttributeError):
            token = None
        if not isinstance(token, str) or not _TOKEN.fullmatch(token):
            message = (
                f"`{self.reference.id}` cannot be fetched: `{hide(realm.geturl())}` gives no token without a login"
            )
            raise SourceError("source-fetch", message)
        return {"Authorization": f"Bearer {token}"}

    def _layers(self, content: bytes) -> list[tuple[str, str | None]]:
        """Return the sha256 of each layer, and the file name of a layer that is one file."""
        found: list[tuple[str, str | None]] = []
        try:
            for layer in json.loads(content)["layers"]:
                digest = _DIGEST.fullmatch(layer["digest"])
                title = (layer.get("annotations") or {}).get(_TITLE)
                is_tar = "tar" in layer["mediaType"] or "zip" in layer["mediaType"]
                if digest is None or not isinstance(title, str | None):
                    raise ValueError(layer)
                found.append((digest[1], None if is_tar else title))
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            found = []
        if not 0 < len(found) <= _MOST_LAYERS:
            message = f"`{self.reference.id}` is refused: it is not the manifest of an artifact with layers"
            raise SourceError("archive-refused", message, help="write the digest of one image, not of an index")
        return found

    def _fill(self, target: Path, base: str, layers: list[tuple[str, str | None]], *, headers: dict[str, str]) -> None:
        from mjcompose.sources.download import download_object, forget
        from mjcompose.sources.web_archive import Unsafe, check, check_name, unpack

        for sha256, title in layers:
            partial = self.store.folder / "partial" / f"{sha256}.part"
            partial.parent.mkdir(parents=True, exist_ok=True)
            download_object(f"{base}/blobs/sha256:{sha256}", partial, headers, lookup=self.lookup)
            try:
                self._check(sha256_of(partial), sha256)
                if title is None:
                    unpack(partial, target)
                else:
                    check_name(title)
                    (target / title).parent.mkdir(parents=True, exist_ok=True)
                    if os.path.lexists(target / title):
                        raise Unsafe(f"it holds `{title}` twice")
                    partial.replace(target / title)
                sizes = [path.stat().st_size for _, path in files_below(target)]
                check(len(sizes), sum(sizes))
            except (Unsafe, FileExistsError, NotADirectoryError) as fault:
                message = f"`{self.reference.id}` is refused: {fault}"
                raise SourceError("archive-refused", message, help=getattr(fault, "help", None)) from None
            finally:
                forget(partial)

    def _check(self, there: str, wanted: str) -> None:
        if there != wanted:
            message = f"the registry has other bytes than `{self.reference.id}` pins"
            raise SourceError("source-changed", message, notes=(f"sha256 {wanted} is pinned, {there} is there",))


KIND = SourceKind(
    name="oci", forms=(_FORM,), local_schemes=(), separator="#", is_local=False, is_fetched=True, runs_code=False,
    pins=frozenset({"sha256"}), variables=(), libraries=(), parse=_parse, resolve=_resolve,
    host=lambda reference: reference.name.partition("/")[0], is_of_this_machine=never,
)  # fmt: skip

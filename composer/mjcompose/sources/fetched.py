"""Model references to sources that are fetched: archives, objects, artifacts, and repositories of git.

A lock pins archives on the web, in object stores and in OCI registries by their sha256. It pins git repositories, and
repositories of the Hugging Face Hub (with Git LFS), by their commit. `fsspec` reads object stores with the user's own
credentials.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import hide
from mjcompose.base.limits import advice, in_force, written
from mjcompose.sources import license, reference as forms
from mjcompose.sources.address import is_private, is_this_machine, take_apart
from mjcompose.sources.blobs import files_below, sha256_of
from mjcompose.sources.fetching import Lookup, not_at_hand, source_in, unlocked
from mjcompose.sources.reference import Form, Library, Origin, Reference, Source, SourceError, SourceKind, malformed

if TYPE_CHECKING:
    from mjcompose.sources.download import Version
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source
    from mjcompose.sources.store import Store, StoreEntry


_ARCHIVE_FORM = Form(
    "https://host/archive.zip#path/model.xml", "a file in a zip or tar (plain, gz, bz2, xz) on the web"
)
_PINNED = Form("https://host/archive.zip@sha256:HEX#path/model.xml", "the same; another archive there is an error")


def _parse_archive(text: str) -> Reference:
    scheme, _, rest = text.partition(":")
    location, _, path = rest.partition("#")
    host, _, archive = location.removeprefix("//").partition("/")
    forms.check_secrets(text, host)
    archive, _, sha256 = archive.partition("@sha256:")
    if not host or not archive:
        raise malformed(text, _ARCHIVE_FORM, "does not say the archive")
    forms.check_address(text, _ARCHIVE_FORM, f"{scheme}://{host}/{archive}")
    if not path:
        raise malformed(text, _ARCHIVE_FORM, "does not say the file inside the archive")
    _check_pin(text, _ARCHIVE_FORM, location=location, sha256=sha256)
    return Reference(text, ARCHIVE, f"{scheme}://{host}/{archive}", path=path, revision=sha256)


def _check_pin(text: str, form: Form, *, location: str, sha256: str) -> None:
    if "@sha256:" in location and not re.fullmatch("[0-9a-f]{64}", sha256):
        raise malformed(text, form, "has a sha256 that is not 64 digits of 0-9 and a-f")


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.web_archive import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup, _download) if reference.kind is BUCKET else resolve(reference, lookup)


ARCHIVE = SourceKind(
    name="archive",
    forms=(_ARCHIVE_FORM, _PINNED),
    local_schemes=("http",),
    separator="#",
    is_local=False,
    is_fetched=True,
    runs_code=False,
    pins=frozenset({"sha256"}),
    variables=(),
    libraries=(),
    parse=_parse_archive,
    resolve=_resolve,
    host=forms.host_of_url,
    is_of_this_machine=forms.never,
)


_S3 = Form("s3://bucket/archive.zip#path/model.xml", "a file in a zip or tar in a bucket of S3")
_GS = Form(
    "gs://bucket/archive.zip#path/model.xml", "the same in Google Cloud Storage; `@sha256:HEX` pins it, as above"
)
_PACKAGES = {"s3": "s3fs", "gs": "gcsfs"}
_PLACE = re.compile(r"//([a-z0-9][a-z0-9._-]+)/([^?\\]+)")
_CHUNK = 1024 * 1024


def _parse_bucket(text: str) -> Reference:
    form = _S3 if text.startswith("s3:") else _GS
    location, _, path = text.partition("#")
    address, _, sha256 = location.partition("@sha256:")
    forms.check_secrets(text, address.partition("//")[2].partition("/")[0])
    place = _PLACE.fullmatch(address.partition(":")[2])
    # `::` is how fsspec chains file systems, so it could name files of this machine.
    if place is None or "::" in address or {"", ".", ".."} & {*place[2].split("/")}:
        raise malformed(text, form, "does not say the bucket and the archive")
    _check_pin(text, form, location=location, sha256=sha256)
    if not path:
        raise malformed(text, form, "does not say the file inside the archive")
    return Reference(text, BUCKET, address, path=path, revision=sha256)


def _download(url: str, partial: Path, known: Version, *, lookup: Lookup) -> Version | None:
    """Download an archive to `partial`; return None if it still has the version `known`. Raises SourceError."""
    from mjcompose.sources.download import Version, forget

    package = _PACKAGES[url.partition(":")[0]]
    try:
        import fsspec

        fs, path = fsspec.core.url_to_fs(url)
    except ImportError:
        message = f"`{url}` needs the Python packages `fsspec` and `{package}`, and one of them is not installed"
        raise SourceError("source-fetch", message, help=f'run `pip install "mjcompose[remote]" {package}`') from None
    except Exception as error:  # each file system raises its own exceptions
        raise _failed(url, error) from error
    try:
        fs.invalidate_cache()
        about = fs.info(path)
        if about.get("type") == "directory":
            raise FileNotFoundError(path)
        # From a store without etags, every build downloads the bytes again.
        version = Version(etag=str(about.get("ETag") or about.get("etag") or ""))
        if version.etag and version == known:
            return None
        with fs.open(path, "rb") as stream:
            _write_archive(stream, partial, url)
    except SourceError:
        forget(partial)
        raise
    except FileNotFoundError:
        raise SourceError("source-not-found", f"`{url}` does not exist, or you may not read it") from None
    except Exception as error:
        raise _failed(url, error) from error
    return version


def _write_archive(stream: Any, partial: Path, url: str) -> None:
    size = 0
    most = in_force().source_size
    with partial.open("wb") as file:
        while chunk := stream.read(_CHUNK):
            size += len(chunk)
            if size > most:
                message = f"`{url}` is larger than {written('source-size', most)}"
                raise SourceError("archive-refused", message, help=advice("source-size"))
            file.write(chunk)


def _failed(url: str, error: Exception) -> SourceError:
    said = " ".join(str(error).split()) or type(error).__name__
    help = "check your credentials for the store; with `--offline` mjcompose uses the store"
    return SourceError("source-fetch", f"`{url}` cannot be fetched", notes=(hide(said)[:300],), help=help)


BUCKET = SourceKind(
    name="bucket",
    forms=(_S3, _GS),
    local_schemes=(),
    separator="#",
    is_local=False,
    is_fetched=True,
    runs_code=False,
    pins=frozenset({"sha256"}),
    variables=(),
    libraries=(Library("fsspec", "remote"),),
    # The credentials are of this machine: a fetched recipe must not use them.
    parse=_parse_bucket,
    resolve=_resolve,
    host=forms.no_host,
    is_of_this_machine=forms.always,
)


_OCI_FORM = Form(
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


def _parse_oci(text: str) -> Reference:
    location, _, path = forms.bare(text, _OCI_FORM).partition("#")
    address, _, digest = location.partition("@")
    registry, _, repository = address.partition("/")
    forms.check_secrets(text, "")
    is_host = "." in registry or ":" in registry or registry == "localhost"
    if not is_host or take_apart(f"https://{registry}/") is None or not _REPOSITORY.fullmatch(repository):
        raise malformed(text, _OCI_FORM, "does not say the registry and the repository")
    sha256 = _DIGEST.fullmatch(digest)
    if sha256 is None:
        raise malformed(text, _OCI_FORM, "does not give the digest, which is sha256: and 64 digits of 0-9 and a-f")
    if not path:
        raise malformed(text, _OCI_FORM, "does not say the file inside the artifact")
    return Reference(text, OCI, address, path=path, revision=sha256[1])


def _resolve_oci(reference: Reference, lookup: Lookup) -> Source:
    """Return the file from the store or the registry. Raises SourceError."""
    from mjcompose.sources.store import Store, name_of  # a model that the cache knows is not fetched

    id = reference.id
    fetching = lookup.fetching
    if id not in fetching.origins:
        if fetching.pin(id) is None and fetching.locked:
            raise unlocked(reference, fetching)
        store = Store.of(lookup.environment)
        key = name_of(f"oci:sha256:{reference.revision}")
        entry = store.get("archive", key)
        if entry is None and fetching.offline:
            raise not_at_hand(reference)
        if entry is None:
            with store.lock(key, fetching.progress), store.usable():
                entry = store.get("archive", key) or _Artifact(reference, store, lookup).fetched(key)
        pin = reference.revision
        fetching.origins[id] = Origin(id, reference.kind, entry.content, sha256=pin, stored=entry.files)
    return source_in(fetching.origins[id], reference)


class _Artifact(Struct):
    reference: Reference
    store: Store
    lookup: Lookup

    def fetched(self, key: str) -> StoreEntry:
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
        """Return the manifest, and the header with a public token if the registry requires one."""
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
        from mjcompose.sources.download import Version, download, forget
        from mjcompose.sources.web_archive import Unsafe, check, check_name, unpack

        for sha256, title in layers:
            partial = self.store.folder / "partial" / f"{sha256}.part"
            partial.parent.mkdir(parents=True, exist_ok=True)
            download(f"{base}/blobs/sha256:{sha256}", partial, Version(), lookup=self.lookup, headers=headers)
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


OCI = SourceKind(
    name="oci",
    forms=(_OCI_FORM,),
    local_schemes=(),
    separator="#",
    is_local=False,
    is_fetched=True,
    runs_code=False,
    pins=frozenset({"sha256"}),
    variables=(),
    libraries=(),
    parse=_parse_oci,
    resolve=_resolve_oci,
    host=lambda reference: reference.name.partition("/")[0],
    is_of_this_machine=forms.never,
)


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
    form = next((known for known in _GIT_FORMS if known.scheme == scheme), _GIT_FORMS[0])
    location, _, path = rest.partition("#")
    host, _, tail = location.removeprefix("//").partition("/")
    forms.check_secrets(text, host)
    # Only an `@` after the host starts a revision; before it, an `@` ends a user name.
    repository, at, revision = tail.rpartition("@")
    if not at:
        repository = tail
        revision = ""
    if not repository or bool(host) == (scheme == "git+file"):
        raise malformed(text, form, "does not say the repository")
    if host:
        forms.check_address(text, form, f"{scheme.removeprefix('git+')}://{host}/{repository}")
    revision = revision_in(revision)
    if not revision:
        raise malformed(text, form, "does not say the revision")
    if not path:
        raise malformed(text, form, "does not say the file inside the repository")
    return Reference(text, GIT, f"{scheme.removeprefix('git+')}://{host}/{repository}", path=path, revision=revision)


def revision_in(text: str) -> str:
    """Return the name of a revision from its escaped form; empty if it cannot be a revision. No I/O."""
    if "%" in text:
        from urllib.parse import unquote  # most builds fetch nothing

        text = unquote(text)
    return "" if text.startswith("-") or forms.CONTROL.search(text) else text


def _resolve_git(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup)


GIT = SourceKind(
    name="git",
    forms=_GIT_FORMS,
    local_schemes=("git+http",),
    separator="#",
    is_local=False,
    is_fetched=True,
    runs_code=False,
    pins=frozenset({"commit", "tree"}),
    variables=(),
    libraries=(),
    parse=_parse_git,
    resolve=_resolve_git,
    host=forms.host_of_url,
    is_of_this_machine=lambda reference: reference.name.startswith("file:"),
)


_HF_FORM = Form(
    "hf:org/repo@REV#path/model.xml",
    "a file in a repository of Hugging Face; REV is a branch, a tag or a commit. `hf:datasets/org/repo` is a data set",
)
_HUB = "https://huggingface.co"
_HUB_REPOSITORY = re.compile(r"((datasets|spaces)/)?[A-Za-z0-9_-][\w.-]*/[A-Za-z0-9_-][\w.-]*", re.ASCII)


def _parse_hf(text: str) -> Reference:
    location, _, path = forms.bare(text, _HF_FORM).partition("#")
    forms.check_secrets(text, "")
    repository, _, revision = location.partition("@")
    if not _HUB_REPOSITORY.fullmatch(repository):
        raise malformed(text, _HF_FORM, "does not say the organization and the repository")
    revision = revision_in(revision)
    if not revision:
        raise malformed(text, _HF_FORM, "does not say the revision")
    if not path:
        raise malformed(text, _HF_FORM, "does not say the file inside the repository")
    return Reference(text, HF, repository, path=path, revision=revision)


def _resolve_hf(reference: Reference, lookup: Lookup) -> Source:
    """Return the file from the repository that git fetches; git checks the hash of the commit. Raises SourceError."""
    from mjcompose.sources.git_repository import resolve  # a model that the cache knows is not fetched

    source = resolve(replace(reference, name=f"{_hub(reference, lookup)}/{reference.name}"), lookup)
    assert source.origin is not None, "what is fetched has an origin"
    return replace(source, license=license.of_card(source.origin.root / "README.md"))


def _hub(reference: Reference, lookup: Lookup) -> str:
    """Return the address of the hub; a fetched recipe must not use a hub in the local network."""
    hub = (lookup.environment.get("HF_ENDPOINT") or _HUB).rstrip("/")
    parts = take_apart(hub)
    is_open = parts is not None and parts.scheme == "http" and is_this_machine(parts.netloc)
    if parts is None or parts.query or not (parts.scheme == "https" or is_open):
        message = f"`HF_ENDPOINT` is `{hide(hub)}`, which is not an https address of a server without a login"
        raise SourceError("source-fetch", message, help=f"write it as `{_HUB}`, or unset it")
    if lookup.is_confined and is_private(parts.netloc, lookup.fetching.offline):
        message = f"`{reference.text}`, which a fetched recipe names, is at `{hub}`, in the network of this machine"
        help = f'if you trust it with that, write in your own recipe `trust: {{references: ["{reference.id}"]}}`'
        raise SourceError("source-outside", message, help=help)
    return hub


HF = SourceKind(
    name="hf",
    forms=(_HF_FORM,),
    local_schemes=(),
    separator="#",
    is_local=False,
    is_fetched=True,
    runs_code=False,
    pins=frozenset({"commit", "tree"}),
    variables=("HF_ENDPOINT",),
    libraries=(),
    parse=_parse_hf,
    resolve=_resolve_hf,
    host=lambda reference: "huggingface.co",
    is_of_this_machine=forms.never,
)

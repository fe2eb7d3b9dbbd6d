"""Model references to archives in object stores, read through `fsspec` with the user's own credentials."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.diagnostic import hide
from mjcompose.base.limits import advice, in_force, written
from mjcompose.sources.reference import (
    Form,
    Library,
    Reference,
    SourceError,
    SourceKind,
    always,
    check_secrets,
    malformed,
    no_host,
)

if TYPE_CHECKING:
    from mjcompose.sources.download import Version
    from mjcompose.sources.fetching import Lookup
    from mjcompose.sources.reference import Source

_S3 = Form("s3://bucket/archive.zip#path/model.xml", "a file in a zip or tar in a bucket of S3")
_GS = Form(
    "gs://bucket/archive.zip#path/model.xml", "the same in Google Cloud Storage; `@sha256:HEX` pins it, as above"
)
_PACKAGES = {"s3": "s3fs", "gs": "gcsfs"}
_PLACE = re.compile(r"//([a-z0-9][a-z0-9._-]+)/([^?\\]+)")
_CHUNK = 1024 * 1024


def _parse(text: str) -> Reference:
    form = _S3 if text.startswith("s3:") else _GS
    location, _, path = text.partition("#")
    address, _, sha256 = location.partition("@sha256:")
    check_secrets(text, address.partition("//")[2].partition("/")[0])
    place = _PLACE.fullmatch(address.partition(":")[2])
    # `::` is how fsspec chains file systems, so it could name files of this machine.
    if place is None or "::" in address or {"", ".", ".."} & {*place[2].split("/")}:
        raise malformed(text, form, "does not say the bucket and the archive")
    if "@sha256:" in location and not re.fullmatch("[0-9a-f]{64}", sha256):
        raise malformed(text, form, "has a sha256 that is not 64 digits of 0-9 and a-f")
    if not path:
        raise malformed(text, form, "does not say the file inside the archive")
    return Reference(text, KIND, address, path=path, revision=sha256)


def _resolve(reference: Reference, lookup: Lookup) -> Source:
    from mjcompose.sources.web_archive import resolve  # a model that the cache knows is not fetched

    return resolve(reference, lookup, _download)


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
        # A store without etags is asked for the bytes in every build.
        version = Version(etag=str(about.get("ETag") or about.get("etag") or ""))
        if version.etag and version == known:
            return None
        with fs.open(path, "rb") as stream:
            _write(stream, partial, url)
    except SourceError:
        forget(partial)
        raise
    except FileNotFoundError:
        raise SourceError("source-not-found", f"`{url}` does not exist, or you may not read it") from None
    except Exception as error:
        raise _failed(url, error) from error
    return version


def _write(stream: Any, partial: Path, url: str) -> None:
    size, most = 0, in_force().source_size
    with partial.open("wb") as file:
        while chunk := stream.read(_CHUNK):
            size += len(chunk)
            if size > most:
                message = f"`{url}` is larger than {written('source-size', most)}"
                raise SourceError("archive-refused", message, help=advice("source-size"))
            file.write(chunk)


def _failed(url: str, error: Exception) -> SourceError:
    said = " ".join(str(error).split()) or type(error).__name__
    help = "see that your credentials for the store are right; with `--offline` mjcompose uses the store"
    return SourceError("source-fetch", f"`{url}` cannot be fetched", notes=(hide(said)[:300],), help=help)


KIND = SourceKind(
    name="bucket", forms=(_S3, _GS), local_schemes=(), separator="#", is_local=False, is_fetched=True,
    runs_code=False, pins=frozenset({"sha256"}), variables=(), libraries=(Library("fsspec", "remote"),), parse=_parse,
    # The credentials are of this machine: a fetched recipe must not use them.
    resolve=_resolve, host=no_host, is_of_this_machine=always,
)  # fmt: skip

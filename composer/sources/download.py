"""One file over HTTP: redirects, proxies, timeouts, tries with growing pauses, and resumption."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from composer.sources.error import SourceError
from composer.sources.reference import is_this_machine

if TYPE_CHECKING:
    from urllib3 import BaseHTTPResponse, PoolManager

_TRIES = 5
_PAUSE = 0.25
_CHUNK = 256 * 1024
_LIMIT = 8 * 1024**3
_BUSY = (429, 500, 502, 503, 504)


@dataclass(frozen=True, slots=True)
class Version:
    """What a server calls the version of a file that it gave; either may be empty."""

    etag: str = ""
    modified: str = ""

    @property
    def token(self) -> str:
        """What `If-Range` takes: a weak etag does not promise the same bytes."""
        return self.etag if self.etag and not self.etag.startswith("W/") else self.modified


class _Broken(Exception):
    """The transfer broke off; what there is stays for the next try."""


def download(
    url: str,
    partial: Path,
    *,
    environment: Mapping[str, str],
    progress: Callable[[str], None],
    known: Version,
) -> Version | None:
    """Have the file at `partial`, going on from what an earlier process left there.

    None where the server says that it still is the version `known`; then there is no file. Raises SourceError
    with what is there kept for the next time, and OSError.
    """
    return _Download(url, partial, environment, progress, known).run()


@dataclass(frozen=True, slots=True)
class _Download:
    url: str
    partial: Path
    environment: Mapping[str, str]
    progress: Callable[[str], None]
    known: Version

    def run(self) -> Version | None:
        from urllib3.exceptions import HTTPError

        pool = self._pool()
        try:
            last = ""
            for attempt in range(_TRIES):
                if attempt:
                    self.progress(f"{last}; trying again")
                    time.sleep(_PAUSE * 2**attempt)
                try:
                    return self._once(pool)
                except _Broken as broken:
                    last = str(broken)
                except HTTPError as error:
                    last = _in_short(error)
            raise SourceError(
                "source-fetch",
                f"`{self.url}` cannot be fetched",
                notes=(f"after {_TRIES} tries: {last}",),
                help="try again later, which goes on from where it broke off; with `--offline` what is in the store"
                " is used",
            )
        finally:
            pool.clear()

    def _pool(self) -> PoolManager:
        import urllib3

        parts = urlsplit(self.url)
        seconds = _seconds(self.environment)
        timeout = urllib3.Timeout(connect=seconds, read=seconds)
        named = (f"{parts.scheme}_proxy", f"{parts.scheme.upper()}_PROXY", "all_proxy", "ALL_PROXY")
        proxy = next((value for name in named if (value := self.environment.get(name))), None)
        spared = self.environment.get("no_proxy") or self.environment.get("NO_PROXY") or ""
        if proxy and not _is_spared(parts.netloc, spared):
            try:
                return urllib3.ProxyManager(proxy if "://" in proxy else f"http://{proxy}", timeout=timeout)
            except (ValueError, urllib3.exceptions.HTTPError) as error:
                raise SourceError("source-fetch", f"the proxy `{proxy}` cannot be used: {error}") from None
        return urllib3.PoolManager(timeout=timeout)

    def _once(self, pool: PoolManager) -> Version | None:
        import urllib3

        have, started = self._begun()
        headers = {"Accept-Encoding": "identity", "User-Agent": "mjcompose"}
        if have and started.token:
            headers |= {"Range": f"bytes={have}-", "If-Range": started.token}
        elif self.known.etag:
            headers["If-None-Match"] = self.known.etag
        elif self.known.modified:
            headers["If-Modified-Since"] = self.known.modified
        response = pool.request(
            "GET", self.url, headers=headers, preload_content=False, decode_content=False,
            # Redirects alone: what else fails is tried again here, where the bytes that have come are known.
            retries=urllib3.Retry(total=10, connect=0, read=0, redirect=10, status=0, other=0,
                                  status_forcelist=(), raise_on_redirect=True),
        )  # fmt: skip
        try:
            return self._taken(response, have)
        finally:
            response.close()

    def _taken(self, response: BaseHTTPResponse, have: int) -> Version | None:
        status = response.status
        self._check_way(response)
        if status == 304:
            return None
        if status in _BUSY:
            raise _Broken(f"the server answered {status} {response.reason or ''}".rstrip())
        if status == 416:
            self.forget()
            raise _Broken("the server has another file now")
        if status in (404, 410):
            raise SourceError("source-not-found", f"`{self.url}` is not there: the server answered {status}")
        if status not in (200, 206):
            why = " (it wants a login, which is not supported)" if status in (401, 403, 407) else ""
            raise SourceError(
                "source-fetch", f"`{self.url}` cannot be fetched: the server answered {status}{why}"
            )
        version = Version(response.headers.get("ETag", ""), response.headers.get("Last-Modified", ""))
        resumed = status == 206
        if resumed and not response.headers.get("Content-Range", "").startswith(f"bytes {have}-"):
            self.forget()
            raise _Broken("the server answered with another part than it was asked for")
        self._write(response, version, have if resumed else 0)
        return version

    def _check_way(self, response: BaseHTTPResponse) -> None:
        """Refuse what came by an address that is not encrypted, this machine's own excepted."""
        hops = response.retries.history if response.retries is not None else ()
        was_open = urlsplit(self.url).scheme == "http"
        for at in (*(each.redirect_location or "" for each in hops), response.geturl() or ""):
            way = urlsplit(at)
            if at != self.url and way.scheme == "http" and not (was_open and is_this_machine(way.netloc)):
                raise SourceError("source-fetch", f"`{self.url}` leads to `{at}`, which is not encrypted")

    def _write(self, response: BaseHTTPResponse, version: Version, size: int) -> None:
        from urllib3.exceptions import HTTPError

        length = response.headers.get("Content-Length", "")
        total = size + int(length) if length.isdigit() else 0
        self._note.write_text(
            json.dumps({"etag": version.etag, "modified": version.modified}), encoding="utf-8"
        )
        told = time.monotonic()
        with self.partial.open("ab" if size else "wb") as file:
            try:
                for chunk in response.stream(_CHUNK, decode_content=False):
                    size += len(chunk)
                    if max(size, total) > _LIMIT:
                        raise SourceError(
                            "archive-refused", f"`{self.url}` is larger than {_LIMIT >> 30} GiB"
                        )
                    file.write(chunk)
                    if time.monotonic() - told > 1:
                        told = time.monotonic()
                        self.progress(f"  {size >> 20} MiB" + (f" of {total >> 20} MiB" if total else ""))
            except HTTPError as error:
                raise _Broken(_in_short(error)) from None
        if total and size != total:
            raise _Broken(f"the transfer broke off after {size} of {total} bytes")

    @property
    def _note(self) -> Path:
        return self.partial.with_suffix(".version")

    def _begun(self) -> tuple[int, Version]:
        """How many bytes an earlier try left, and of which version."""
        try:
            told = json.loads(self._note.read_text(encoding="utf-8"))
            return self.partial.stat().st_size, Version(str(told["etag"]), str(told["modified"]))
        except (OSError, ValueError, KeyError, TypeError):
            return 0, Version()

    def forget(self) -> None:
        self.partial.unlink(missing_ok=True)
        self._note.unlink(missing_ok=True)


def forget(partial: Path) -> None:
    """Take a download away that is finished or of no use."""
    partial.unlink(missing_ok=True)
    partial.with_suffix(".version").unlink(missing_ok=True)


def _is_spared(host: str, spared: str) -> bool:
    """Whether `no_proxy` names the host."""
    import urllib.request

    bypass: Any = getattr(urllib.request, "proxy_bypass_environment")  # noqa: B009  public, and not in the stubs
    return bool(bypass(host, {"no": spared}))


def _seconds(environment: Mapping[str, str]) -> float:
    """How long a server may say nothing."""
    try:
        return max(0.1, float(environment.get("MJCOMPOSE_TIMEOUT", "30")))
    except ValueError:
        return 30.0


def _in_short(error: Exception) -> str:
    """The cause, without the objects of the library."""
    reason = getattr(error, "reason", None)
    text = str(reason if isinstance(reason, Exception) else error)
    return text.rpartition(">: ")[2] or text

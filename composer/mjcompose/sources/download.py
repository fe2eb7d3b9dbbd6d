"""Download one file over HTTP, with redirects, proxies, timeouts, retries and resumption."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import hide
from mjcompose.base.files import read_regular
from mjcompose.base.limits import advice, in_force, written
from mjcompose.base.words import counted
from mjcompose.sources.address import addresses_of, is_private, is_this_machine, take_apart
from mjcompose.sources.fetching import Silence, patience, waiting
from mjcompose.sources.reference import TO_TRUST, SourceError, outside_network

if TYPE_CHECKING:
    from urllib.parse import SplitResult

    from urllib3 import BaseHTTPResponse, PoolManager

    from mjcompose.sources.fetching import Lookup

_TRIES = 5
_PAUSE = 0.25
_PATIENCE = 60.0
"""The longest wait in seconds that a server may ask for; a longer one is reported at once."""
_HOPS = 10
_CHUNK = 256 * 1024
_MOST_JSON = 16 * 1024**2
_LEAST = 1024
"""A server that sends fewer bytes than this within the timeout counts as silent."""
_BUSY = (429, 500, 502, 503, 504)


class Version(Struct):
    """A server's version of a file; either field may be empty."""

    etag: str = ""
    modified: str = ""

    @property
    def token(self) -> str:
        """The value for `If-Range`: a weak etag does not promise the same bytes."""
        return self.etag if self.etag and not self.etag.startswith("W/") else self.modified


class _Broken(Exception):
    """The transfer broke off. The next try starts after `pause` seconds and resumes."""

    def __init__(self, message: str, pause: float = 0.0) -> None:
        super().__init__(message)
        self.pause = pause


def download(
    url: str, partial: Path, known: Version, *, lookup: Lookup, headers: Mapping[str, str] | None = None
) -> Version | None:
    """Download the file to `partial`, resuming an earlier download. Raises SourceError and OSError.

    Return None, without writing a file, if the server still has the version `known`. After a SourceError the
    partial file stays for the next run. Only the server of `url` gets the `headers`.
    """
    return _Download(url, lookup, headers or {}, partial, known).run()


class ServerAnswer(Struct):
    """The answer of a server: `headers` is a mapping without case."""

    status: int
    headers: Mapping[str, str]
    body: bytes


def ask(url: str, headers: Mapping[str, str], lookup: Lookup) -> ServerAnswer:
    """Return a short answer of a server, whatever its status, and follow no redirect. Raises SourceError."""
    return _Download(url, lookup, headers).ask("GET", None)


def post_json(url: str, question: object, media: str, lookup: Lookup) -> tuple[int, Any]:
    """Send JSON, and return the status and the JSON of the answer, or None if it has none. Raises SourceError."""
    headers = {"Accept": media, "Content-Type": media}
    answer = _Download(url, lookup, headers).ask("POST", json.dumps(question).encode())
    try:
        return answer.status, json.loads(answer.body)
    except (ValueError, RecursionError):
        return answer.status, None


class _Download(Struct, frozen=False):
    url: str
    lookup: Lookup
    headers: Mapping[str, str]
    partial: Path = Path()
    known: Version = Version()
    silence: Silence = field(init=False)

    def __post_init__(self) -> None:
        self.silence = Silence(patience(self.lookup.environment))

    @property
    def shown(self) -> str:
        """The address without secrets, which LFS and registries put into addresses."""
        return hide(self.url)

    def _failed(self, why: str, *notes: str, help: str | None = None, code: str = "source-fetch") -> SourceError:
        return SourceError(code, f"`{self.shown}` {why}", notes=notes, help=help)

    def run(self) -> Version | None:
        from urllib3 import exceptions as errors

        last = ""
        pause = 0.0
        attempt = 0
        while attempt < _TRIES and not self.silence.is_nearly_over:
            if attempt:
                own = _PAUSE * 2**attempt
                self.lookup.fetching.progress(f"{last}; trying again" + (f" in {pause:.0f} s" if pause > 5 else ""))
                time.sleep(max(pause, own))
                if pause > own:
                    self.silence.broken()  # the server requires the pause
            attempt += 1
            try:
                return self._once()
            except _Broken as broken:
                last = str(broken)
                pause = broken.pause
            except errors.LocationValueError as error:
                raise self._failed(f"cannot be fetched: {_in_short(error)}") from None
            except errors.HTTPError as error:
                last = _in_short(error)
                pause = 0.0
                # urllib3 also reports a refused connection as a timeout.
                if isinstance(error, errors.TimeoutError) and not isinstance(error, errors.NewConnectionError):
                    last = f"the server said nothing for {patience(self.lookup.environment):g} s"
                original = getattr(error, "original_error", error)
                if isinstance(original, errors.NameResolutionError):  # also a second later
                    help = "check the network and the address; with `--offline` mjcompose uses the store"
                    why = "cannot be fetched: the name of its server cannot be resolved"
                    raise self._failed(why, last, help=help) from None
                if "CERTIFICATE_VERIFY_FAILED" in last:
                    help = "name a file with the certificate of its authority in `SSL_CERT_FILE`"
                    why = "cannot be fetched: its server has no certificate that this machine trusts"
                    raise self._failed(why, last, help=help) from None
        help = "try again later: the download resumes where it stopped; a slow server gets more time with"
        help += " `MJCOMPOSE_TIMEOUT=120`; with `--offline` mjcompose uses the store"
        raise self._failed("cannot be fetched", f"after {counted(attempt, 'try')}: {last}", help=help)

    @contextmanager
    def _response(
        self, method: str, at: str, headers: Mapping[str, str], body: bytes | None = None
    ) -> Iterator[BaseHTTPResponse]:
        """Send one request, without following redirects, and yield the answer: every connection begins here."""
        from mjcompose.sources.connections import NotPublicError

        server = self._server(at)
        with self._pool(server) as pool:
            try:
                with waiting(self.lookup.fetching.progress, f"for {server.hostname}"):
                    # Retries happen in this class, which knows the received bytes.
                    response = pool.request(
                        method,
                        at,
                        body=body,
                        headers=headers,
                        preload_content=False,
                        decode_content=False,
                        redirect=False,
                        retries=False,
                    )
            except NotPublicError:
                raise self._outside(at) from None
            try:
                yield response
            finally:
                response.close()

    def _server(self, at: str) -> SplitResult:
        """Return the parts of an address; a fetched recipe must not name a server of this machine or its network."""
        from mjcompose.sources.connections import is_read_alike

        server = take_apart(at)
        if server is None or not is_read_alike(at):
            raise self._failed("cannot be fetched", f"`{hide(at)}` is not an address that all programs read alike")
        if self.lookup.is_confined and is_private(server.netloc):
            raise self._outside(at)
        return server

    def _outside(self, at: str) -> SourceError:
        return outside_network(self.shown, "" if at == self.url else f" leads to `{hide(at)}`, which")

    def _pool(self, server: SplitResult) -> PoolManager:
        import urllib3

        from mjcompose.sources.connections import public_pool

        seconds = self.silence.left  # for all tries together
        timeout = urllib3.Timeout(connect=seconds, read=seconds)
        proxy = self._proxy(server)
        if proxy is None:
            return public_pool(timeout) if self.lookup.is_confined else urllib3.PoolManager(timeout=timeout)
        if self.lookup.is_confined and not addresses_of(server.netloc):
            note = "the proxy would look it up, and could find a server of your network"
            why = "cannot be fetched: the name of its server cannot be resolved on this machine"
            raise self._failed(why, note, help=TO_TRUST)
        try:
            return urllib3.ProxyManager(proxy if "://" in proxy else f"http://{proxy}", timeout=timeout)
        except (ValueError, urllib3.exceptions.HTTPError) as error:
            raise SourceError("source-fetch", f"the proxy `{proxy}` cannot be used: {error}") from None

    def _proxy(self, server: SplitResult) -> str | None:
        """Return the address of the proxy of the user for a server, or None if it is contacted directly."""
        import urllib.request

        environment = self.lookup.environment
        names = (f"{server.scheme}_proxy", f"{server.scheme.upper()}_PROXY", "all_proxy", "ALL_PROXY")
        proxy = next((value for name in names if (value := environment.get(name))), None)
        spared = environment.get("no_proxy") or environment.get("NO_PROXY") or ""
        bypass: Any = getattr(urllib.request, "proxy_bypass_environment")  # noqa: B009  public, and not in the stubs
        return None if bypass(server.netloc, {"no": spared}) else proxy

    def _once(self) -> Version | None:
        have, started = self._begun()
        headers = {"Accept-Encoding": "identity", "User-Agent": "mjcompose"}
        if have and started.token:
            headers |= {"Range": f"bytes={have}-", "If-Range": started.token}
        elif self.known.etag:
            headers["If-None-Match"] = self.known.etag
        elif self.known.modified:
            headers["If-Modified-Since"] = self.known.modified
        at = self.url
        for _ in range(_HOPS + 1):
            own = self.headers if _is_same_server(at, self.url) else {}
            with self._response("GET", at, {**own, **headers}) as response:
                self.silence.broken()
                leads_to = response.get_redirect_location()
                if not leads_to:
                    return self._taken(response, headers, have)
            at = self._next(at, leads_to)
        raise self._failed(f"leads on more than {_HOPS} times", f"last to `{hide(at)}`")

    def ask(self, method: str, body: bytes | None) -> ServerAnswer:
        """Send one request without following redirects, and return the answer, which must be short."""
        from urllib3.exceptions import HTTPError

        headers = {"User-Agent": "mjcompose", "Accept-Encoding": "identity", **self.headers}
        try:
            with self._response(method, self.url, headers, body=body) as response:
                answer = response.read(_MOST_JSON + 1)
        except HTTPError as error:
            raise self._failed(f"cannot be fetched: {_in_short(error)}") from None
        if response.status in _BUSY or len(answer) > _MOST_JSON:
            why = f"the server answered {response.status}" if response.status in _BUSY else "its answer is too large"
            raise self._failed(f"cannot be fetched: {why}")
        return ServerAnswer(response.status, response.headers, answer)

    def _next(self, at: str, leads_to: str) -> str:
        """Return the target of a redirect. Unencrypted addresses are refused, except on this machine."""
        way = take_apart(leads_to, at)
        if way is None or way.scheme not in ("http", "https"):
            raise self._failed(f"leads to `{hide(leads_to)}`, which is not a web address")
        leads_to = way.geturl()
        was_open = self.url.startswith("http:")
        if way.scheme == "http" and not (was_open and is_this_machine(way.netloc)):
            raise self._failed(f"leads to `{hide(leads_to)}`, which is not encrypted")
        return leads_to

    def _taken(self, response: BaseHTTPResponse, headers: Mapping[str, str], have: int) -> Version | None:
        status = response.status
        if status == 304 and ("If-None-Match" in headers or "If-Modified-Since" in headers):
            return None
        if status in _BUSY:
            raise self._busy(response)
        if status == 416:
            forget(self.partial)
            raise _Broken("the server has another file now")
        if status in (404, 410):
            raise self._failed(f"does not exist: the server answered {status}", code="source-not-found")
        if status not in (200, 206):
            why = " (it requires a login, which is not supported)" if status in (401, 403, 407) else ""
            raise self._failed(f"cannot be fetched: the server answered {status}{why}")
        version = Version(response.headers.get("ETag", ""), response.headers.get("Last-Modified", ""))
        resumed = status == 206
        if resumed and not response.headers.get("Content-Range", "").startswith(f"bytes {have}-"):
            forget(self.partial)
            raise _Broken("the server answered with another part than it was asked for")
        self._write(response, version, have if resumed else 0)
        return version

    def _busy(self, response: BaseHTTPResponse) -> Exception:
        """Return the exception for a server that is busy, with the pause that it requests."""
        from urllib3 import Retry
        from urllib3.exceptions import HTTPError

        answered = f"the server answered {response.status} {response.reason or ''}".rstrip()
        try:
            pause = Retry().get_retry_after(response) or 0.0
        except (HTTPError, ValueError, OverflowError):
            pause = 0.0
        if pause <= _PATIENCE:
            return _Broken(answered, pause)
        note = f"it says `Retry-After: {response.headers.get('Retry-After', '')}`"
        help = "try again later; with `--offline` mjcompose uses the store"
        return self._failed(f"cannot be fetched now: {answered}", note, help=help)

    def _write(self, response: BaseHTTPResponse, version: Version, size: int) -> None:
        from urllib3.exceptions import HTTPError, TimeoutError

        length = response.headers.get("Content-Length", "")
        total = size + int(length) if length.isdigit() else 0
        self._note.write_text(json.dumps({"etag": version.etag, "modified": version.modified}), encoding="utf-8")
        pace = _Pace(size, total, self.lookup)
        most = in_force().source_size
        with self.partial.open("ab" if size else "wb") as file:
            try:
                # Read any bytes that have arrived: `stream` would wait for a full chunk.
                while chunk := response.read1(_CHUNK, decode_content=False):
                    size += len(chunk)
                    if max(size, total) > most:
                        forget(self.partial)
                        why = written("source-size", most)
                        help = advice("source-size", total or None)
                        raise self._failed(f"is larger than {why}", help=help, code="archive-refused")
                    file.write(chunk)
                    self.silence.broken()
                    pace.check(size)
            except HTTPError as error:
                why = ": it stalled" if isinstance(error, TimeoutError) else ""
                of = f" of {total}" if total else ""
                raise _Broken(f"the transfer broke off after {size}{of} bytes{why}") from None
        if total and size != total:
            raise _Broken(f"the transfer broke off after {size} of {total} bytes")

    @property
    def _note(self) -> Path:
        return self.partial.with_suffix(".version")

    def _begun(self) -> tuple[int, Version]:
        try:
            note = json.loads(read_regular(self._note, is_source=False))
            return self.partial.stat().st_size, Version(str(note["etag"]), str(note["modified"]))
        except (OSError, ValueError, KeyError, TypeError):
            return 0, Version()


def _is_same_server(url: str, other: str) -> bool:
    parts = take_apart(url)
    others = take_apart(other)
    return parts is not None and others is not None and parts[:2] == others[:2]


class _Pace:
    """Gives up a transfer in which too little arrives, and reports the size of a long one."""

    def __init__(self, size: int, total: int, lookup: Lookup) -> None:
        self._total = total
        self._seconds = patience(lookup.environment)
        self._progress = lookup.fetching.progress
        self._size = size
        self._since = time.monotonic()
        self._reported = self._since

    def check(self, size: int) -> None:
        """Look at the time, with `size` bytes there. Raises _Broken if the transfer is too slow."""
        now = time.monotonic()
        if now - self._since >= self._seconds and size != self._total:
            if size - self._size < _LEAST:
                of = f" of {self._total}" if self._total else ""
                slow = f"less than 1 KiB came in {self._seconds:g} s"
                raise _Broken(f"the transfer was given up after {size}{of} bytes: {slow}")
            self._since = now
            self._size = size
        if now - self._reported > 1:
            self._reported = now
            of = f" of {self._total >> 20} MiB" if self._total else ""
            self._progress(f"  {size >> 20} MiB{of}")


def forget(partial: Path) -> None:
    """Remove a download that is finished or useless."""
    partial.unlink(missing_ok=True)
    partial.with_suffix(".version").unlink(missing_ok=True)


_OBJECT = re.compile(r"<.*?>: |HTTPS?Connection(Pool)?\(.*?\): ")


def _in_short(error: Exception) -> str:
    said = [str(each) or type(each).__name__ for each in error.args] or [type(error).__name__]
    text = _OBJECT.sub("", ": ".join(each.rstrip(".") for each in said))
    return "".join(each if each.isprintable() else " " for each in text).strip()

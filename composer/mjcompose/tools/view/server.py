"""The server of a page, and its access rules."""

from __future__ import annotations

import contextlib
import gzip
import hmac
import io
import json
import math
import queue
import re
import secrets
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import IPv4Address, IPv6Address, ip_address
from itertools import chain
from threading import BoundedSemaphore, Lock
from typing import Any
from urllib.parse import quote

from mjcompose.base.dataclass import Struct
from mjcompose.tools.view.builder import PageFault, Shown, Workshop
from mjcompose.tools.view.page import BUILT, live
from mjcompose.tools.view.simulation import Simulation
from mjcompose.tools.view.writing import Writer


class Guard(Struct):
    """Decides which requests the server answers. It is bound to `host` and `port`."""

    host: str
    port: int
    token: str
    writes: bool = False

    @property
    def address(self) -> str:
        shown = "127.0.0.1" if self._is_everywhere() else self.host
        return f"http://{_bracketed(shown)}:{self.port}/{self.token}/"

    def key_of(self, target: str, hosts: Sequence[str], origins: Sequence[str]) -> str | None:
        """Return the text after the token in the target of a request, or None for a request to refuse.

        `hosts` and `origins` are the values of all headers of these names. A page of another site cannot set `Host`,
        and a browser sends its `Origin`, so both must name this server. A guard that fails refuses.
        """
        try:
            return self._key(target, hosts, origins)
        except Exception:
            return None

    def _key(self, target: str, hosts: Sequence[str], origins: Sequence[str]) -> str | None:
        if len(hosts) != 1 or len(origins) > 1:
            return None
        host = hosts[0].lower()
        is_loopback = self.host in ("localhost", "::1") or self.host.startswith("127.")
        names = {self.host, *(("localhost", "127.0.0.1", "::1") if is_loopback else ())}
        hosts_here = {f"{_bracketed(name)}:{self.port}".lower() for name in names}
        if not self._is_everywhere() and host not in hosts_here:
            return None
        if origins and origins[0].lower() != f"http://{host}":
            return None
        own = f"/{self.token}/"
        head = target[: len(own)]
        key = target[len(own) :]
        return key if hmac.compare_digest(head.encode("utf-8", "surrogatepass"), own.encode()) else None

    def may_write(self, origins: Sequence[str], sites: Sequence[str]) -> bool:
        """Return whether an answered request may change a recipe: it must come from a page of this server.

        `origins` has passed `key_of`; `sites` are the values of `Sec-Fetch-Site`, which a browser sends. Only a server
        that nobody else can reach may write.
        """
        return self.writes and self.is_private and len(origins) == 1 and list(sites) in ([], ["same-origin"])

    @property
    def is_private(self) -> bool:
        """Whether only this machine can connect."""
        return self.host == "localhost" or bool(self._ip and self._ip.is_loopback)

    def _is_everywhere(self) -> bool:
        return not self.host or bool(self._ip and self._ip.is_unspecified)

    @property
    def _ip(self) -> IPv4Address | IPv6Address | None:
        with contextlib.suppress(ValueError):  # a name
            return ip_address(self.host)
        return None


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


_MOST_WAITING = 64
_MOST_PAGES = 32
_BEAT_SECONDS = 15.0
_NOTHING = b": \n\n"


class Page:
    """One open page, from `Hub.join` to `Hub.leave`."""

    def __init__(self) -> None:
        self._waiting: queue.Queue[bytes | None] = queue.Queue(_MOST_WAITING)

    def put(self, message: bytes | None) -> None:
        """Add a message. If the page sleeps, its oldest messages are lost; it asks again when it wakes up."""
        while True:
            try:
                self._waiting.put_nowait(message)
                return
            except queue.Full:
                self._waiting.get_nowait()

    def messages(self) -> Iterator[bytes]:
        """Yield the messages for the page, and now and then a comment, which reveals closed pages."""
        while True:
            try:
                message = self._waiting.get(timeout=_BEAT_SECONDS)
            except queue.Empty:
                message = _NOTHING
            if message is None:
                return
            yield message


class Hub:
    """Server-Sent Events: `send` sends one to every page."""

    def __init__(self) -> None:
        self._pages: list[Page] = []
        self._lock = Lock()

    def join(self) -> Page | None:
        """Return a new page, or None if there are too many."""
        page = Page()
        with self._lock:
            if len(self._pages) >= _MOST_PAGES:
                return None
            self._pages.append(page)
        return page

    def leave(self, page: Page) -> None:
        with self._lock:
            self._pages.remove(page)

    def send(self, event: str, data: Any) -> None:
        self.put(encoded(event, data))

    def put(self, message: bytes | None) -> None:
        """Send a message to every page; None ends them."""
        with self._lock:
            for page in self._pages:
                page.put(message)


def encoded(event: str, data: Any) -> bytes:
    return f"event: {event}\ndata: {json.dumps(data)}\n\n".encode()


_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:;"
    " connect-src 'self'; form-action 'none'; base-uri 'none'; frame-ancestors 'none'"
)
_MOST_SAID = 1 << 20
_MOST_HEAD = 1 << 17
_WORTH_PACKING = 1024
_MOST_CONNECTIONS = 64
_SECONDS_TO_ASK = 10.0  # for a whole request, and for a connection without one
_SECONDS_TO_READ = 30.0  # for each piece of an answer
_PIECE = 1 << 20
_MOMENT = 0.5
_MODEL = re.compile("model/(0|[1-9][0-9]{0,8})")
_FILES = {"page.js": "text/javascript; charset=utf-8", "page.css": "text/css; charset=utf-8"}


class PageServer:
    """Serves one workshop. `address` contains the token; requests without it get no answer."""

    def __init__(self, workshop: Workshop, host: str, port: int, writes: bool = False) -> None:
        self.workshop = workshop
        self.hub = Hub()
        self.writer = Writer(workshop)
        self.files = {name: (BUILT / name).read_bytes() for name in _FILES}
        self._http = _Http((host, port), self)
        self.guard = Guard(host, self._http.server_address[1], secrets.token_urlsafe(16), writes=writes)
        workshop.writes = writes and self.guard.is_private
        self.address = self.guard.address
        self.physics = Simulation(workshop, lambda state: self.hub.send("state", state))

    def show(self, shown: Shown) -> None:
        self.writer.know(shown)
        for event, data in self.news(shown):
            self.hub.send(event, data)

    def news(self, shown: Shown) -> Iterator[tuple[str, Any]]:
        """Yield the events that tell a page about the model and its faults."""
        if shown.version >= 0:
            yield "model", {"version": shown.version, "fault": shown.fault is not None}
        if shown.fault is not None:
            yield "fault", {"text": shown.fault, "rows": [self._row(each) for each in shown.faults]}

    def _row(self, fault: PageFault) -> dict[str, Any]:
        row: dict[str, Any] = {"text": fault.text, "place": fault.place, "fix": None}
        if fault.path is not None:
            path = fault.path.as_posix()
            href = self.workshop.editor.replace("{file}", quote(path))
            href = href.replace("{line}", str(fault.line)).replace("{column}", str(fault.column))
            row |= {"path": path, "line": fault.line, "column": fault.column, "href": href}
            row["fix"] = fault.words if self.workshop.writes and fault.fixed is not None else None
        return row

    def choose(self, name: str, value: str | float) -> None:
        self.workshop.choose(name, value)
        self.show(self.workshop.shown)

    def run(self) -> None:
        """Serve until `close`. Runs in a thread of its own."""
        self._http.serve_forever(poll_interval=0.1)

    def close(self) -> None:
        self.physics.close()
        self.hub.put(None)
        self._http.shutdown()
        self._http.server_close()


class _Http(ThreadingHTTPServer):
    """One thread for each connection, at most `_MOST_CONNECTIONS`.

    A new connection ends the connection that has waited longest for a whole request, so clients that send nothing
    cannot block a page.
    """

    daemon_threads = True
    request_queue_size = 128
    # A port that another process listens on counts as taken, on every system.
    allow_reuse_port = False

    def __init__(self, address: tuple[str, int], owner: PageServer) -> None:
        self.owner = owner
        self._free = BoundedSemaphore(_MOST_CONNECTIONS)
        self._waiting: dict[socket.socket, None] = {}
        self._lock = Lock()
        super().__init__(address, _Handler)

    def process_request(self, request: Any, client_address: Any) -> None:
        if not self._free.acquire(blocking=False):
            self._hang_up()
            if not self._free.acquire(timeout=_MOMENT):
                self.shutdown_request(request)
                return
        try:
            self.waits(request)
            super().process_request(request, client_address)
        except BaseException:
            self._ended(request)
            raise

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._ended(request)

    def waits(self, request: socket.socket, waiting: bool = True) -> None:
        """Note that a connection has no whole request yet, or that it has one."""
        with self._lock:
            self._waiting.pop(request, None)
            if waiting:
                self._waiting[request] = None

    def _hang_up(self) -> None:
        with self._lock:
            request = next(iter(self._waiting), None)
            if request is not None:
                del self._waiting[request]
                with contextlib.suppress(OSError):
                    request.shutdown(socket.SHUT_RDWR)

    def _ended(self, request: socket.socket) -> None:
        self.waits(request, False)
        self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore errors of closed pages."""


class _Asked(io.RawIOBase):
    """The bytes of a client. A whole request has a time limit, even if its bytes come slowly, and a size."""

    def __init__(self, connection: socket.socket) -> None:
        self._connection = connection
        self.begin()

    def begin(self) -> None:
        self._end = time.monotonic() + _SECONDS_TO_ASK
        self.left = _MOST_HEAD

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        seconds = self._end - time.monotonic()
        if seconds <= 0 or self.left <= 0:
            raise TimeoutError
        self._connection.settimeout(seconds)
        count = self._connection.recv_into(buffer)
        self.left -= count
        return count


class _Handler(BaseHTTPRequestHandler):
    """Answers the requests in the table of its server; no part of a request is ever the name of a file."""

    server: _Http
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # a head and its content are sent one after the other
    server_version = "mjcompose"
    sys_version = ""

    def setup(self) -> None:
        super().setup()
        self._asked = _Asked(self.connection)
        self.rfile = io.BufferedReader(self._asked)

    def handle_one_request(self) -> None:
        self._asked.begin()
        self.server.waits(self.connection)
        super().handle_one_request()

    def do_GET(self) -> None:
        key = self._key()
        if key is None:
            return
        shown = self.server.owner.workshop.shown
        if key == "":
            title = (shown.title or "mjcompose").encode("utf-8", "replace").decode()
            self._send(live(title).encode(), "text/html; charset=utf-8")
        elif key in _FILES:
            self._send(self.server.owner.files[key], _FILES[key])
        elif key == "events":
            self._events()
        elif (number := _MODEL.fullmatch(key)) and int(number[1]) <= shown.version:
            self._send(shown.text.encode(), "application/json")  # a page that is late gets the newest one
        elif (name := key.removeprefix("blob/")) != key and name in shown.blobs:
            self._send(shown.blobs[name], "application/octet-stream", kept=True)
        else:
            self._refuse(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        key = self._key()
        if key is None:
            return
        try:
            said = self._said()
            if key == "change":
                self._change(said)
                return
            wish = self._wish(key, said)
        except OSError:
            raise
        except Exception:  # a request that cannot be read
            self._refuse(HTTPStatus.BAD_REQUEST)
            return
        if wish is None:
            self._refuse(HTTPStatus.NOT_FOUND)
            return
        wish()
        self._send(b"", "text/plain", HTTPStatus.NO_CONTENT)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Refuse unknown methods, lines and headers."""
        self._refuse(HTTPStatus.FORBIDDEN)

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing: the terminal is for the model."""

    def _key(self) -> str | None:
        """Return the resource as the client sent it, which `self.path` does not have."""
        words = self.requestline.split(" ")  # Python splits at other spaces too
        target = words[1] if len(words) == 3 else ""
        hosts, origins = (self.headers.get_all(name, []) for name in ("host", "origin"))
        key = self.server.owner.guard.key_of(target, hosts, origins)
        if key is None:
            self._refuse(HTTPStatus.FORBIDDEN)
        else:
            self.server.waits(self.connection, False)
        return key

    def _said(self) -> Any:
        """Return the JSON of a request. Raises an exception for other content."""
        (kind,), (length,) = (self.headers.get_all(name, []) for name in ("content-type", "content-length"))
        if kind != "application/json" or not (length.isascii() and length.isdecimal()):
            raise ValueError
        if "transfer-encoding" in self.headers or (size := int(length)) > _MOST_SAID:
            raise ValueError
        self._asked.left += size
        return json.loads(self.rfile.read(size))

    def _change(self, said: Any) -> None:
        """Let a page change a recipe, and send the result."""
        origins, sites = (self.headers.get_all(name, []) for name in ("origin", "sec-fetch-site"))
        if not self.server.owner.guard.may_write(origins, sites):
            self._refuse(HTTPStatus.FORBIDDEN)
            return
        self._send(json.dumps(self.server.owner.writer.answer(said)).encode(), "application/json")

    def _wish(self, key: str, said: Any) -> Callable[[], object] | None:
        physics = self.server.owner.physics
        if key == "play":
            return partial(physics.play, bool(said["playing"]), _start(said))
        if key == "step":
            return partial(physics.step, _start(said))
        if key == "reset":
            return partial(physics.reset, int(said["key"]))
        if key == "back":
            return partial(physics.back, float(said["time"]))
        if key == "speed":
            return partial(physics.change_speed, float(said["speed"]))
        if key == "pose":
            return partial(physics.update, {"ctrl": _numbers(said["ctrl"])})
        if key == "choose":
            value = said["value"]
            is_number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
            return partial(self.server.owner.choose, _text(said["name"]), value if is_number else _text(value))
        if key == "look":
            asked = {name: _numbers(said[name]) for name in ("qpos", "ctrl")} | {"looked": _text(said["looked"])}
            return partial(physics.look, int(said["version"]), asked)
        if key == "pull":
            points = {name: _numbers(said[name]) for name in ("at", "to") if name in said}
            return partial(physics.update, {"pull": {"body": int(said.get("body", 0))} | points})
        return (lambda: None) if key == "shown" else None

    def _events(self) -> None:
        page = self.server.owner.hub.join()  # before the page reads the current model, so it misses no change
        if page is None:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE)
            return
        self.close_connection = True
        try:
            with contextlib.suppress(OSError):
                self.send_response(HTTPStatus.OK)
                self._headers("text/event-stream")
                self.send_header("Connection", "close")
                self.end_headers()
                owner = self.server.owner
                state = owner.physics.now()
                events = chain(owner.news(owner.workshop.shown), [] if state is None else [("state", state)])
                known = (encoded(event, data) for event, data in events)
                for message in chain(known, page.messages()):
                    self._write(message)
        finally:
            self.server.owner.hub.leave(page)

    def _refuse(self, status: HTTPStatus) -> None:
        """Answer with a status and end the connection; discard more bytes, or the system would drop the answer."""
        self.close_connection = True
        self._send(f"{status.phrase}\n".encode(), "text/plain", status)
        end = time.monotonic() + _MOMENT
        with contextlib.suppress(OSError):
            self.connection.shutdown(socket.SHUT_WR)
            while (seconds := end - time.monotonic()) > 0:
                self.connection.settimeout(seconds)
                if not self.connection.recv(1 << 16):
                    break

    def _send(self, content: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK, kept: bool = False) -> None:
        packed = len(content) > _WORTH_PACKING and "gzip" in self.headers.get("accept-encoding", "") and not kept
        if packed:
            content = gzip.compress(content, 1)
        self.send_response(status)
        self._headers(kind, kept)
        if packed:
            self.send_header("Content-Encoding", "gzip")
        if status != HTTPStatus.NO_CONTENT:
            self.send_header("Content-Length", str(len(content)))
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        if status != HTTPStatus.NO_CONTENT:
            self._write(content)

    def _write(self, content: bytes) -> None:
        """Send bytes. Raises TimeoutError as soon as a piece of them takes too long."""
        for at in range(0, len(content), _PIECE):
            self.connection.settimeout(_SECONDS_TO_READ)
            self.connection.sendall(content[at : at + _PIECE])

    def _headers(self, kind: str, kept: bool = False) -> None:
        self.connection.settimeout(_SECONDS_TO_READ)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "private, max-age=31536000, immutable" if kept else "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")


_START = ("qpos", "ctrl", "mocap_pos", "mocap_quat")


def _start(said: Any) -> dict[str, Any]:
    """Return the state of a page from which the physics start."""
    return {name: _numbers(said[name]) for name in _START if name in said} | {"key": int(said["key"])}


def _numbers(values: Any) -> list[float]:
    return [float(each) for each in values]


def _text(value: Any) -> str:
    text = str(value)
    text.encode()
    return text

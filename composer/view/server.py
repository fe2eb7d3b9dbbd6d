"""The server of a page: bound to this machine, and serving only the page and the model."""

from __future__ import annotations

import gzip
import json
import secrets
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from composer.view.guard import Guard
from composer.view.hub import Hub, encoded
from composer.view.page import BUILT, live
from composer.view.physics import Physics
from composer.view.workshop import Shown, Workshop

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:;"
    " connect-src 'self'; form-action 'none'; base-uri 'none'; frame-ancestors 'none'"
)
_MOST_SAID = 1 << 20
_WORTH_PACKING = 1024


class Server:
    """Serves one workshop. `address` contains the token, without which nothing is answered."""

    def __init__(self, workshop: Workshop, host: str, port: int) -> None:
        self.workshop, self.hub = workshop, Hub()
        self.physics = Physics(workshop, lambda state: self.hub.send("state", state))
        server = self

        class Handler(_Handler):
            owner = server

        self._http = _Http((host, port), Handler)
        self.guard = Guard(host, self._http.server_address[1], secrets.token_urlsafe(16))

    @property
    def address(self) -> str:
        return self.guard.address

    def show(self, shown: Shown) -> None:
        """Notify every page of the current model."""
        for event, data in news(shown):
            self.hub.send(event, data)

    def run(self) -> None:
        """Serve until `close`. Runs in a thread of its own."""
        self._http.serve_forever(poll_interval=0.1)

    def close(self) -> None:
        self.physics.close()
        self.hub.close()
        self._http.shutdown()
        self._http.server_close()


def news(shown: Shown) -> list[tuple[str, Any]]:
    """Return the events for the current model and fault."""
    found: list[tuple[str, Any]] = []
    if shown.version >= 0:
        found.append(("model", {"version": shown.version, "fault": shown.fault is not None}))
    if shown.fault is not None:
        found.append(("fault", {"text": shown.fault}))
    return found


class _Http(ThreadingHTTPServer):
    daemon_threads = True
    # A port that another process listens on counts as taken, on every system.
    allow_reuse_port = False

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore errors of pages that are gone."""


class _Handler(BaseHTTPRequestHandler):
    owner: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "mjcompose", ""

    def do_GET(self) -> None:
        path = self._path()
        if path is None:
            return
        what, _, name = path.partition("/")
        answers: dict[str, Callable[[str], None]] = {
            "": self._page, "page.js": self._file, "page.css": self._file, "events": self._events,
            "model": self._model, "blob": self._blob,
        }  # fmt: skip
        answers.get(what, self._nothing)(name or what)

    def do_POST(self) -> None:
        path = self._path()
        if path is None:
            return
        length = int(self.headers.get("content-length") or 0)
        if not 0 <= length <= _MOST_SAID or self.headers.get("content-type") != "application/json":
            self._refuse(HTTPStatus.BAD_REQUEST)
            return
        try:
            said = json.loads(self.rfile.read(length))
            done = self._act(path, said)
        except (ValueError, TypeError, KeyError):
            done = False
        self._send(b"", "text/plain", HTTPStatus.NO_CONTENT if done else HTTPStatus.BAD_REQUEST)

    def log_message(self, format: str, *args: Any) -> None:
        """Log nothing: the terminal is for the model."""

    # -- answers ------------------------------------------------------------------------------------------------

    def _path(self) -> str | None:
        headers = {name.lower(): value for name, value in self.headers.items()}
        path = self.owner.guard.path_of(self.path, headers)
        if path is None:
            self._refuse(HTTPStatus.FORBIDDEN)
        return path

    def _page(self, name: str) -> None:
        self._send(live(self.owner.workshop.shown.title or "mjcompose").encode(), "text/html; charset=utf-8")

    def _file(self, name: str) -> None:
        kind = "text/javascript" if name.endswith(".js") else "text/css"
        self._send((BUILT / name).read_bytes(), f"{kind}; charset=utf-8")

    def _model(self, name: str) -> None:
        self._send(self.owner.workshop.shown.text.encode(), "application/json")

    def _blob(self, name: str) -> None:
        content = self.owner.workshop.shown.blobs.get(name)
        if content is None:
            self._nothing(name)
        else:
            self._send(content, "application/octet-stream", kept=True)

    def _events(self, name: str) -> None:
        self.send_response(HTTPStatus.OK)
        self._headers("text/event-stream")
        self.send_header("Connection", "close")
        self.end_headers()
        self.close_connection = True
        page = self.owner.hub.join()  # before the page reads the current model, so that it misses no change
        try:
            for event, data in news(self.owner.workshop.shown):
                self.wfile.write(encoded(event, data))
            for message in page.messages():
                self.wfile.write(message)
                self.wfile.flush()
        except OSError:
            self.close_connection = True
        finally:
            self.owner.hub.leave(page)

    def _act(self, path: str, said: Any) -> bool:
        owner = self.owner
        if path == "play":
            owner.physics.play(bool(said["playing"]), {name: said[name] for name in ("qpos", "ctrl", "key")})
        elif path == "pose":
            owner.physics.control([float(each) for each in said["ctrl"]])
        elif path == "choose":
            owner.workshop.choose(str(said["name"]), str(said["value"]))
            owner.show(owner.workshop.shown)
        elif path != "shown":
            return False
        return True

    def _nothing(self, name: str) -> None:
        self._refuse(HTTPStatus.NOT_FOUND)

    def _refuse(self, status: HTTPStatus) -> None:
        self.close_connection = True
        self._send(f"{status.phrase}\n".encode(), "text/plain", status)

    def _send(
        self, content: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK, kept: bool = False
    ) -> None:
        packed = (
            len(content) > _WORTH_PACKING and "gzip" in self.headers.get("accept-encoding", "") and not kept
        )
        if packed:
            content = gzip.compress(content, 1)
        self.send_response(status)
        self._headers(kind, kept)
        if packed:
            self.send_header("Content-Encoding", "gzip")
        if status != HTTPStatus.NO_CONTENT:
            self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if status != HTTPStatus.NO_CONTENT:
            self.wfile.write(content)

    def _headers(self, kind: str, kept: bool = False) -> None:
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "private, max-age=31536000, immutable" if kept else "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Cross-Origin-Resource-Policy", "same-origin")

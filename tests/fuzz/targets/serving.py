"""What strangers send: requests to the server of `view`, as bytes, and the messages of an editor."""

from __future__ import annotations

import atexit
import io
import json
import re
import socket
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from random import Random
from typing import Any, cast

from fuzz.mutation import ODD_TEXT, flipped, json_changed
from fuzz.target import Seed, Target, Tools
from lsp.client import Editor
from mjcompose.tools.view.builder import Shown, Workshop
from mjcompose.tools.view.server import PageServer

_SECRET = b"only its owner may read this"
_ESCAPES = (
    "..",
    "../",
    "/",
    "//",
    "%2e",
    "%2e%2e%2f",
    "%2f",
    "%252f",
    "%00",
    "\0",
    "\\",
    "..\\",
    "/etc/hostname",
    "file:///etc/passwd",
    "?",
    "#",
    ";",
    ":",
    "@",
    "\r\n",
    "\t",
    " ",
    "\xa0",
    "\x85",
    "%c0%af",
    "....//",
    "~",
    "*",
    "a" * 5000,
    "../" * 400,
    "{token}",
    "{host}",
    "{secret}",
    "http://{host}",
    "page.js",
    "page.css",
    "model/0",
    "blob/b",
    "events/",
    "play",
)
_LINES = (
    "Host: {host}",
    "Host: evil.example",
    "Origin: http://{host}",
    "Origin: http://evil.example",
    "Origin: null",
    "Content-Length: 2",
    "Content-Length: -1",
    "Content-Length: 99",
    "Transfer-Encoding: chunked",
    "Content-Type: application/json",
    "Expect: 100-continue",
    "Connection: keep-alive",
    "Connection: upgrade",
    " folded",
    "X: " + "y" * 3000,
    ":",
    "Accept-Encoding: gzip",
)
_METHODS = ("GET", "POST", "HEAD", "PUT", "OPTIONS", "TRACE", "get", "", "GET GET")


_POSE = {"pos": [0.1, 0, 0], "quat": [1, 0, 0, 0]}
_CHANGES: list[dict[str, Any]] = [
    {"kind": "place", "version": 0, "at": ["/etc/passwd", 1, 1], **_POSE}, {"kind": "look", "version": 0, "at": ["a.yaml", 1, 1]},
    {"kind": "edit", "version": 0, "of": "site", "index": 0, **_POSE}, {"kind": "undo", "texts": {"/etc/passwd": "a"}},
    {"kind": "attach", "version": 0, "prefix": "a", "model": "/etc/passwd", "site": 0}, {"kind": "models", "version": 0},
]  # fmt: skip


def _requests(corpus: Path | None) -> Iterator[Seed]:
    for key in ("", "page.js", "page.css", "model/0", "blob/b", "none"):
        yield Seed(f"GET /{{token}}/{key} HTTP/1.1\r\nHost: {{host}}\r\n\r\n".encode())
    play = {"playing": False, "qpos": [0.0], "ctrl": [], "key": -1}
    for key, said in (
        ("play", play),
        ("pose", {"ctrl": [1]}),
        ("shown", {}),
        ("choose", {"name": "a", "value": "b"}),
        *(("change", each) for each in _CHANGES),
    ):
        body = json.dumps(said)
        head = f"POST /{{token}}/{key} HTTP/1.1\r\nHost: {{host}}\r\nOrigin: http://{{host}}\r\nContent-Type: application/json"
        yield Seed(f"{head}\r\nContent-Length: {len(body)}\r\n\r\n{body}".encode())


def _request_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    kind = random.randrange(6)
    if kind == 0:
        return flipped(data, random)
    if kind == 1:
        return data + random.choice(pool)  # one after the other, on one connection
    lines = data.split(b"\r\n")
    if kind == 2:
        at = random.randrange(1, len(lines) + 1)
        lines[at : at + random.randrange(2)] = [random.choice(_LINES).encode("latin-1")]
    elif kind == 3:
        lines[0] = b" ".join([random.choice(_METHODS).encode(), *lines[0].split(b" ")[1:]])
    else:
        words = lines[0].split(b" ")
        target = words[1] if len(words) > 1 else b"/"
        at = random.choice([0, 1, len(target), target.find(b"}/") + 2, random.randrange(len(target) + 1)])
        more = random.choice(_ESCAPES).encode("latin-1")
        words[1:2] = [target[:at] + more + target[at + random.randrange(3) :]]
        lines[0] = b" ".join(words)
    return b"\r\n".join(lines)


class _Shop:
    """A model that is there."""

    shown = Shown(0, '{"a": 1}', {"b": b"blob"}, "title")
    chosen = 0

    def choose(self, name: str, value: str) -> None:
        name.encode(), value.encode()
        self.chosen += 1


@cache
def _served() -> tuple[PageServer, Path, list[str]]:
    """A server, a file beside it, and what its threads have opened."""
    server = PageServer(cast(Workshop, _Shop()), "127.0.0.1", 0, writes=True)
    threading.Thread(target=server.run, daemon=True).start()
    folder = tempfile.TemporaryDirectory(prefix="mjcompose-fuzz-")
    atexit.register(folder.cleanup)
    (Path(folder.name) / "secret.txt").write_bytes(_SECRET)
    opened: list[str] = []

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if (
            event == "open"
            and "process_request" in threading.current_thread().name
            and not str(arguments[0]).endswith((".py", ".pyc", "built/NOTICE"))
        ):
            opened.append(str(arguments[0]))

    sys.addaudithook(hook)
    return server, Path(folder.name) / "secret.txt", opened


def check_request(path: Path, tools: Tools) -> str | None:
    server, secret, opened = _served()
    token = server.guard.token
    host = f"127.0.0.1:{server.guard.port}"
    sent = path.read_bytes()
    for name, value in (("token", token), ("host", host), ("secret", str(secret))):
        sent = sent.replace(f"{{{name}}}".encode(), value.encode())
    began = time.monotonic()
    with socket.create_connection(("127.0.0.1", server.guard.port), 5) as connection:
        connection.settimeout(15)
        found = b""
        try:
            connection.sendall(sent)
            connection.shutdown(socket.SHUT_WR)
            while piece := connection.recv(1 << 16):
                found += piece
        except ConnectionError:
            pass
        except TimeoutError:
            return f"waits: for {time.monotonic() - began:.0f} s"
    if _SECRET in found or b"root:" in found:
        return "file: a file was given out"
    if opened:
        return f"opened: {opened.pop()}"
    words = sent.split(b"\r\n")[0].split(b" ")
    status = int(found[9:12]) if re.match(rb"HTTP/1\.1 \d{3} ", found) else 0
    keys = {
        b"",
        b"page.js",
        b"page.css",
        b"model/0",
        b"blob/b",
        b"events",
        b"play",
        b"pose",
        b"shown",
        b"choose",
        b"change",
    }
    allowed = len(words) > 1 and words[1] in {f"/{token}/".encode() + key for key in keys}
    if status not in (0, 100, 200, 204, 400, 403, 404):
        return f"status-{status}"
    if status in (200, 204) and not allowed:
        return f"answered-{status}"
    if threading.active_count() > 80:
        return "threads: more than there may be"
    return None


_PLACE = {"textDocument": {"uri": "file:///tmp/a.yaml"}, "position": {"line": 1, "character": 3}}
_RANGE = {"start": {"line": 0, "character": 0}, "end": {"line": 5, "character": 0}}
_SKIPPED = {"exit", "shutdown", "initialize", "initialized", "workspace/executeCommand"}
"""What ends the server or begins it, and what starts other commands."""


def _messages(corpus: Path | None) -> Iterator[Seed]:
    document = {
        **_PLACE["textDocument"],
        "languageId": "yaml",
        "version": 1,
        "text": "recipe: 1\nbase: ./m.xml\nedit: []\n",
    }
    file = {"textDocument": _PLACE["textDocument"]}
    found: list[tuple[str, Any]] = [
        ("textDocument/didOpen", {"textDocument": document}),
        (
            "textDocument/didChange",
            {"textDocument": {**file["textDocument"], "version": 2}, "contentChanges": [{"text": "recipe: 1\n"}]},
        ),
        ("textDocument/didSave", file),
        ("textDocument/didClose", file),
        ("workspace/didChangeWatchedFiles", {"changes": [{"uri": "file:///tmp/m.xml", "type": 2}]}),
        ("$/cancelRequest", {"id": 3}),
        ("$/setTrace", {"value": "off"}),
        ("none", {}),
        *((f"textDocument/{name}", _PLACE) for name in ("completion", "hover", "definition", "prepareRename")),
        ("textDocument/references", {**_PLACE, "context": {"includeDeclaration": True}}),
        ("textDocument/rename", {**_PLACE, "newName": "b"}),
        ("textDocument/codeAction", {**file, "range": _RANGE, "context": {"diagnostics": []}}),
        ("textDocument/inlayHint", {**file, "range": _RANGE}),
        ("textDocument/formatting", {**file, "options": {"tabSize": 2, "insertSpaces": True}}),
        *((f"textDocument/{name}", file) for name in ("documentSymbol", "foldingRange", "codeLens")),
    ]
    for number, (method, params) in enumerate(found):
        is_told = "did" in method or method.startswith("$")
        message = {"jsonrpc": "2.0", "method": method, "params": params} | ({} if is_told else {"id": number})
        yield Seed(_framed(json.dumps(message).encode()))


def _framed(body: bytes, head: str = "Content-Length: {}") -> bytes:
    return head.format(len(body)).encode() + b"\r\n\r\n" + body


def _frame_changed(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    kind = random.randrange(5)
    if kind == 0:
        return flipped(data, random)
    if kind == 1:
        return data + random.choice(pool)
    head, _, body = data.partition(b"\r\n\r\n")
    if kind == 2:
        wrong = random.choice(
            ("-5", "0", "1", "x", "99999999999", "", "+3", "{} ", "\u0664", "{}\r\nContent-Length: {}", *ODD_TEXT[:6])
        )
        return f"Content-Length: {wrong}".replace("{}", str(len(body))).encode("utf-8", "replace") + b"\r\n\r\n" + body
    return _framed(json_changed(body, random, pool) if body else head)


@cache
def _editor() -> Editor:
    folder = tempfile.TemporaryDirectory(prefix="mjcompose-fuzz-")
    atexit.register(folder.cleanup)
    Path(folder.name, "m.xml").write_text(
        '<mujoco><worldbody><body name="b"><geom size="1"/></body></worldbody></mujoco>'
    )
    editor = Editor(Path(folder.name))
    atexit.register(editor.close)
    return editor


def _give_up(editor: Editor) -> None:
    """End a server that does not answer: it would go on beside the next one."""
    editor.process.kill()
    _editor.cache_clear()


def check_frames(path: Path, tools: Tools) -> str | None:
    """Everything that is no message is answered here, and every request that is one by the server."""
    from mjcompose.lsp.protocol import Frames
    from mjcompose.lsp.server import _structured

    answers: list[tuple[Any, int, str]] = []
    frames = Frames(io.BytesIO(path.read_bytes()), _structured, lambda *answer: answers.append(answer))
    editor = _editor()
    while frames.readline():
        frames.readline()
        message = json.loads(frames.read(0))
        if message.get("method") in _SKIPPED or "method" not in message:
            continue
        try:
            if "id" in message:
                editor.ask(message["method"], message.get("params"), 15)
            else:
                editor.tell(message["method"], message.get("params"))
        except TimeoutError:
            _give_up(editor)
            return f"unanswered-{message['method']}"
        except AssertionError as error:
            if editor.process.poll() is not None:
                _give_up(editor)
                return f"ended: {error}"
    try:
        editor.ask("textDocument/foldingRange", {"textDocument": {"uri": "file:///tmp/none.yaml"}}, 15)
    except (TimeoutError, AssertionError, OSError) as error:
        _give_up(editor)
        return f"gone: {error}"
    return None if all(code < 0 and words for _, code, words in answers) else "an answer without words"


REQUEST = Target("request", ".http", _requests, _request_changed, check_request)
FRAMES = Target("frames", ".lsp", _messages, _frame_changed, check_frames)

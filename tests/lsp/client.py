"""A scripted editor: it starts `mjcompose lsp` and talks JSON-RPC to it over stdio, as any editor does."""

from __future__ import annotations

import json
import queue
import subprocess
import sys
import tempfile
import threading
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

MARK = "▮"
"""Stands in a text of a test where the cursor is."""


class Editor:
    """An editor with a folder. Positions are those of the protocol: lines and UTF-16 units from 0."""

    def __init__(
        self, folder: Path, encodings: list[str] | None = None, environment: dict[str, str] | None = None
    ) -> None:
        self.folder = folder
        self.stderr = tempfile.TemporaryFile()  # noqa: SIM115  a pipe that nobody reads would hold the server up
        self.process = subprocess.Popen(
            [sys.executable, "-m", "mjcompose", "lsp", "--stdio"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.stderr,
            cwd=folder,
            env=environment,
        )
        self.messages: queue.Queue[Any] = queue.Queue()
        self.published: dict[str, list[Any]] = {}
        self.log: list[str] = []
        self.requests: list[Any] = []
        self.versions: dict[str, int] = {}
        self._id = self._version = 0
        threading.Thread(target=self._read, daemon=True).start()
        capabilities = {
            "general": {"positionEncodings": encodings or ["utf-16"]},
            "textDocument": {
                "completion": {"completionItem": {"documentationFormat": ["markdown"]}},
                "hover": {"contentFormat": ["markdown"]},
                "documentSymbol": {"hierarchicalDocumentSymbolSupport": True},
                "codeAction": {"codeActionLiteralSupport": {"codeActionKind": {"valueSet": ["quickfix"]}}},
                "rename": {"prepareSupport": True},
            },
            "workspace": {"didChangeWatchedFiles": {"dynamicRegistration": True}},
        }
        self.capabilities = self.ask(
            "initialize", {"processId": None, "rootUri": folder.as_uri(), "capabilities": capabilities}
        )["capabilities"]
        self.tell("initialized", {})

    def __enter__(self) -> Editor:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        if self.process.poll() is None:
            try:
                self.ask("shutdown", None, timeout=10)
                self.tell("exit", None)
                self.process.wait(10)
            except (OSError, TimeoutError, subprocess.TimeoutExpired):
                self.process.kill()
        for pipe in (self.process.stdin, self.process.stdout, self.stderr):
            if pipe is not None:
                pipe.close()

    # -- messages ----------------------------------------------------------------------------------------------

    def _read(self) -> None:
        stream = self.process.stdout
        assert stream is not None
        try:
            while True:
                size = 0
                while (line := stream.readline()) not in (b"\r\n", b""):
                    if line.lower().startswith(b"content-length:"):
                        size = int(line.partition(b":")[2])
                if not size:
                    self.messages.put(None)
                    return
                self.messages.put(json.loads(stream.read(size)))
        except ValueError:
            self.messages.put(None)

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self.process.stdin.flush()

    def tell(self, method: str, params: Any) -> None:
        self._send({"method": method, "params": params})

    def ask(self, method: str, params: Any, timeout: float = 60) -> Any:
        """The answer to a request; what else comes meanwhile is noted."""
        self._id += 1
        number = self._id
        self._send({"id": number, "method": method, "params": params})
        while True:
            message = self._next(timeout)
            if message.get("id") == number and "method" not in message:
                if "error" in message:
                    raise AssertionError(message["error"])
                return message.get("result")

    def _next(self, timeout: float) -> Any:
        try:
            message = self.messages.get(timeout=timeout)
        except queue.Empty:
            raise TimeoutError("the server does not answer") from None
        if message is None:
            self.stderr.seek(0)
            raise AssertionError(f"the server has ended: {self.stderr.read().decode()}")
        method = message.get("method")
        if method == "textDocument/publishDiagnostics":
            uri = message["params"]["uri"]
            version = message["params"].get("version")
            if version is None or version >= self.versions.get(uri, 0):  # others are of an earlier text
                self.published[uri] = message["params"]["diagnostics"]
        elif method == "window/logMessage":
            self.log.append(message["params"]["message"])
        elif method is not None and "id" in message:
            self.requests.append(message)
            self._send({"id": message["id"], "result": None})
        return message

    # -- documents ---------------------------------------------------------------------------------------------

    def uri(self, name: str | Path) -> str:
        return (self.folder / name).as_uri()

    def open(self, name: str | Path, text: str | None = None) -> str:
        """Open a file, by default as the disk has it; gives its address."""
        path = self.folder / name
        text = path.read_bytes().decode() if text is None else text
        uri = path.as_uri()
        self._version += 1
        self.versions[uri] = self._version
        self.published.pop(uri, None)
        item = {"uri": uri, "languageId": "yaml", "version": self._version, "text": text}
        self.tell("textDocument/didOpen", {"textDocument": item})
        return uri

    def change(self, uri: str, text: str) -> None:
        self._version += 1
        self.versions[uri] = self._version
        self.published.pop(uri, None)
        document = {"uri": uri, "version": self._version}
        self.tell("textDocument/didChange", {"textDocument": document, "contentChanges": [{"text": text}]})

    def diagnostics(self, uri: str, timeout: float = 60) -> list[Any]:
        """What is published for the newest text of a file."""
        return self.wait(uri, lambda found: True, timeout)

    def wait(self, uri: str, holds: Any, timeout: float = 60) -> list[Any]:
        """What is published for a file, as soon as that fulfills a condition."""
        latest = time.monotonic() + timeout
        while uri not in self.published or not holds(self.published[uri]):
            left = latest - time.monotonic()
            if left <= 0:
                raise TimeoutError(f"last published: {self.published.get(uri)}")
            self._next(left)
        return self.published[uri]

    def at(self, marked: str, name: str = "recipe.yaml", *, previous: str | None = None) -> tuple[dict[str, Any], str]:
        """Open or change a recipe that has a mark; gives the place of the mark as parameters, and the text."""
        text = marked.replace(MARK, "")
        uri = self.uri(name)
        if uri in self.versions:
            self.change(uri, text)
        else:
            self.open(name, text if previous is None else previous)
            if previous is not None:
                self.diagnostics(uri)
                self.change(uri, text)
        return {"textDocument": {"uri": uri}, "position": position(marked)}, text

    def complete(self, marked: str, name: str = "recipe.yaml", **more: Any) -> list[Any]:
        params, _ = self.at(marked, name, **more)
        return self.ask("textDocument/completion", params)["items"]


def position(marked: str) -> dict[str, int]:
    """Where the mark stands, in lines and UTF-16 units."""
    before = marked[: marked.index(MARK)].replace("\r\n", "\n")
    line = before.rpartition("\n")[2]
    return {"line": before.count("\n"), "character": len(line.encode("utf-16-le")) // 2}


def labels(items: list[Any]) -> list[str]:
    return [each["label"] for each in items]


def stretch(place: dict[str, Any], text: str) -> str:
    """The text of a range, as an editor counts: in UTF-16."""
    lines = text.replace("\r\n", "\n").split("\n")
    begin = place["start"]
    end = place["end"]
    assert begin["line"] == end["line"]
    line = lines[begin["line"]].encode("utf-16-le")
    return line[2 * begin["character"] : 2 * end["character"]].decode("utf-16-le")


def applied(text: str, edits: list[dict[str, Any]]) -> str:
    """A text with all changes made, as an editor makes them; none may overlap."""
    lines = text.split("\n")
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line) + 1)

    def offset(place: dict[str, int]) -> int:
        line = lines[place["line"]].encode("utf-16-le")
        return starts[place["line"]] + len(line[: 2 * place["character"]].decode("utf-16-le"))

    spans = sorted((offset(each["range"]["start"]), offset(each["range"]["end"]), each["newText"]) for each in edits)
    assert all(one[1] <= other[0] for one, other in pairwise(spans)), "changes overlap"
    for start, end, new in reversed(spans):
        text = text[:start] + new + text[end:]
    return text

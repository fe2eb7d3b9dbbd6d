"""Reading recipes from text, and a YAML language server as editors run it."""

from __future__ import annotations

import json
import os
import queue
import shutil
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import dedent
from typing import Any

import pytest
from language.validating import validate
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.report import render
from mjcompose.base.sink import Sink
from mjcompose.language.recipe import Recipe
from mjcompose.text.load import load

ROOT = Path(__file__).parents[2]
SCHEMA = ROOT / "schemas" / "recipe.schema.json"
SERVER = "yaml-language-server"
VERSION = "1.25.0"
SECONDS = 60
SETTINGS = {
    "yaml": {
        "validate": True,
        "completion": True,
        "hover": True,
        "yamlVersion": "1.2",
        "schemaStore": {"enable": False},
        "schemas": {SCHEMA.as_uri(): ["*.yaml"]},
    }
}


@pytest.fixture
def recipe() -> Callable[[str], Recipe]:
    """The recipe of a text, which has no faults; `recipe: 1` is put in front."""

    def read(text: str) -> Recipe:
        sink = Sink()
        node = load("recipe: 1\n" + dedent(text), "recipe.yaml", sink)
        assert node is not None
        result = validate(node, sink)
        assert result is not None, "\n".join(map(render, sink.diagnostics))
        assert not sink.diagnostics
        return result

    return read


@pytest.fixture
def faults() -> Callable[[str], list[Diagnostic]]:
    """The errors of a text, in the order of their places; `recipe: 1` is put in front."""

    def read(text: str) -> list[Diagnostic]:
        sink = Sink()
        node = load("recipe: 1\n" + dedent(text), "recipe.yaml", sink)
        assert node is not None
        assert validate(node, sink) is None
        assert sink.diagnostics == sink.errors
        return sink.sorted()

    return read


class YamlServer:
    """The server's process, and what an editor asks of it."""

    def __init__(self, command: list[str]) -> None:
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._inbox: queue.Queue[dict[str, Any]] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        self._count = 0
        capabilities = {"workspace": {"configuration": True}}
        self._request("initialize", {"processId": os.getpid(), "rootUri": None, "capabilities": capabilities})
        self._send({"method": "initialized", "params": {}})
        self._send({"method": "workspace/didChangeConfiguration", "params": {"settings": SETTINGS}})

    def close(self) -> None:
        self._process.kill()
        self._process.wait()

    def diagnostics(self, path: Path, text: str) -> list[dict[str, Any]]:
        """Open a file with that text; what the server has to say about it."""
        self._open(path, text)
        while True:
            message = self._receive()
            if message.get("method") != "textDocument/publishDiagnostics":
                continue
            if message["params"]["uri"] == path.as_uri():
                found: list[dict[str, Any]] = message["params"]["diagnostics"]
                return found

    def completions(self, path: Path, text: str) -> list[dict[str, Any]]:
        """Open a file; what the server offers where the text has a `|`."""
        found = self._at_bar("completion", path, text, lambda result: bool(result["items"]))
        offered: list[dict[str, Any]] = found["items"]
        return offered

    def hover(self, path: Path, text: str) -> str:
        """Open a file; what the server shows where the text has a `|`."""
        found = self._at_bar("hover", path, text, lambda result: result is not None)
        return json.dumps(found, ensure_ascii=False)

    def _at_bar(self, what: str, path: Path, text: str, is_said: Callable[[Any], bool]) -> Any:
        before, after = text.split("|")
        self._open(path, before + after)
        place = {"line": before.count("\n"), "character": len(before) - before.rfind("\n") - 1}
        asked = {"textDocument": {"uri": path.as_uri()}, "position": place}
        latest = time.monotonic() + SECONDS
        while True:  # until the server has read the schema it says nothing
            result = self._request(f"textDocument/{what}", asked)
            if is_said(result) or time.monotonic() > latest:
                return result
            time.sleep(0.2)

    def _open(self, path: Path, text: str) -> None:
        document = {"uri": path.as_uri(), "languageId": "yaml", "version": 1, "text": text}
        self._send({"method": "textDocument/didOpen", "params": {"textDocument": document}})

    def _request(self, method: str, params: Any) -> Any:
        self._count += 1
        self._send({"id": self._count, "method": method, "params": params})
        while True:
            message = self._receive()
            if message.get("id") == self._count and "method" not in message:
                return message["result"]

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self._process.stdin.flush()

    def _receive(self) -> dict[str, Any]:
        """The next message; what the server itself asks is answered."""
        message = self._inbox.get(timeout=SECONDS)
        if "id" in message and "method" in message:
            result = None
            if message["method"] == "workspace/configuration":
                result = [SETTINGS.get(item["section"], {}) for item in message["params"]["items"]]
            self._send({"id": message["id"], "result": result})
        return message

    def _read(self) -> None:
        stream = self._process.stdout
        assert stream is not None
        while header := stream.readline():
            length = int(header.split(b":")[1]) if header.lower().startswith(b"content-length") else 0
            while header.strip():
                header = stream.readline()
                if header.lower().startswith(b"content-length"):
                    length = int(header.split(b":")[1])
            self._inbox.put(json.loads(stream.read(length)))


@pytest.fixture(scope="session")
def yaml_server() -> Iterator[YamlServer]:
    """A running server; skips where there is no Node.js or the package cannot be had."""
    node = shutil.which("node")
    if node is None or shutil.which("npm") is None:
        pytest.skip("there is no Node.js")
    server = YamlServer([node, str(_installed()), "--stdio"])
    yield server
    server.close()


def _installed() -> Path:
    """The server's program, kept in `build/` once it is installed; complete or not there at all."""
    home = ROOT / "build" / "node" / f"{SERVER}-{VERSION}"
    program = Path("node_modules", SERVER, "bin", SERVER)
    if not (home / program).exists():
        home.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=home.parent) as staging:
            options = ["--no-audit", "--no-fund", "--ignore-scripts", "--fetch-retries=1"]
            install = ["npm", "install", "--prefix", staging, *options]
            try:
                subprocess.run(
                    [*install, f"{SERVER}@{VERSION}"], capture_output=True, text=True, timeout=120, check=True
                )
            except subprocess.TimeoutExpired:
                pytest.skip(f"npm does not get {SERVER} in time")
            except subprocess.CalledProcessError as error:
                pytest.skip(f"npm cannot install {SERVER}: {error.stderr.strip()[-300:]}")
            try:
                os.rename(staging, home)
            except OSError:
                assert (home / program).exists()  # another process was faster
            else:
                os.mkdir(staging)
    return home / program

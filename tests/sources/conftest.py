"""Other machines on this one: git repositories in folders, and a web server on the loopback."""

from __future__ import annotations

import subprocess
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError

MODEL = '<mujoco model="{name}"><worldbody><body name="{name}"><geom size="0.1"/></body></worldbody></mujoco>\n'


@dataclass
class Repository:
    """A git repository with `arm/arm.xml`, `arm/mesh.obj` and `LICENSE`, tagged `v1`."""

    folder: Path

    def git(self, *arguments: str) -> str:
        own = ["-c", "user.name=Somebody", "-c", "user.email=somebody@example.org", "-c", "commit.gpgsign=false"]
        done = subprocess.run(["git", *own, *arguments], cwd=self.folder, check=True, capture_output=True, text=True)
        return done.stdout.strip()

    def commit(self, **files: str) -> str:
        for name, text in files.items():
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).write_text(text)
        self.git("add", "--all")
        self.git("commit", "-q", "-m", "a change")
        return self.git("rev-parse", "HEAD")

    def reference(self, revision: str, path: str = "arm/arm.xml") -> str:
        return f"git+file://{self.folder}@{revision}#{path}"


@pytest.fixture
def robots(tmp_path: Path) -> Repository:
    made = Repository(tmp_path / "robots")
    made.folder.mkdir()
    made.git("init", "-q", "-b", "main")
    made.commit(**{"arm/arm.xml": MODEL.format(name="arm"), "arm/mesh.obj": "v 0 0 0\n", "LICENSE": "As you like.\n"})
    made.git("tag", "v1")
    return made


@pytest.fixture
def own_environment(tmp_path: Path) -> dict[str, str]:
    """An environment with a store of its own."""
    return {"MJCOMPOSE_CACHE": str(tmp_path / "store"), "MJCOMPOSE_TIMEOUT": "2"}


@pytest.fixture
def take(own_environment: dict[str, str]) -> Callable[..., Any]:
    """Fetches what a reference names: `take(reference, offline=True)` and the other rules of `Fetching`."""

    def take(reference: str, **rules: Any) -> Any:
        return resolve(reference, relative_to=Path(), environment=own_environment, fetching=Fetching(**rules))

    return take


@pytest.fixture
def refused(take: Callable[..., Any]) -> Callable[..., SourceError]:
    """The error with which the same is refused."""

    def refused(reference: str, **rules: Any) -> SourceError:
        with pytest.raises(SourceError) as caught:
            take(reference, **rules)
        return caught.value

    return refused


Answer = Callable[[BaseHTTPRequestHandler], None]


@dataclass
class Web:
    """A web server: `pages` are files by their path, or functions that answer as they like."""

    url: str
    pages: dict[str, bytes | Answer] = field(default_factory=dict)
    asked: list[tuple[str, dict[str, str]]] = field(default_factory=list)

    def serve(self, repository: Repository, name: str) -> None:
        """Serve a repository as plain files, which git can fetch."""
        repository.git("update-server-info")
        root = repository.folder / ".git"
        self.pages |= {
            f"/{name}/{path.relative_to(root)}": path.read_bytes() for path in root.rglob("*") if path.is_file()
        }
        self.pages[f"/{name}/info/refs?service=git-upload-pack"] = self.pages[f"/{name}/info/refs"]


@pytest.fixture
def web() -> Iterator[Web]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            served.asked.append((self.path, dict(self.headers)))
            page = served.pages.get(self.path)
            if page is None:
                send(self, b"", status=404)
            elif isinstance(page, bytes):
                send(self, page, ETag=f'"{len(page)}"')
            else:
                page(self)

        do_POST = do_GET  # noqa: N815

        def log_message(self, format: str, *arguments: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    served = Web(f"http://127.0.0.1:{server.server_port}")
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield served
    server.shutdown()
    server.server_close()


def send(
    handler: BaseHTTPRequestHandler, body: bytes, *, status: int = 200, length: int | None = None, **headers: str
) -> None:
    handler.send_response(status)
    handler.send_header("Content-Length", str(len(body) if length is None else length))
    for name, value in headers.items():
        handler.send_header(name.replace("_", "-"), value)
    handler.end_headers()
    handler.wfile.write(body)


@pytest.fixture
def answer() -> Callable[..., None]:
    """Answers a request: `answer(handler, body, status=…, length=…, Header=…)`."""
    return send


@pytest.fixture(autouse=True)
def no_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.sources.download._PAUSE", 0.01)
    monkeypatch.setattr("mjcompose.sources.git_command._PAUSE", 0.01)

"""Files that Git LFS has of a repository: from this machine, and from a server on the loopback."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.git_repository import pointers_in, replace_pointers
from mjcompose.sources.reference import SourceError

CONTENT = b"v 0 0 0\n" * 400
SHA256 = hashlib.sha256(CONTENT).hexdigest()
POINTER = f"version https://git-lfs.github.com/spec/v1\noid sha256:{SHA256}\nsize {len(CONTENT)}\n"
BATCH = "/robots.git/info/lfs/objects/batch"


@pytest.fixture
def with_lfs(robots: Any) -> Any:
    robots.commit(**{"arm/mesh.obj": POINTER, "arm/again.obj": POINTER})
    return robots


def offer(web: Any, answer: Callable[..., None], content: bytes = CONTENT, **action: Any) -> list[Any]:
    """Serve the batch API and one object; return the requests of the API."""
    questions: list[Any] = []
    told = {"href": f"{web.url}/object?X-Amz-Signature=secret", "header": {"X-Key": "k", "Bad\n": "x"}, **action}

    def batch(request: BaseHTTPRequestHandler) -> None:
        questions.append(json.loads(request.rfile.read(int(request.headers["Content-Length"]))))
        listed = [{**each, "actions": {"download": told}} for each in questions[-1]["objects"]]
        answer(request, json.dumps({"objects": listed}).encode())

    web.pages |= {BATCH: batch, "/object?X-Amz-Signature=secret": content}
    return questions


def reference(web: Any) -> str:
    return f"git+{web.url}/robots.git@main#arm/arm.xml"


def test_from_a_server(with_lfs: Any, web: Any, answer: Any, take: Any) -> None:
    web.serve(with_lfs, "robots.git")
    questions = offer(web, answer)
    source = take(reference(web))
    assert source.path.with_name("mesh.obj").read_bytes() == source.path.with_name("again.obj").read_bytes() == CONTENT
    assert source.origin.stored["arm/mesh.obj"] == SHA256
    assert [each["objects"] for each in questions] == [[{"oid": SHA256, "size": len(CONTENT)}]]
    got = [headers for path, headers in web.asked if path.startswith("/object")]
    assert [headers["X-Key"] for headers in got] == ["k"] and not any("Bad" in name for name in got[0])
    web.pages.clear()
    assert take(reference(web), offline=True).path == source.path


def test_from_this_machine(with_lfs: Any, take: Any) -> None:
    stored = with_lfs.folder / ".git" / "lfs" / "objects" / SHA256[:2] / SHA256[2:4] / SHA256
    stored.parent.mkdir(parents=True)
    stored.write_bytes(CONTENT)
    assert take(with_lfs.reference("main")).path.with_name("mesh.obj").read_bytes() == CONTENT


@pytest.mark.parametrize("content", [b"v 1 0 0\n" * 400, CONTENT + b"more", b""])
def test_other_bytes_are_refused(with_lfs: Any, web: Any, answer: Any, refused: Any, content: bytes) -> None:
    web.serve(with_lfs, "robots.git")
    offer(web, answer, content)
    error = refused(reference(web))
    assert error.code == "source-changed" and SHA256 in error.notes[0]


@pytest.mark.parametrize("href", ["http://example.org/x", "file:///etc/passwd", "ftp://[::1/x", None])
def test_an_object_elsewhere_is_refused(with_lfs: Any, web: Any, answer: Any, refused: Any, href: Any) -> None:
    web.serve(with_lfs, "robots.git")
    offer(web, answer, href=href)
    assert "which is not an https address" in refused(reference(web)).message


def test_an_object_that_does_not_exist_shows_no_secret(with_lfs: Any, web: Any, answer: Any, refused: Any) -> None:
    web.serve(with_lfs, "robots.git")
    offer(web, answer)
    del web.pages["/object?X-Amz-Signature=secret"]
    error = refused(reference(web))
    assert error.code == "source-not-found" and "secret" not in error.message


def test_headers_stay_with_their_server(with_lfs: Any, web: Any, answer: Any, take: Any) -> None:
    web.serve(with_lfs, "robots.git")
    other = web.url.replace("127.0.0.1", "localhost")
    offer(web, answer, href=f"{web.url}/moved")
    web.pages["/moved"] = lambda request: answer(request, b"", status=302, Location=f"{other}/elsewhere")
    web.pages["/elsewhere"] = CONTENT
    take(reference(web))
    keys = {path: headers.get("X-Key") for path, headers in web.asked}
    assert (keys["/moved"], keys["/elsewhere"]) == ("k", None)


@pytest.mark.parametrize("body", [b"", b"[]", b"{", b'{"objects": [1, {"oid": 2, "actions": {"download": 3}}]}'])
def test_a_server_without_the_file_leaves_the_pointer(with_lfs: Any, web: Any, take: Any, body: bytes) -> None:
    web.serve(with_lfs, "robots.git")
    web.pages[BATCH] = body
    said: list[str] = []
    source = take(reference(web), progress=said.append)
    assert source.path.with_name("mesh.obj").read_text() == POINTER
    assert any("does not have the file" in each for each in said)


def test_a_server_that_fails_stores_nothing(with_lfs: Any, web: Any, answer: Any, refused: Any, take: Any) -> None:
    web.serve(with_lfs, "robots.git")
    web.pages[BATCH] = lambda request: answer(request, b"", status=503)
    assert refused(reference(web)).code == "source-fetch"
    offer(web, answer)
    assert take(reference(web)).path.with_name("mesh.obj").read_bytes() == CONTENT


def test_what_is_larger_than_the_limit_is_refused(with_lfs: Any, web: Any, answer: Any, refused: Any) -> None:
    web.serve(with_lfs, "robots.git")
    with_lfs.commit(**{"arm/mesh.obj": POINTER.replace(f"size {len(CONTENT)}", f"size {10**13}")})
    web.serve(with_lfs, "robots.git")
    questions = offer(web, answer)
    assert refused(reference(web)).code == "archive-refused"
    assert questions == []


def test_a_fetched_recipe_reaches_no_server_here(tmp_path: Path, web: Any, own_environment: dict[str, str]) -> None:
    (tmp_path / "mesh.obj").write_text(POINTER)
    lookup = Lookup(tmp_path, own_environment, Fetching(), is_confined=True)
    with pytest.raises(SourceError) as caught:
        replace_pointers(tmp_path, f"{web.url}/robots", tmp_path, lookup=lookup)
    assert caught.value.code == "source-outside" and web.asked == []


def test_only_whole_pointers_are_pointers(tmp_path: Path) -> None:
    (tmp_path / "more.obj").write_text(POINTER + "more\n")
    (tmp_path / "short.obj").write_text(POINTER.replace(SHA256, SHA256[1:]))
    assert list(pointers_in(tmp_path)) == []

"""What an editor sends, and what is no message: everything is answered, and the next message is heard."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest
from lsp.client import Editor
from mjcompose.lsp.protocol import INVALID_PARAMS, INVALID_REQUEST, PARSE_ERROR, Frames
from mjcompose.lsp.server import _structured

GOOD = {"jsonrpc": "2.0", "id": 7, "method": "shutdown"}


def frame(message: Any) -> bytes:
    body = message if isinstance(message, bytes) else json.dumps(message).encode()
    return b"Content-Length: %d\r\n\r\n" % len(body) + body


def read(sent: bytes, structure: Any = _structured) -> tuple[list[Any], list[tuple[Any, int, str]]]:
    """The messages that pygls would get, and the answers that are given in its place."""
    answers: list[tuple[Any, int, str]] = []
    frames = Frames(io.BytesIO(sent), structure, lambda *answer: answers.append(answer))
    got = []
    while head := frames.readline():
        assert head == b"Content-Length: %d\r\n" % len(frames._body) and frames.readline() == b"\r\n"
        got.append(json.loads(frames.read(len(frames._body))))
    return got, answers


@pytest.mark.parametrize(
    "head",
    [
        b"Content-Length: -5\r\n\r\n",
        b"Content-Length: 0\r\n\r\n",
        b"Content-Length: five\r\n\r\n",
        b"Content-Length:\r\n\r\n",
        b"Content-Length: 1e3\r\n\r\n",
        b"Content-Length: \xb2\r\n\r\n",
        b"Content-Length: 9" + b"9" * 99 + b"\r\n\r\n",
        b"Content-Length: 3\r\nContent-Length: 4\r\n\r\n",
        b"Content-Type: x\r\n\r\n",
        b"Content-Length: -5\r\n\r\n" + json.dumps(GOOD).encode(),
        b'Content-Length: -1\r\n\r\n{\n"a": 1\n}',
        b"\0\xff\r\n\r\n",
        b"Content-Length:" + b" " * 60_000 + b"x\r\n\r\n",
    ],
)
def test_a_head_without_a_length_is_answered_and_the_next_message_is_heard(head: bytes) -> None:
    got, answers = read(head + frame(GOOD))
    assert got == [GOOD]
    assert [(number, code) for number, code, _ in answers] == [(None, PARSE_ERROR)]


@pytest.mark.parametrize("head", [b"content-length:%d\n\n", b"\r\nContent-Type: x\r\nCONTENT-LENGTH: \t%d \r\n\r\n"])
def test_heads_may_be_written_in_other_ways(head: bytes) -> None:
    body = json.dumps(GOOD).encode()
    assert read(head % len(body) + body + frame({**GOOD, "method": "exit", "id": 8})) == (
        [GOOD],
        [(8, INVALID_REQUEST, "the server is shutting down")],
    )


POSITION = {"textDocument": {"uri": "file:///a"}, "position": {"line": 0, "character": 0}}
HOVER = {"jsonrpc": "2.0", "id": "a", "method": "textDocument/hover", "params": POSITION}


@pytest.mark.parametrize(
    ("message", "number", "code"),
    [
        (b"{", None, PARSE_ERROR),
        (b"\xff\xfe", None, PARSE_ERROR),
        (b"[" * 200_000, None, PARSE_ERROR),
        ([HOVER], None, INVALID_REQUEST),
        (7, None, INVALID_REQUEST),
        ({}, None, INVALID_REQUEST),
        ({"jsonrpc": "1.0", "id": 3, "method": "shutdown"}, 3, INVALID_REQUEST),
        ({"jsonrpc": "2.0"}, None, INVALID_REQUEST),
        ({"jsonrpc": "2.0", "id": 3, "method": 5}, 3, INVALID_REQUEST),
        ({**HOVER, "id": [1]}, None, INVALID_REQUEST),
        ({**HOVER, "id": True}, None, INVALID_REQUEST),
        ({**HOVER, "id": None}, None, INVALID_REQUEST),
        ({**HOVER, "params": None}, "a", INVALID_PARAMS),
        ({**HOVER, "params": []}, "a", INVALID_PARAMS),
        ({**HOVER, "params": {"textDocument": 1}}, "a", INVALID_PARAMS),
        ({**HOVER, "params": {**POSITION, "position": {"line": "x", "character": {}}}}, "a", INVALID_PARAMS),
        ({"jsonrpc": "2.0", "method": "textDocument/didOpen", "params": {}}, None, INVALID_PARAMS),
    ],
)
def test_what_is_no_message_is_answered(message: Any, number: Any, code: int) -> None:
    got, answers = read(frame(message) + frame(HOVER))
    assert got == [HOVER] and [each[:2] for each in answers] == [(number, code)]
    assert answers[0][2]


@pytest.mark.parametrize("error", [RecursionError, MemoryError, OSError, UnicodeError, KeyError])
def test_a_check_that_fails_refuses(error: type[Exception]) -> None:
    def fails(body: bytes) -> object:
        raise error

    assert read(frame(HOVER), fails) == (
        [],
        [("a", INVALID_PARAMS, "the parameters of `textDocument/hover` do not follow the protocol")],
    )


def test_what_is_too_long_is_passed_over_and_what_is_cut_off_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.lsp.protocol._MOST", 1000)
    got, answers = read(frame(b"x" * 5000) + frame(GOOD))
    assert got == [GOOD] and [each[:2] for each in answers] == [(None, INVALID_REQUEST)]
    assert read(frame(GOOD)[:-1]) == ([], []) and read(b"Content-Length: 20") == ([], [])


def test_a_server_answers_them_all(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("recipe: 1\nbase: ./none.xml\n")
    with Editor(tmp_path) as editor:
        assert editor.process.stdin is not None
        editor.process.stdin.write(b"Content-Length: -5\r\n\r\n" + frame({**HOVER, "params": None}) + frame(b"{"))
        editor.process.stdin.flush()
        codes: list[int] = []
        while len(codes) < 3:
            codes += [message["error"]["code"] for message in [editor._next(20)] if "error" in message]
        assert codes == [PARSE_ERROR, INVALID_PARAMS, PARSE_ERROR]
        (found,) = editor.diagnostics(editor.open("a.yaml"), 20)
        assert found["code"] == "source-not-found"


def test_a_recipe_that_is_too_long_says_so(tmp_path: Path) -> None:
    edit = "  - {select: {geom: g}, set: {size: [1]}}\n"
    with Editor(tmp_path) as editor:
        uri = editor.open("a.yaml", "recipe: 1\nbase: ./m.xml\nedit:\n" + edit * 90_000)
        (found,) = editor.diagnostics(uri, 20)
        assert "has 3.8 MB" in found["message"] and "mjcompose check" in found["message"]
        editor.change(uri, "recipe: 1\nbase: ./m.xml\n")
        assert [each["code"] for each in editor.wait(uri, lambda found: found and "MB" not in found[0]["message"])] == [
            "source-not-found"
        ]


@pytest.mark.parametrize(
    "uri", ["untitled:a\0.yaml", "file:///tmp/a%00b.yaml", "untitled:" + "a" * 5000, "", "\ud800", "file://host/a"]
)
def test_a_document_without_a_name_that_can_be_holds_no_other_up(uri: str, tmp_path: Path) -> None:
    with Editor(tmp_path) as editor:
        item = {"uri": uri, "languageId": "yaml", "version": 1, "text": "recipe: 1\nbase: ./none.xml\n"}
        editor.tell("textDocument/didOpen", {"textDocument": item})
        (found,) = editor.diagnostics(editor.open("a.yaml", "recipe: 1\nbase: ./none.xml\n"), 20)
        assert found["code"] == "source-not-found" and editor.log == []
        editor.ask("textDocument/hover", {"textDocument": {"uri": uri}, "position": {"line": 1, "character": 8}}, 20)
        assert editor.log == []

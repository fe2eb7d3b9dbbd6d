"""The messages of an editor, read from its bytes: what is no message is answered with an error.

pygls 2.1 ignores a frame without a valid length, and everything behind it, and never answers a request whose parameters
it cannot read. From here it gets only messages that it can handle.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, BinaryIO

_LENGTH = b"content-length"
_MOST_LINE = 1 << 16
_MOST = 1 << 26
PARSE_ERROR, INVALID_REQUEST, INVALID_PARAMS = -32700, -32600, -32602

Structure = Callable[[bytes], object]
Answer = Callable[[Any, int, str], None]


class Frames:
    """A stream of valid frames, as `readline` and `read` of a binary file give it.

    `structure` makes the objects of a message, and raises an exception for what the protocol does not have. `answer`
    takes the id of a request (None where there is none), a code and a sentence.
    """

    def __init__(self, stream: BinaryIO, structure: Structure, answer: Answer) -> None:
        self._stream, self._structure, self._answer = stream, structure, answer
        self._head: list[bytes] = []
        self._body = b""
        self._is_shut = False

    def readline(self) -> bytes:
        if not self._head:
            body = self._next()
            if body is None:
                return b""
            self._body = body
            self._head = [b"Content-Length: %d\r\n" % len(body), b"\r\n"]
        return self._head.pop(0)

    def read(self, size: int) -> bytes:
        return self._body

    def _next(self) -> bytes | None:
        """Return the next valid message, or None at the end of the stream."""
        while True:
            length = self._length()
            if length is None:
                return None
            if length > _MOST:
                self._answer(None, INVALID_REQUEST, f"a message has {length} bytes, more than {_MOST}")
                if not self._skip(length):
                    return None
                continue
            body = self._stream.read(length)
            if len(body) < length:
                return None
            if self._is_valid(body):
                return body

    def _length(self) -> int | None:
        """Read the head of a frame, and return its length. One without a valid length is answered, and passed over."""
        found: list[bytes] = []
        is_head = False
        while line := self._stream.readline(_MOST_LINE):
            # At the end of a line: the content of a frame with a wrong length runs into the head of the next one.
            name, _, value = line[max(line.lower().rfind(_LENGTH), 0) :].partition(b":")
            if name.strip().lower() == _LENGTH:
                found.append(value.strip())
            is_head = is_head or bool(line.strip())
            if line.strip() or not is_head:
                continue
            text = found[0] if len(found) == 1 else b""
            if text.isdigit() and len(text) < 16 and int(text):
                return int(text)
            said = ", ".join(each.decode("ascii", "replace")[:40] for each in found[:3])
            wrong = (
                f"`{said}` is not the length of a message" if found else "a message has no `Content-Length`"
            )
            self._answer(None, PARSE_ERROR, wrong)
            found, is_head = [], False
        return None

    def _skip(self, length: int) -> bool:
        while length > 0:
            piece = self._stream.read(min(length, 1 << 20))
            if not piece:
                return False
            length -= len(piece)
        return True

    def _is_valid(self, body: bytes) -> bool:
        """Return whether a message can be handled; answer it otherwise."""
        try:
            message = json.loads(body)
        except Exception as error:  # also a RecursionError, for what nests too deep
            self._answer(None, PARSE_ERROR, f"a message is not JSON: {str(error) or type(error).__name__}")
            return False
        number = message.get("id") if isinstance(message, dict) else None
        if isinstance(number, bool) or not isinstance(number, int | str):
            number = None
        code, wrong = self._fault(message, number, body)
        if wrong is not None:
            self._answer(number, code, wrong)
        return wrong is None

    def _fault(self, message: Any, number: int | str | None, body: bytes) -> tuple[int, str | None]:
        if not isinstance(message, dict) or message.get("jsonrpc") != "2.0":
            return INVALID_REQUEST, "a message is an object with `jsonrpc` 2.0"
        if "method" not in message:
            return (
                INVALID_REQUEST,
                None if "id" in message else "a message has neither a `method` nor an `id`",
            )
        method = message["method"]
        if not isinstance(method, str) or ("id" in message and number is None):
            return INVALID_REQUEST, "a method is a text, and the `id` of a request a text or a whole number"
        if self._is_shut and number is not None:
            return INVALID_REQUEST, "the server is shutting down"
        self._is_shut = self._is_shut or method == "shutdown"
        try:
            self._structure(body)
        except Exception:
            return INVALID_PARAMS, f"the parameters of `{method}` are not as the protocol says"
        return 0, None

"""YAML 1.2 becomes a located tree."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import field
from typing import Any

import yaml

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.sink import Sink
from mjcompose.text.build import Builder
from mjcompose.text.decode import Mask, decode, position
from mjcompose.text.faults import explain
from mjcompose.text.node import Node

_PURE: Any = yaml.SafeLoader
_FAST: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

# JSON writes characters outside of the basic plane as two escapes, which only the pure-Python reader accepts.
_SURROGATE_ESCAPE = re.compile(r"\\u[dD][89a-fA-F]")
_TOO_LARGE_ESCAPE = re.compile(r"\\U(?!000|0010)[0-9a-fA-F]{8}")
_MAX_READINGS = 50
_MAX_CHARACTERS_READ = 4_000_000


def load(text: str | bytes, file: str, sink: Sink, *, empty: str | None = None) -> Node | None:
    """Return the tree of a YAML file; `file` is its path for the user, `empty` the help for an empty file. No I/O.

    All faults that can be found in one run go to `sink`. After a fault that leaves the meaning of the rest clear (a
    duplicate key, a tag, missing quotes) there is still a tree, in which later stages can find more faults.
    Otherwise return None. Never raises on bad input.
    """
    source = decode(text, file, sink)
    if source is None:
        return None
    mask = Mask(source)
    reader = reader_of(source)
    faults: list[Diagnostic] = []
    root = None
    readings = max(1, min(_MAX_READINGS, _MAX_CHARACTERS_READ // max(len(source), 1)))
    for _ in range(readings):
        found = Sink()
        builder = Builder(source, file, found, restore=_restorer(mask, reader is _PURE), empty=empty)
        try:
            root = builder.build(yaml.parse(mask.text, Loader=reader))
        except yaml.MarkedYAMLError as error:
            fault = explain(error, source, file, outer=builder.in_flow)
            faults.append(fault.diagnostic)
            if fault.hide is not None and mask.hide(*fault.hide):
                continue
        except (yaml.YAMLError, ValueError, OverflowError) as error:
            faults.append(_unreadable(error, source, file))
        break
    for diagnostic in [*faults, *found.diagnostics]:
        sink.add(diagnostic)
    return root


def reader_of(text: str) -> Any:
    return _PURE if _SURROGATE_ESCAPE.search(text) else _FAST


def _restorer(mask: Mask, pure: bool) -> Callable[[str], str] | None:
    """Return the function that restores a scalar's original text: it undoes the masking and joins surrogates."""
    if pure:
        return lambda value: mask.restore(value).encode("utf-16-le", "surrogatepass").decode("utf-16-le")
    return mask.restore if mask.active else None


def _unreadable(error: Exception, text: str, file: str) -> Diagnostic:
    escape = _TOO_LARGE_ESCAPE.search(text)
    if escape is None:
        return Diagnostic("yaml-syntax", f"this is not YAML: {error}", Span(file, 1, 1))
    line, column = position(text, escape.start())
    span = Span(file, line, column, end_line=line, end_column=column + len(escape.group()))
    return Diagnostic("yaml-syntax", f"`{escape.group()}` is not a character", span)


_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_BLOCK = re.compile(r"[|>](?:([0-9])|[-+])*")


@dataclass(slots=True)
class Comment:
    """A comment. `column` counts from 0; `own_line` says that only white space precedes it."""

    text: str
    column: int
    own_line: bool
    blank_before: bool


@dataclass(slots=True)
class Token:
    """A token of YAML's grammar, such as `BlockEntry` or `Scalar`, with the comments before it.

    `line` and `column` count from 0; `blank` says that an empty line precedes it. Tokens such as `BlockEnd` have no
    width and share the place of the next token.
    """

    kind: str
    text: str
    line: int
    end_line: int
    column: int
    comments: list[Comment] = field(default_factory=list)
    blank: bool = False
    depth: int = 0  # for a block scalar, the column where its content begins
    ended: bool = True  # for a block scalar, whether a line break follows


def tokens(text: str) -> list[Token]:
    """Return the tokens of a text in which `load` found no fault. No I/O."""
    starts = [0, *(found.end() for found in _LINE_BREAK.finditer(text))]
    result: list[Token] = []
    columns = [0]  # of the enclosing collections
    last = 0
    found: Iterator[Any] = yaml.scan(Mask(text).text, Loader=reader_of(text))
    for each in found:
        start, end = each.start_mark.index, each.end_mark.index
        line = bisect_right(starts, start) - 1
        kind = type(each).__name__.removesuffix("Token")
        token = Token(kind, text[start:end], line, end_line=0, column=start - starts[line])
        if kind == "Scalar" and each.style in ("|", ">"):
            _block(token, columns[-1])
            token.ended = start + len(token.text) < len(text) or token.text.endswith(("\n", "\r"))
        elif kind in ("BlockMappingStart", "BlockSequenceStart"):
            columns.append(token.column)
        elif kind == "BlockEnd":
            columns.pop()
        end = start + len(token.text)
        token.end_line = bisect_right(starts, end) - 1
        _between(text, last, start, token=token)
        last = max(last, end)
        result.append(token)
    return result


def comments(found: list[Token]) -> list[str]:
    """Return the texts of all comments, including those in the first line of a block scalar."""
    texts = []
    for token in found:
        texts += [each.text for each in token.comments]
        if token.kind == "Scalar" and token.text[:1] in ("|", ">"):
            _, mark, rest = _LINE_BREAK.split(token.text)[0].partition("#")
            texts += [f"{mark}{rest.rstrip()}"] if mark else []
    return texts


def _block(token: Token, column: int) -> None:
    """Find the indentation of a block scalar, and remove lines at its end that are not part of its value."""
    header = _BLOCK.match(token.text)
    assert header is not None
    lines = _LINE_BREAK.split(token.text)
    if header.group(1):
        token.depth = column + int(header.group(1))
    else:
        first = next((line for line in lines[1:] if line.strip(" ")), None)
        blank = max((len(line) for line in lines[1:]), default=0)
        token.depth = blank if first is None else len(first) - len(first.lstrip(" "))
    if "+" in header.group():
        return
    while len(lines) > 1 and not lines[-1].strip(" ") and len(lines[-1]) <= token.depth:
        token.text = token.text[: len(token.text) - len(lines.pop())]
        token.text = token.text.removesuffix("\n").removesuffix("\r")


def _between(text: str, start: int, end: int, token: Token) -> None:
    pieces = _LINE_BREAK.split(text[start:end])
    position = start
    for index, piece in enumerate(pieces):
        stripped = piece.strip()
        if stripped.startswith("#"):
            begin = max(text.rfind("\n", 0, position), text.rfind("\r", 0, position)) + 1
            column = position + piece.index("#") - begin
            own_line = index > 0 or start == 0 or text[start - 1] in "\r\n"
            token.comments.append(Comment(stripped, column, own_line, blank_before=token.blank))
            token.blank = False
        elif not stripped and 0 < index < len(pieces) - 1:
            token.blank = True
        position += len(piece)
        position += len(found.group()) if (found := _LINE_BREAK.match(text, position)) else 0

"""Load YAML 1.2 as a located tree."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import field
from typing import Any

import yaml

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.limits import advice, in_force, written
from mjcompose.base.sink import Sink
from mjcompose.text.build import Builder
from mjcompose.text.faults import explain
from mjcompose.text.node import LINE_BREAK, Node, position

_UNPRINTABLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x80-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")
_UTF_16_OR_32 = ((b"\xff\xfe\0\0", "UTF-32"), (b"\xff\xfe", "UTF-16"), (b"\xfe\xff", "UTF-16"))


def refuse_size(file: str, sink: Sink) -> None:
    """Report a file that is larger than a recipe may be."""
    message = f"`{file}` is larger than the {written('recipe-size', in_force().recipe_size)} that a recipe may have"
    notes = [Note("put meshes and other data into files, which a recipe names")]
    sink.error("yaml-too-large", message, Span(file, 1, 1), notes=notes, help=advice("recipe-size"))


def decode(source: str | bytes, file: str, sink: Sink) -> str | None:
    """Return the text without its byte order mark, or None after an error, such as control characters."""
    if len(source) > in_force().recipe_size:
        refuse_size(file, sink)
        return None
    text = _utf8(source, file, sink) if isinstance(source, bytes) else source
    if text is None:
        return None
    text = text.removeprefix("\ufeff")
    bad = _UNPRINTABLE.search(text)
    if bad is None:
        return text
    line, column = position(text, bad.start())
    others = len(_UNPRINTABLE.findall(text)) - 1
    code = ord(bad.group())
    notes = [Note(f"the file has {others} more such characters; it may not be a text file")] if others else ()
    help = "remove it" if 0xD800 <= code <= 0xDFFF else f'remove it, or write "\\u{code:04x}" inside double quotes'
    span = Span(file, line, column, end_line=line, end_column=column + 1)
    sink.error("yaml-syntax", f"YAML cannot contain the character U+{code:04X}", span, notes=notes, help=help)
    return None


def _utf8(source: bytes, file: str, sink: Sink) -> str | None:
    for mark, encoding in _UTF_16_OR_32:
        if source.startswith(mark):
            sink.error("yaml-not-utf8", f"`{file}` is {encoding} text", Span(file, 1, 1), help="save the file as UTF-8")
            return None
    try:
        return source.decode("utf-8")
    except UnicodeDecodeError as fault:
        before = source[: fault.start].decode("utf-8").removeprefix("\ufeff")
        line, column = position(before, len(before))
        message = f"the byte 0x{source[fault.start]:02x} is not part of UTF-8 text"
        span = Span(file, line, column, end_line=line, end_column=column + 1)
        sink.error("yaml-not-utf8", message, span, help="save the file as UTF-8")
        return None


_LINE_BREAKS_OF_YAML_1_1 = "\x85\u2028\u2029"
_HARMFUL = frozenset("{}[],:#\"'&*!|>%@`?-\t\\")


class Mask:
    """A text with some characters replaced one for one: all positions stay the same.

    The replacements are private-use characters that do not occur in the text, literally or as an escape. From the
    start, characters are masked that are line breaks in YAML 1.1 but not in 1.2.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self._original = text
        self._stand_ins: dict[str, str] = {}
        self._originals: dict[int, str] = {}
        self._pool: Iterator[str] | None = None
        for character in _LINE_BREAKS_OF_YAML_1_1:
            if character in text and (stand_in := self._stand_in(character)) is not None:
                self.text = self.text.replace(character, stand_in)

    def hide(self, start: int, end: int) -> bool:
        """Make a stretch readable as part of a plain scalar. Return False if that changes nothing."""
        before = self.text[start:end]
        hidden = "".join((self._stand_in(each) or each) if each in _HARMFUL else each for each in before)
        self.text = self.text[:start] + hidden + self.text[end:]
        return hidden != before

    @property
    def active(self) -> bool:
        return bool(self._originals)

    def restore(self, value: str) -> str:
        return value.translate(self._originals)

    def _stand_in(self, character: str) -> str | None:
        found = self._stand_ins.get(character)
        if found is None:
            if self._pool is None:
                text = self._original
                lowered = self._original.lower()
                codes = (code for code in range(0xE000, 0xF900) if f"{code:x}" not in lowered)
                self._pool = (chr(code) for code in codes if chr(code) not in text)
            found = next(self._pool, None)
            if found is not None:
                self._stand_ins[character] = found
                self._originals[ord(found)] = character
        return found


_PURE: Any = yaml.SafeLoader
_FAST: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

# JSON writes characters outside of the basic plane as two escapes, which only the pure-Python reader accepts.
_SURROGATE_ESCAPE = re.compile(r"\\u[dD][89a-fA-F]")
_TOO_LARGE_ESCAPE = re.compile(r"\\U(?!000|0010)[0-9a-fA-F]{8}")
_MAX_READINGS = 50
_MAX_CHARACTERS_READ = 4_000_000


def load(text: str | bytes, file: str, sink: Sink, *, empty: str | None = None) -> Node | None:
    """Return the tree of a YAML file; `file` is its path for the user, and `empty` is the help for an empty file.

    No I/O. All faults that can be found in one run go to `sink`. After a fault that leaves the meaning of the rest
    clear (a duplicate key, a tag, missing quotes) there is still a tree, in which later stages can find more faults.
    Otherwise return None. Never raises on bad input.
    """
    source = decode(text, file, sink)
    if source is None:
        return None
    mask = Mask(source)
    reader = reader_of(source)
    faults: list[Diagnostic] = []
    root = None
    for _ in range(max(1, min(_MAX_READINGS, _MAX_CHARACTERS_READ // max(len(source), 1)))):
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
    sink.extend([*faults, *found.diagnostics])
    return root


def reader_of(text: str) -> Any:
    return _PURE if _SURROGATE_ESCAPE.search(text) else _FAST


def is_text_in_yaml_1_1(text: str) -> bool:
    """Return whether other programs, such as PyYAML, read a plain scalar as text.

    >>> is_text_in_yaml_1_1("arm"), is_text_in_yaml_1_1("no"), is_text_in_yaml_1_1("12:30")
    (True, False, False)
    """
    forms = yaml.SafeLoader.yaml_implicit_resolvers.get(text[:1], ())
    return not any(form.match(text) for _, form in forms)


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


_BLOCK = re.compile(r"[|>](?:([0-9])|[-+])*")


class Comment(Struct, frozen=False):
    """A comment. `column` counts from 0; `own_line` says that only white space precedes it."""

    text: str
    column: int
    own_line: bool
    blank_before: bool


class Token(Struct, frozen=False):
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
    starts = [0, *(found.end() for found in LINE_BREAK.finditer(text))]
    result: list[Token] = []
    columns = [0]  # of the enclosing collections
    last = 0
    found: Iterator[Any] = yaml.scan(Mask(text).text, Loader=reader_of(text))
    for each in found:
        start = each.start_mark.index
        end = each.end_mark.index
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
            _, mark, rest = LINE_BREAK.split(token.text)[0].partition("#")
            texts += [f"{mark}{rest.rstrip()}"] if mark else []
    return texts


def _block(token: Token, column: int) -> None:
    """Find the indentation of a block scalar, and remove lines at its end that are not part of its value."""
    header = _BLOCK.match(token.text)
    assert header is not None
    lines = LINE_BREAK.split(token.text)
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
    pieces = LINE_BREAK.split(text[start:end])
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
        line_break = LINE_BREAK.match(text, position)
        if line_break:
            position = line_break.end()

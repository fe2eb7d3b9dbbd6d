"""The place of a cursor in a recipe, found from the text alone, because a half-written recipe is seldom valid YAML.

Indentation and brackets before the cursor decide, as they do for a human reader. Text after the cursor counts only
as the rest of the word at the cursor.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import field, replace
from typing import Literal

from mjcompose.base.dataclass import Struct

Path = tuple[str | int, ...]
Role = Literal["key", "value", "either", "text", "tag", "content", "end"]

# YAML 1.2 lets a plain word begin with `-`, `?` or `:` if no space follows; here only with `-`, as in `-1`.
_PLAIN = r"""[^\s\-?#&*!|>%@`"'\[\]{},:][^#\[\]{}:]*?|-[^\s:]+"""
_KEY = re.compile(rf"""(?:"((?:[^"\\]|\\.)*)"|'((?:[^']|'')*)'|({_PLAIN}))\s*:(?=\s|$)""")
_PROPERTIES = re.compile(r"(?:[&!]\S*\s+)+")
_BLOCK = re.compile(r"[|>][-+0-9]*\s*(?:#.*)?$")
_CLOSING = {"{": "}", "[": "]"}


class Cursor(Struct):
    """The text that you are writing at a cursor.

    `path` leads to the mapping of a key that you are writing (`key`), to a value (`value`), or to a place for a value
    or a first key (`either`). With the role `text`, the cursor is in a block of text or a comment. In XML, a key is an
    attribute, and there are the roles `tag` (of a start tag), `end` and `content` (between tags). The word covers the
    columns from `start` to `end`, counted from 0 and without quotes; `word` is the part of it before the cursor.
    `written` are the keys of the mapping before the cursor. `line` is counted from 0.
    """

    path: Path
    role: Role
    word: str
    line: int
    start: int
    end: int
    quote: str = ""
    in_flow: bool = False
    has_colon: bool = False
    whole: str = ""
    written: tuple[str, ...] = ()


class _Frame(Struct, frozen=False):
    """An open mapping or list: its indent or bracket, and the step to its next value."""

    indent: int
    is_list: bool
    step: str | int | None = None
    bracket: str = ""
    keys: list[str] = field(default_factory=list)
    has_value: bool = False


def cursor_at(lines: Sequence[str], line: int, column: int) -> Cursor:
    """Return the cursor at a place. `line` and `column` are counted from 0.

    >>> cursor_at(["attach:", "  gripper:", "    site: att"], 2, 13).path
    ('attach', 'gripper', 'site')
    """
    scan = _Scan()
    for text in lines[:line]:
        scan.line(text)
    text = lines[line] if line < len(lines) else ""
    return scan.cursor(text, line, min(column, len(text)))


class _Scan:
    def __init__(self) -> None:
        self.stack: list[_Frame] = []
        self.block: int | None = None  # the indent that the lines of an open block of text are deeper than

    def line(self, text: str) -> None:
        stripped = text.strip()
        indent = len(text) - len(text.lstrip(" "))
        if self.block is not None:
            if not stripped or indent > self.block:
                return
            self.block = None
        if not stripped or stripped.startswith("#"):
            return
        if self.in_flow:
            self.flow(text, indent)
            return
        at = self.begin(text, indent)
        if at < len(text):
            self.value(text, at)

    @property
    def in_flow(self) -> bool:
        return bool(self.stack) and bool(self.stack[-1].bracket)

    def begin(self, text: str, at: int) -> int:
        """Enter the lists and mappings that begin on a line in block style. Return the column of the value."""
        while True:
            rest = text[at:]
            if rest == "-" or rest.startswith(("- ", "-\t")):
                self.item(at)
                at += 1 + len(rest[1:]) - len(rest[1:].lstrip())
                continue
            found = _KEY.match(text, at)
            if found is None:
                return at
            self.enter(at, _name(found))
            return found.end() + len(text[found.end() :]) - len(text[found.end() :].lstrip())

    def item(self, indent: int) -> None:
        self.leave(indent)
        top = self.stack[-1] if self.stack else None
        if top is not None and top.is_list and top.indent == indent:
            top.step = top.step + 1 if isinstance(top.step, int) else 0
            top.has_value = False
        else:
            self.stack.append(_Frame(indent, True, 0))

    def enter(self, indent: int, key: str) -> None:
        self.leave(indent)
        while self.stack and self.stack[-1].is_list and self.stack[-1].indent == indent:
            self.stack.pop()
        if not self.stack or self.stack[-1].indent < indent:
            self.stack.append(_Frame(indent, False))
        self.stack[-1].step = key
        self.stack[-1].has_value = False
        self.stack[-1].keys.append(key)

    def leave(self, indent: int) -> None:
        while self.stack and self.stack[-1].indent > indent:
            self.stack.pop()

    def value(self, text: str, at: int) -> None:
        properties = _PROPERTIES.match(text, at)
        at = properties.end() if properties else at
        rest = text[at:]
        if rest.startswith("#") or not rest.strip():
            return
        if self.stack:
            self.stack[-1].has_value = True
        if _BLOCK.match(rest):
            self.block = self.stack[-1].indent if self.stack else -1
        elif rest[0] in _CLOSING:
            self.flow(text, at)

    def flow(self, text: str, at: int) -> tuple[int, str]:
        """Process text in brackets.

        Return the column at which its last word begins, without the quote, and the quote if it is still open.
        """
        begin = at
        while at < len(text):
            character = text[at]
            if character in "\"'" and not text[begin:at].strip():
                begin = at
                closing = _closing_quote(text, at)
                if closing is None:
                    return begin, character
                at = closing
            elif _begins_comment(text, at):
                return len(text), ""
            elif character in _CLOSING:
                self.open_bracket(_CLOSING[character])
                begin = at + 1
            elif character in "]}":
                if self.in_flow:
                    self.stack.pop()
                if not self.in_flow:
                    return at + 1, ""
                begin = at + 1
            elif character == ",":
                top = self.stack[-1]
                top.step = top.step + 1 if isinstance(top.step, int) else None
                begin = at + 1
            elif character == ":" and self.ends_key(text, begin, at):
                key = _unquoted(text[begin:at].strip())
                self.stack[-1].step = key
                self.stack[-1].keys.append(key)
                begin = at + 1
            at += 1
        return begin, ""

    def open_bracket(self, closing: str) -> None:
        indent = self.stack[-1].indent if self.stack else 0
        is_list = closing == "]"
        self.stack.append(_Frame(indent, is_list, 0 if is_list else None, closing))

    def ends_key(self, text: str, begin: int, at: int) -> bool:
        """Return whether the colon at a column ends a key in brackets, as in `{a: 1}`, `{a:}` and `{"a":1}`."""
        top = self.stack[-1]
        if top.is_list or top.step is not None:
            return False
        # YAML 1.2: only a quoted key may have a value directly after its colon (`{"a":1}`); `{a:1}` is one word.
        is_quoted = text[begin:at].lstrip()[:1] in ('"', "'")
        return is_quoted or text[at + 1 : at + 2] in ("", " ", "\t", ",", "]", "}")

    def cursor(self, text: str, line: int, column: int) -> Cursor:
        before = text[:column]
        indent = len(before) - len(before.lstrip(" "))
        blank = not before.strip()
        is_in_block = self.block is not None and (column if blank else indent) > self.block
        if is_in_block or _ends_in_comment(before):
            return Cursor(self.path(), "text", "", line=line, start=column, end=column)
        self.block = None
        if self.in_flow:
            return self.in_brackets(text, 0, line, column)
        if blank:
            return self.of_key(text, line, column, at=column)
        at = self.begin(before, indent)
        # The first word on its line is a key without its colon, or a value below its key.
        if at == indent and not before[at:].startswith("-"):
            return self.of_key(text, line, column, at=at)
        properties = _PROPERTIES.match(before, at)
        at = properties.end() if properties else at
        if before[at : at + 1] in _CLOSING and at < column:
            return self.in_brackets(text, at, line, column)
        role: Role = "either" if self.stack and self.stack[-1].is_list else "value"
        rest = re.split(r"\s+#", text[column:], maxsplit=1)[0]
        cursor = self.word(text, line, column, at, column + len(rest.rstrip()), role)
        return self.as_key(cursor, text) if role == "either" else cursor

    def of_key(self, text: str, line: int, column: int, at: int) -> Cursor:
        """Return the cursor at a word at the start of a line: a key, unless the key above still needs a value."""
        self.settle(at)
        is_open = bool(self.stack) and self.stack[-1].indent < at and not self.stack[-1].has_value
        role: Role = "either" if is_open else "key"
        end = at + len(re.match(r"[^\s:#]*", text[at:]).group())  # type: ignore[union-attr]
        return self.as_key(self.word(text, line, column, at, max(end, column), role), text)

    def as_key(self, cursor: Cursor, text: str) -> Cursor:
        """Return the cursor, and note whether the colon of the key is already written."""
        return replace(cursor, has_colon=text[cursor.end + len(cursor.quote) :].lstrip().startswith(":"))

    def settle(self, indent: int) -> None:
        """Close everything that a word with this indent cannot belong to."""
        self.leave(indent)
        while self.stack and self.stack[-1].is_list and self.stack[-1].indent >= indent:
            self.stack.pop()
        while len(self.stack) > 1 and self.stack[-1].is_list and self.stack[-1].has_value:
            self.stack.pop()

    def in_brackets(self, text: str, at: int, line: int, column: int) -> Cursor:
        begin, quote = self.flow(text[:column], at)
        if not self.in_flow:
            return Cursor(self.path(), "text", "", line=line, start=column, end=column)
        top = self.stack[-1]
        role: Role = "either" if top.is_list else "value" if top.step is not None else "key"
        begin += len(text[begin:column]) - len(text[begin:column].lstrip())
        rest = text[column:]
        if quote or text[begin : begin + 1] in ('"', "'"):
            closing = rest.find(text[begin])
            end = column + (closing if closing >= 0 else len(re.match(r"[^,\]}]*", rest).group().rstrip()))  # type: ignore[union-attr]
        else:
            end = column + len(re.match(r"[^,\[\]{}:#\s]*", rest).group())  # type: ignore[union-attr]
        cursor = replace(self.word(text, line, column, begin, end, role), in_flow=True)
        if role == "value" and text[begin : begin + 1] in _CLOSING:
            return replace(cursor, role="text")
        return self.as_key(cursor, text) if role != "value" else cursor

    def word(self, text: str, line: int, column: int, at: int, end: int, role: Role) -> Cursor:
        quote = text[at : at + 1] if text[at : at + 1] in ('"', "'") and at < column else ""
        start = at + len(quote)
        if quote and not self.in_flow:
            closing = text.find(quote, column)
            end = closing if closing >= 0 else end
        end = max(end, column)
        top = self.stack[-1] if self.stack else None
        keys = tuple(top.keys) if top is not None and role == "key" and not top.is_list else ()
        return Cursor(
            self.path(role == "key"),
            role,
            text[start:column],
            line=line,
            start=start,
            end=end,
            quote=quote,
            whole=text[start:end],
            written=keys,
        )

    def path(self, of_mapping: bool = False) -> Path:
        """Return the path of the next value, or of the mapping to which the next key belongs."""
        frames = self.stack[:-1] if of_mapping and self.stack and not self.stack[-1].is_list else self.stack
        return tuple(frame.step for frame in frames if frame.step is not None)


def _name(found: re.Match[str]) -> str:
    double, single, plain = found.groups()
    if single is not None:
        return single.replace("''", "'")
    return str(double if double is not None else plain.strip())


def _unquoted(word: str) -> str:
    return word[1:-1] if len(word) > 1 and word[0] in "\"'" and word[-1] == word[0] else word


def _closing_quote(text: str, at: int) -> int | None:
    """Return the column of the quote that closes the one at a column, or None if that is still open."""
    quote = text[at]
    at += 1
    while at < len(text):
        if text[at] == quote:
            return at
        is_escape = text[at] == "\\" and quote == '"'
        at += 2 if is_escape else 1
    return None


def _begins_comment(text: str, at: int) -> bool:
    return text[at] == "#" and (at == 0 or text[at - 1].isspace())


def _ends_in_comment(before: str) -> bool:
    """Return whether a text contains a comment. A `#` in quotes does not begin one."""
    quote = ""
    for at, character in enumerate(before):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'" and (at == 0 or before[at - 1] in " [{,:"):
            quote = character
        elif character == "#" and (at == 0 or before[at - 1] in " \t"):
            return True
    return False

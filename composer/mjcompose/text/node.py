"""YAML as a located tree: every key and value knows its file, line and column. It also inserts into the text."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence as Lines
from typing import Any, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.tree.values import NOT_XML, code_point

LINE_BREAK = re.compile(r"\r\n|\n|\r")

# The core schema of YAML 1.2, as editors read it. PyYAML 6.0 reads YAML 1.1: there `no` and `on` are booleans, `1e-3`
# is a text, `017` is 15, and `12:30` is 750.
_WORDS: dict[str, bool | float | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **{sign + word: float(sign + "inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NUMERIC = frozenset("+-.0123456789")
_MAX_DIGITS = 1000


def resolve(text: str) -> bool | int | float | str | None:
    """Return the value of a plain scalar.

    Raises `OverflowError` for a number that is too large for a float.

    >>> [resolve(text) for text in ("1e-3", "010", "0x1F", "no", "12:30", "1_000", "~")]
    [0.001, 10, 31, 'no', '12:30', '1_000', None]
    """
    if text in _WORDS:
        return _WORDS[text]
    if text[0] not in _NUMERIC:
        return text
    if _DECIMAL.fullmatch(text):
        return _bounded(text, 10)
    if _FLOAT.fullmatch(text):
        number = float(text)
        if math.isinf(number):
            raise OverflowError(text)
        return number
    if _OCTAL.fullmatch(text):
        return _bounded(text[2:], 8)
    if _HEXADECIMAL.fullmatch(text):
        return _bounded(text, 16)
    return text


def _bounded(digits: str, base: int) -> int:
    if len(digits) > _MAX_DIGITS:
        raise OverflowError(digits)
    number = int(digits, base)
    float(number)  # raises if it is too large for a float
    return number


_PROPERTIES = re.compile(r"(?:[&!]\S*[ \t]+)+")
_TAG = re.compile(r"(?:&\S+\s+)?(!<[^>\s]*>|![^\s,\[\]{}]*)")
_BLOCK_HEADER = re.compile(r"[|>][-+0-9]*")
_REST_OF_LINE = re.compile(r"[^\r\n]*")


class Marks:
    """Finds the places of events in `text`."""

    __slots__ = ("file", "text")

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file

    def span(self, event: Any) -> Span:
        """Return the place of an event without anchor and tag; if it has several lines, the first."""
        start = event.start_mark
        end = event.end_mark
        line = start.line + 1
        column = start.column + 1
        if end.line + 1 == line:
            last = end.column + 1
        else:
            header = _BLOCK_HEADER if getattr(event, "style", None) in ("|", ">") else _REST_OF_LINE
            found = header.match(self.text, start.index) or _REST_OF_LINE.match(self.text, start.index)
            last = column + (len(found.group().rstrip()) if found else 0)
        if getattr(event, "tag", None) is not None or getattr(event, "anchor", None) is not None:
            column = min(column + self.properties(event), last)
        return Span(self.file, line, column, end_line=line, end_column=last)

    def block(self, event: Any) -> tuple[int, int] | None:
        """Return the line and column where the text of a literal block begins; None for all other scalars."""
        if event.style != "|":
            return None
        written = self.text[event.start_mark.index : event.end_mark.index].splitlines()[1:]
        indent = next((len(line) - len(line.lstrip(" ")) for line in written if line.strip()), 0)
        return event.start_mark.line + 2, indent + 1

    def properties(self, event: Any) -> int:
        """Return the number of characters for anchor and tag before the value, if it follows on their line."""
        found = _PROPERTIES.match(self.text, event.start_mark.index)
        return len(found.group()) if found else 0

    def tag(self, event: Any) -> Span:
        found = _TAG.match(self.text, event.start_mark.index)
        line = event.start_mark.line + 1
        column = event.start_mark.column + 1
        if found is None or "\n" in found.group():
            return Span(self.file, line, column, end_line=line, end_column=column + 1)
        column += found.start(1) - found.start()
        return Span(self.file, line, column, end_line=line, end_column=column + len(found.group(1)))


class Scalar(Struct):
    """A single value.

    `text` is the written text, without quotes and with escapes resolved; `plain` says that it has neither quotes
    nor a block style: `value` then follows the rules of the YAML 1.2 core schema. For a literal block (`|`),
    `block` is the line and column where its text begins: each line of `text` is a line of the file.
    """

    value: bool | int | float | str | None
    span: Span
    text: str
    plain: bool
    block: tuple[int, int] | None = None


class Key(Struct):
    """A key of a mapping: always text, as written (`1`, `no` and `12:30` are names too)."""

    name: str
    span: Span


class Mapping(Struct):
    """Keys and values in the order of the file, never changed. Its span covers the first of several lines."""

    entries: dict[str, tuple[Key, Node]]
    span: Span


class Sequence(Struct):
    """A list of values. The span of a list over several lines covers its first line."""

    items: tuple[Node, ...]
    span: Span


Node = Scalar | Mapping | Sequence


class Visit(NamedTuple):
    """A value in a tree."""

    path: tuple[str | int, ...]
    key: Key | None
    node: Node


def walk(node: Node, path: tuple[str | int, ...] = (), key: Key | None = None) -> Iterator[Visit]:
    """Yield every value with its path and its key, if it has one. A collection comes before its contents."""
    yield Visit(path, key, node)
    if isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from walk(item, (*path, index))
    elif isinstance(node, Mapping):
        for name, (key, value) in node.entries.items():
            yield from walk(value, (*path, name), key)


def texts(node: Node) -> Iterator[str]:
    for _, key, value in walk(node):
        if key is not None:
            yield key.name
        if isinstance(value, Scalar):
            yield value.text


def spans(node: Node) -> Iterator[Span]:
    for _, key, value in walk(node):
        if key is not None:
            yield key.span
        yield value.span


def to_python(node: Node) -> Any:
    """Return plain dicts, lists and values, without places. Recursive, because `load` keeps trees shallow."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, Sequence):
        return [to_python(item) for item in node.items]
    return {name: to_python(value) for name, (_, value) in node.entries.items()}


def find(node: Node, path: tuple[str | int, ...]) -> Node | None:
    """Return the node at `path`, or None if a step of it does not exist."""
    found: Node | None = node
    for step in path:
        if isinstance(found, Mapping) and isinstance(step, str):
            found = found.entries[step][1] if step in found.entries else None
        elif isinstance(found, Sequence) and isinstance(step, int):
            found = found.items[step] if 0 <= step < len(found.items) else None
        else:
            return None
    return found


def locate(node: Node, path: tuple[str | int, ...], key: bool = False) -> Span:
    """Return the place of the node at `path`, or of the deepest existing node on the way.

    A step is a key's name or an item's index; a step that does not exist is skipped. That way a validator's path
    with the names of chosen alternatives in it, such as `("sensor", "imu", "force", "site")`, finds its node. With
    `key`, or if the path ends in `"[key]"`, return the place of the last key on the way instead of its value's.
    """
    if path and path[-1] == "[key]":
        path = path[:-1]
        key = True
    span = node.span
    for step, following in zip(path, (*path, None)[1:], strict=True):
        if isinstance(node, Mapping) and isinstance(step, str) and step in node.entries:
            found, value = node.entries[step]
            if isinstance(value, Scalar) and following in node.entries:
                continue  # the name of an alternative that is also a key
            node = value
            span = found.span if key else value.span
        elif isinstance(node, Sequence) and isinstance(step, int) and 0 <= step < len(node.items):
            node = node.items[step]
            span = node.span
    return span


def check_characters(node: Node, sink: Sink) -> None:
    """Report every key and value with a character that cannot occur in a name, a path or a value of a model."""
    for _, key, value in walk(node):
        texts = [(key.name, key.span)] if key is not None else []
        if isinstance(value, Scalar):
            texts.append((value.text, value.span))
        for text, span in texts:
            odd = NOT_XML.search(text)
            if odd:
                message = f"this escape is the character {code_point(odd.group())}, which XML cannot contain"
                sink.error("yaml-syntax", message, span, help="remove it")


OPENING = "${"


def is_template(text: str) -> bool:
    return OPENING in text


class TextChange(Struct):
    """A replacement of a stretch of text. With an empty span, the text is inserted there."""

    span: Span
    text: str


def position(text: str, index: int) -> tuple[int, int]:
    r"""Return the line and the column, both from 1, of the character at `index`.

    >>> position("ab\r\ncd", 5)
    (2, 2)
    """
    line = 1
    begin = 0
    for found in LINE_BREAK.finditer(text):
        if found.end() > index:
            break
        line = line + 1
        begin = found.end()
    return line, index - begin + 1


def lines_of(text: str) -> list[str]:
    """Return the lines without their ends. `str.splitlines` also splits at characters that editors and YAML do not."""
    return LINE_BREAK.split(text)


def with_key(tree: Mapping, lines: Lines[str], file: str, path: tuple[str | int, ...], value: str) -> TextChange | None:
    """Return the change that writes `path: value` with the missing keys, or None if the path leads through a value."""
    holder: Node = tree
    for depth, step in enumerate(path):
        if not isinstance(holder, Mapping):
            return None
        below = find(holder, (step,))
        if below is None:
            *outer, last = map(str, path[depth:])
            text = "".join(f"{step}: {{" for step in outer) + f"{last}: {value}" + "}" * len(outer)
            return added_key(holder, lines, file, text, top=depth == 0)
        holder = below
    if holder.span.end_column is None or isinstance(holder, Mapping | Sequence):
        return None
    return TextChange(holder.span, value)


def with_item(tree: Mapping, lines: Lines[str], file: str, key: str, value: str) -> TextChange | None:
    """Return the change that appends a value to the list below a key of the recipe, or creates the list; or None."""
    found = tree.entries.get(key)
    if found is None:
        return added_key(tree, lines, file, f"{key}: [{value}]", top=True)
    node = found[1]
    if not isinstance(node, Sequence) or not node.items:
        return None
    last = node.items[-1].span
    if _is_flow(node, lines):
        return _insert(file, last.end_line or last.line, last.end_column or last.column, f", {value}")
    line = last.line
    indent = lines[last.line - 1].index("-")
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}- {value}")


def added_key(holder: Mapping, lines: Lines[str], file: str, text: str, top: bool) -> TextChange:
    if not top and _is_flow(holder, lines):
        line, column = _end(holder, file)
        at = lines[line - 1].find("}", column - 1) + 1 or column
        return _insert(file, line, at, f", {text}" if holder.entries else text)
    line, _ = _end(holder, file)
    while line < len(lines) and lines[line].strip() and lines[line].startswith(" ") and top:
        line += 1  # in a block of text: the tree knows only its first line
    first = next(iter(holder.entries.values()), None)
    indent = 0 if top or first is None else first[0].span.column - 1
    return _insert(file, line, len(lines[line - 1]) + 1, f"\n{' ' * indent}{text}")


def _is_flow(node: Node, lines: Lines[str]) -> bool:
    row = lines[node.span.line - 1] if node.span.line <= len(lines) else ""
    return row[node.span.column - 1 : node.span.column] in ("{", "[")


def _end(node: Node, file: str) -> tuple[int, int]:
    own = [span for span in spans(node) if span.file == file]
    return max((each.end_line or each.line, each.end_column or each.column) for each in own[1:] or own)


def _insert(file: str, line: int, column: int, text: str) -> TextChange:
    return TextChange(Span(file, line, column, end_line=line, end_column=column), text)


def changed(text: str, changes: Iterable[TextChange]) -> str:
    r"""Return the text with changes that do not overlap.

    >>> changed("a: 1\nb: 2\n", [TextChange(Span("", 2, 4, 2, 5), "3"), TextChange(Span("", 1, 5, 1, 5), "\nc: 4")])
    'a: 1\nc: 4\nb: 3\n'
    """
    starts = [0, *(found.end() for found in LINE_BREAK.finditer(text))]
    for each in sorted(changes, key=lambda each: (each.span.line, each.span.column), reverse=True):
        line = each.span.line
        column = each.span.column
        end = starts[(each.span.end_line or line) - 1] + (each.span.end_column or column) - 1
        text = text[: starts[line - 1] + column - 1] + each.text + text[end:]
    return text

"""An MJCF file in the layout of MuJoCo Menagerie's files, with its comments and the text of its values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.tree.classes import ORIENTATIONS
from mjcompose.tree.grammar import GRAMMAR, ElementType
from mjcompose.tree.parse import parse_xml
from mjcompose.tree.xml_text import Piece, WrittenAttribute, pieces, root_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

WIDTH = 120
"""The most characters of a line, without the end of its tag."""


@cache
def attribute_order(kind: ElementType) -> Mapping[str, int]:
    """Return the place of each attribute: the order of the grammar, with the orientation after the position."""
    names = list(kind.attributes)
    if "pos" in names:
        names = [each for each in names if each not in ORIENTATIONS]
        at = names.index("pos") + 1
        names[at:at] = [each for each in ORIENTATIONS if each in kind.attributes]
    return {name: at for at, name in enumerate(names)}


def place_of_fragment(tags: set[str]) -> Mapping[str, ElementType]:
    """Return the children that are allowed where a file with these outermost tags can be included."""
    kinds = (GRAMMAR.root, *map(GRAMMAR.element, ("body", *GRAMMAR.paths)))
    return next((kind.children for kind in kinds if tags <= set(kind.children)), GRAMMAR.root.children)


def outermost(parts: list[Piece]) -> set[str]:
    """Return the tags of the children of the root."""
    depth = 0
    found = set()
    for each in parts:
        if each.kind == "start" and depth == 1 and each.tag not in ("", "include"):
            found.add(each.tag)
        depth += (each.kind == "start" and not each.closed) - (each.kind == "end")
    return found


class UnusualXml(Exception):
    """A piece of text that has no place in the layout, at a character of the text."""

    def __init__(self, message: str, at: int) -> None:
        super().__init__(message)
        self.at = at


_LEADS = re.compile(r"[ \t]*\n[ \t]*<(?!/)")
"""Matches after a comment on its own line that another comment or an element follows."""


class _Layout:
    def __init__(self, text: str) -> None:
        self.text = text
        self.parts = list(pieces(text))
        self.written: list[str] = []
        """The pieces of the result: a long line is not copied for each comment on it."""
        self.kinds: list[Mapping[str, ElementType]] = []
        self.before: Piece | None = None
        """The piece before the next one, without blank text."""
        self.breaks = 0
        """How many line breaks are between the two."""

    def write(self) -> str:
        numbered = enumerate(self.parts)
        for at, piece in numbered:
            text = self.text[piece.start : piece.end]
            breaks = 0
            match piece.kind:
                case "text" if not text.strip():
                    breaks = text.count("\n")
                case "start":
                    for _ in range(self.start(piece, at)):
                        next(numbered)
                case "end":
                    self.end(piece)
                case "comment":
                    self.comment(piece)
                case "other" if text.startswith("<?"):
                    self.line(text)
                    self.before = piece
                case _:
                    raise UnusualXml("a text between elements, a CDATA section or a `<!DOCTYPE>`", piece.start)
            self.breaks = breaks
        return "".join([*self.written, "\n"])

    def line(self, text: str, blank: bool = False) -> None:
        is_first = self.before is None or (self.before.kind == "start" and not self.before.closed)
        if self.written:
            self.written.append("\n")
        if self.written and not is_first and (blank or self.breaks > 1):
            self.written.append("\n")
        self.written.append("  " * len(self.kinds) + text)

    def start(self, piece: Piece, at: int) -> int:
        """Write a start tag, and the rest of its element if it has no children. Return the number of pieces."""
        inner = self._next_tag(at)
        is_leaf = not piece.closed and inner < len(self.parts) and self.parts[inner].kind == "end"
        content = self.text[piece.end : self.parts[inner].start] if is_leaf else ""
        is_empty = not content.strip()
        piece = piece._replace(closed=piece.closed or (is_leaf and is_empty))
        around = self.kinds[-1] if self.kinds else {"mujoco": GRAMMAR.root}
        kind = around.get(piece.tag)
        self.line(self.tag(piece, kind), blank=self._begins_section(piece))
        self.before = piece
        if not is_empty:
            self.written.append(f"{content}</{piece.tag}>")
            self.before = self.parts[inner]
        elif piece.tag == "mujocoinclude" and not self.kinds and not piece.closed:
            self.kinds.append(place_of_fragment(outermost(self.parts)))
        elif not piece.closed:
            self.kinds.append({} if kind is None else kind.children)
        return inner - at if is_leaf else 0

    def _next_tag(self, at: int) -> int:
        """Return the number of the next piece that is not text; the number of all pieces if there is none."""
        rest = range(at + 1, len(self.parts))
        return next((number for number in rest if self.parts[number].kind not in ("text", "cdata")), len(self.parts))

    def _begins_section(self, piece: Piece) -> bool:
        """Return whether a tag begins a section below another piece; empty sections of one tag belong together."""
        before = self.before
        if len(self.kinds) != 1 or before is None or before.kind == "comment":
            return False
        is_alike = before.closed and piece.closed and before.tag == piece.tag
        return piece.tag in GRAMMAR.root.children and not is_alike

    def end(self, piece: Piece) -> None:
        self.kinds.pop()
        self.breaks = 0
        self.before = piece
        self.line(f"</{piece.tag}>")

    def comment(self, piece: Piece) -> None:
        text = self.text[piece.start : piece.end]
        # Lines below the first one move with it; MuJoCo copies the first comment in the root, if it saves a model.
        if self.breaks and len(self.kinds) > 1:
            line = self.text.rfind("\n", 0, piece.start) + 1
            indent = self.text[line : piece.start]
            text = re.sub(rf"\n{indent}(?!\n)", f"\n{'  ' * len(self.kinds)}", text)
        if self.written and not self.breaks:
            self.written.append(f" {text}")
            return
        is_section = len(self.kinds) == 1 and self.before is not None and self.before.kind != "comment"
        self.line(text, blank=is_section and _LEADS.match(self.text, piece.end) is not None)
        self.before = piece

    def tag(self, piece: Piece, kind: ElementType | None) -> str:
        if not piece.complete:
            raise UnusualXml(f"the tag `<{piece.tag}` has no end", piece.start)
        order = {} if kind is None else attribute_order(kind)
        indent = "  " * len(self.kinds)
        text = f"<{piece.tag}"
        width = len(indent) + 1 + len(piece.tag)
        several = False
        for at, each in enumerate(sorted(piece.attributes, key=lambda each: order.get(each.name, len(order)))):
            shown = f"{each.name}={self.quoted(each)}"
            if at and (several or "\n" in shown or width + 1 + len(shown) > WIDTH):
                text = f"{text}\n{indent}  {shown}"
                width = len(indent) + 2 + len(shown)
            else:
                text = f"{text} {shown}"
                width = width + 1 + len(shown)
            several = "\n" in shown
        return text + ("/>" if piece.closed else ">")

    def quoted(self, written: WrittenAttribute) -> str:
        if written.value is None:
            raise UnusualXml(f"the attribute `{written.name}` has no value", written.at)
        quote = '"' if '"' not in written.value else "'"
        return f"{quote}{written.value}{quote}"


def format_mjcf(source: bytes, file: str, sink: Sink) -> bytes | None:
    """Return the file in its canonical layout, or None if it is not MJCF or would lose something.

    Attributes are sorted, and sections are separated by blank lines. Comments, the text of values, a byte order mark
    and the line breaks (as in the first line) are kept. The result is parsed again and compared. No I/O.
    """
    tree = parse_xml(source, file, sink)
    if tree is None:
        return None
    mark = "\ufeff" if source.startswith(b"\xef\xbb\xbf") else ""
    text = source.decode("utf-8", "surrogateescape").removeprefix(mark)
    end = "\r\n" if text.partition("\n")[0].endswith("\r") else "\n"
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if root_of(text) is None:
        message = f"`{file}` is not MJCF: its root is `<{tree.tag}>`, not `<mujoco>` or `<mujocoinclude>`"
        sink.error("not-mjcf", message, Span(file, 1, 1))
        return None
    try:
        result = _Layout(text).write()
    except UnusualXml as unusual:
        line = text.count("\n", 0, unusual.at) + 1
        column = unusual.at - text.rfind("\n", 0, unusual.at)
        message = f"`{file}` is left unchanged: {unusual} has no place in the layout"
        help = "remove it, or write it as a comment: `<!-- … -->`"
        sink.error("cannot-format", message, Span(file, line, column), help=help)
        return None
    data = (mark + result.replace("\n", end)).encode("utf-8", "surrogateescape")
    again = parse_xml(data, file, Sink())
    if again is None or list(_content(tree)) != list(_content(again)):
        message = f"`{file}` is left unchanged: the canonical layout would change its meaning"
        notes = () if again is not None else (Note("it could not be read again"),)
        help = "please report it: this is a bug of `mjcompose fmt`, not of the model"
        sink.error("cannot-format", message, Span(file, 1, 1), notes=notes, help=help)
        return None
    return data


def _content(root: Node) -> Iterator[tuple[object, ...]]:
    """Yield the content of a file: elements with depth, attributes and text, and comments without indents."""
    yield from (_words(each) for each in reversed(list(root.itersiblings(preceding=True))))
    for node in root.iter():
        depth = sum(1 for _ in node.iterancestors())
        attributes = sorted(node.items()) if isinstance(node.tag, str) else []
        yield node.tag, depth, *attributes, _words(node), (node.tail or "").split()
    yield from (_words(each) for each in root.itersiblings())


def _words(node: Node) -> tuple[object, ...]:
    text = str(node.text or "")
    return (text,) if isinstance(node.tag, str) and text.strip() else tuple(text.split())

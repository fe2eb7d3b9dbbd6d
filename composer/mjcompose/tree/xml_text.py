"""XML as written, piece by piece, with start tags by their last line, which lxml keeps, and trees as text."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping
from html import unescape
from itertools import accumulate
from pathlib import PurePath
from typing import Literal, NamedTuple, TypeAlias

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.files import MJCF_FILES, RECIPES

_PIECE = re.compile(
    r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<![A-Za-z][^>]*>?|</[^<>]*>?|<(?:[A-Za-z_][^\s<>/!?\"'=]*)?|[^<]+",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"""\s*([^\s=<>/"']+)(?:\s*=\s*(?:"([^"<]*)"?|'([^'<]*)'?)?)?""")
_BLANK = re.compile(r"\s*")
_TAG_END = re.compile(r"\s*(/?)>")
_BEFORE_ROOT = r"\s*(?:(?:<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>]*>)\s*)*"
_ROOT = re.compile(rf"\ufeff?{_BEFORE_ROOT}<(mujoco|mujocoinclude)(?=[\s/>]|\Z)", re.DOTALL)
_RECIPE = re.compile(r"^(?:recipe|extends)\s*:", re.MULTILINE)

Kind = Literal["start", "end", "comment", "cdata", "other", "text"]


class WrittenAttribute(NamedTuple):
    """An attribute of a start tag; `start` and `end` enclose its value, which is None without a quote."""

    name: str
    at: int
    value: str | None
    start: int
    end: int


class Piece(NamedTuple):
    """A piece of a text: a tag, a comment, or the text up to the next tag.

    A start tag is `closed` if it ends in `/>`, and `complete` if it has its `>` at all.
    """

    kind: Kind
    start: int
    end: int
    tag: str = ""
    attributes: tuple[WrittenAttribute, ...] = ()
    closed: bool = False
    complete: bool = True


_KINDS: dict[str, Kind] = {
    "<!--": "comment",
    "<![CDATA[": "cdata",
    "<?": "other",
    "<!": "other",
    "</": "end",
    "<": "start",
}


def pieces(text: str) -> Iterator[Piece]:
    """Yield the pieces of a text, which together are the whole text.

    >>> [(each.kind, each.tag) for each in pieces("<body><geom size='1'/></body>")]
    [('start', 'body'), ('start', 'geom'), ('end', 'body')]
    """
    at = 0
    while match := _PIECE.match(text, at):
        whole = match.group()
        kind: Kind = next((kind for mark, kind in _KINDS.items() if whole.startswith(mark)), "text")
        if kind == "start":
            piece = start_tag(text, at, whole[1:])
        else:
            tag = whole[2:].rstrip(">").strip() if kind == "end" else ""
            piece = Piece(kind, at, match.end(), tag=tag)
        yield piece
        at = piece.end


def start_tag(text: str, start: int, tag: str) -> Piece:
    """Return the start tag of an element that begins at a character."""
    attributes = []
    at = start + 1 + len(tag)
    while match := _ATTRIBUTE.match(text, at):
        at = match.end()
        group = next((quotes for quotes in (2, 3) if match[quotes] is not None), None)
        value, (begin, end) = (None, (at, at)) if group is None else (match[group], match.span(group))
        attributes.append(WrittenAttribute(match[1], match.start(1), value, start=begin, end=end))
    closing = _TAG_END.match(text, at)
    if closing is not None:
        return Piece("start", start, closing.end(), tag=tag, attributes=tuple(attributes), closed=bool(closing[1]))
    return Piece("start", start, _BLANK.match(text, at).end(), tag=tag, attributes=tuple(attributes), complete=False)  # type: ignore[union-attr]


def root_of(text: str) -> str | None:
    """Return the root of an MJCF text, `mujoco` or `mujocoinclude`, or None for any other text.

    >>> root_of("<!-- An arm. --><mujoco model='arm'>"), root_of("<robot name='arm'/>")
    ('mujoco', None)
    """
    found = _ROOT.match(text)
    return None if found is None else found[1]


def kind_of(path: PurePath, text: str) -> Literal["recipe", "model", ""]:
    """Return whether a file is a recipe or MJCF; empty for any other file.

    >>> kind_of(PurePath("a.xml"), "<mujoco/>"), kind_of(PurePath("a.yaml"), "name: me")
    ('model', '')
    """
    suffix = path.suffix.lower()
    if suffix in RECIPES and (_RECIPE.search(text) or path.stem.endswith(".recipe")):
        return "recipe"
    return "model" if suffix in MJCF_FILES and root_of(text) is not None else ""


_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_NOT_BREAK = re.compile(r"[^\n]")
_ITEM = re.compile(r"\S+")
_MOST_COMPARED = 500_000
"""The maximum number of start tags compared for one text: one line may have many elements, all with faults."""


class Stretch(NamedTuple):
    """Characters of one line: line and column from 1, the end exclusive."""

    line: int
    column: int
    end_column: int


_Exact: TypeAlias = dict[frozenset[tuple[str, str]], Piece]


class SourceText:
    """The text of an XML file, for finding where its elements are written. No I/O."""

    def __init__(self, data: bytes | str) -> None:
        text = data
        if isinstance(text, bytes):
            is_wide = text.startswith((b"\xff\xfe", b"\xfe\xff"))
            text = text.decode("utf-16" if is_wide else "utf-8-sig", "replace")
        self._text = text.replace("\r\n", "\n").replace("\r", "\n")
        # Text in a comment is not an element, even if it looks like one.
        self._bare = _COMMENT.sub(lambda comment: _NOT_BREAK.sub(" ", comment.group()), self._text)
        # By tag and line: the start tags that end there, and the first one for each set of attributes.
        self._ending: dict[tuple[str, int], tuple[list[Piece], _Exact]] = {}
        self._compared = 0
        lines = self._text.split("\n")
        self._starts = list(map(sum, enumerate(accumulate(map(len, lines[:-1]), initial=0))))

    @property
    def text(self) -> str:
        """The whole text, with one kind of line end."""
        return self._text

    def element(self, tag: str, line: int, attributes: Mapping[str, str]) -> Stretch | None:
        """Return `<tag` of the element whose start tag ends on `line`, or None if there is none.

        If there are several, it is the one whose attributes are most similar to the given ones, which may have new
        prefixes.
        """
        found = self._find(tag, line, attributes)
        return None if found is None else self._stretch(found.start, found.start + 1 + len(tag))

    def attribute(
        self, tag: str, line: int, attributes: Mapping[str, str], name: str, *, key: bool = False
    ) -> Stretch | None:
        """Return an attribute's value without quotes, or its name with `key`; None if it is not on a single line."""
        written = self._attribute(name, self._find(tag, line, attributes))
        if written is None:
            return None
        start, end = (written.at, written.at + len(name)) if key else (written.start, written.end)
        return self._stretch(start, end) if end > start and "\n" not in self._text[start:end] else None

    def whole(self, tag: str, line: int, attributes: Mapping[str, str]) -> tuple[Stretch, Stretch] | None:
        """Return the ends of an element, of whole lines if it is alone on them; None if it has no end."""
        piece = self._find(tag, line, attributes)
        if piece is None:
            return None
        start = piece.start
        last = piece.end
        depth = 0 if piece.closed else 1
        ends = last
        for tags in re.finditer(rf"""<(/?){re.escape(tag)}(?=[\s/>])(?:"[^"]*"|'[^']*'|[^"'>])*>""", self._bare[ends:]):
            if depth == 0:
                break
            depth += -1 if tags[1] else 0 if tags[0].endswith("/>") else 1
            last = ends + tags.end()
        if depth:
            return None
        before = self._text.rfind("\n", 0, start) + 1
        after = self._text.find("\n", last)
        if after >= 0 and not self._text[before:start].strip() and not self._text[last:after].strip():
            start = before
            last = after + 1
        return self._stretch(start, start + 1), self._stretch(last, last)

    def items(
        self, tag: str, line: int, attributes: Mapping[str, str], name: str, first: int, last: int
    ) -> tuple[Stretch, Stretch, str] | None:
        """Return the positions of two items of an attribute, counted from 0, and the text from one to the other."""
        found = self._attribute(name, self._find(tag, line, attributes))
        items = [] if found is None else [each.span() for each in _ITEM.finditer(self._text, found.start, found.end)]
        if last >= len(items):
            return None
        text = self._text[items[first][0] : items[last][1]]
        return self._stretch(*items[first]), self._stretch(*items[last]), text

    @staticmethod
    def _attribute(name: str, tag: Piece | None) -> WrittenAttribute | None:
        return None if tag is None else next((each for each in tag.attributes if each.name == name), None)

    def _find(self, tag: str, line: int, attributes: Mapping[str, str]) -> Piece | None:
        if not 1 <= line <= len(self._starts):
            return None
        if (tag, line) not in self._ending:
            candidates = self._ending_on(tag, line)
            exact = {frozenset(_values(candidate)): candidate for candidate in reversed(candidates)}
            self._ending[tag, line] = candidates, exact
        candidates, exact = self._ending[tag, line]
        # No other tag is more similar, and a program may write ten thousand elements on one line.
        piece = exact.get(frozenset(attributes.items()))
        if piece is not None:
            return piece
        self._compared += len(candidates)
        if self._compared > _MOST_COMPARED:
            return None
        return max(candidates, key=lambda candidate: self._likeness(candidate, attributes), default=None)

    def _ending_on(self, tag: str, line: int) -> list[Piece]:
        first = self._starts[line - 1]
        last = self._starts[line] if line < len(self._starts) else len(self._text)
        opening = re.compile(rf"<{re.escape(tag)}(?=[\s/>])")
        candidates = []
        at = last
        while (at := self._bare.rfind(f"<{tag}", 0, at)) >= 0:
            if not opening.match(self._bare, at):
                continue
            candidate = start_tag(self._bare, at, tag)
            if candidate.complete and candidate.end <= first:
                break
            if candidate.complete and candidate.end <= last:
                candidates.append(candidate)
        candidates.reverse()
        return candidates

    def _likeness(self, tag: Piece, attributes: Mapping[str, str]) -> int:
        pairs = ((attributes.get(name), text) for name, text in _values(tag))
        return sum(-1 if value is None else 2 if value == text else value.endswith(text) for value, text in pairs)

    def _stretch(self, start: int, end: int) -> Stretch:
        line = bisect_right(self._starts, start)
        first = self._starts[line - 1]
        return Stretch(line, start - first + 1, end - first + 1)


def _values(tag: Piece) -> Iterator[tuple[str, str]]:
    return ((each.name, unescape(each.value or "")) for each in tag.attributes)


_FIRST = re.compile(r"<!\[CDATA\[(.*?)\]\]>", re.DOTALL)


def take_cdata_in(root: Node, data: bytes) -> None:
    """Move the CDATA of each `<text>` without `data` into `data`: the tree does not distinguish it from text."""
    parser = etree.XMLParser(
        remove_blank_text=True,
        resolve_entities=False,
        no_network=True,
        huge_tree=True,
        strip_cdata=False,
        recover=True,
    )
    texts = etree.fromstring(data, parser).iter("text")
    for node, asked in zip(root.iter("text"), texts, strict=False):
        found = _FIRST.search(etree.tostring(asked, encoding="unicode", with_tail=False))
        if found is not None and node.get("data") is None:
            node.set("data", found.group(1))
            node.text = None


def write(root: Node) -> bytes:
    """Return the text of a `<mujoco>` tree: UTF-8, indented by two spaces, one element per line."""
    return to_text(root).encode()  # writing bytes directly is slower in lxml


def to_text(root: Node) -> str:
    """Return the text of a `<mujoco>` tree, not encoded."""
    return etree.tostring(root, encoding="unicode", pretty_print=True)


def as_it_is(node: Node) -> bytes:
    """Return the text of a tree without added space; two trees with the same text have the same meaning."""
    return etree.tostring(node, encoding="utf-8", with_tail=False)

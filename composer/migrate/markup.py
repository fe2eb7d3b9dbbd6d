"""Changes of a tree carried over into the text that it was read from: what is not changed keeps every character."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from html import unescape
from xml.sax.saxutils import quoteattr

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.tree.line import line_of

_PIECE = re.compile(
    r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<!DOCTYPE[^>\[]*(?:\[.*?\])?\s*>"
    r"|<(?P<close>/)?(?P<tag>[^\s<>/!?=]+)(?P<inside>(?:[^<>\"']|\"[^\"]*\"|'[^']*')*)>",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(r"""(\s*)([^\s=<>/"']+)\s*=\s*("[^"]*"|'[^']*')""")
_INDENT = re.compile(r"[ \t]*\Z")
_STEP = "  "


class MarkupError(Exception):
    """The text has another form than the tree that was read from it."""


@dataclass(slots=True)
class _Written:
    """An element as it stands in its text: its start tag, what is behind its content, and its attributes."""

    tag: str
    start: int
    inside: int
    open_end: int
    end: int = 0
    close: int = 0
    values: dict[str, str] = field(default_factory=dict)
    stretches: dict[str, tuple[int, int, int, int, int]] = field(default_factory=dict)

    @property
    def is_empty(self) -> bool:
        return self.close == 0


@dataclass(slots=True)
class Markup:
    """The text of one file and the elements in it, in the order in which they begin."""

    text: str
    elements: list[_Written]

    @classmethod
    def read(cls, text: str) -> Markup:
        """Raises MarkupError where tags do not close one another."""
        found: list[_Written] = []
        open_: list[_Written] = []
        for piece in _PIECE.finditer(text):
            tag = piece["tag"]
            if tag is None:
                continue
            if piece["close"]:
                if not open_ or open_[-1].tag != tag:
                    raise MarkupError(tag)
                element = open_.pop()
                element.close, element.end = piece.start(), piece.end()
                continue
            element = _Written(tag, piece.start(), piece.start("inside"), open_end=piece.end())
            for each in _ATTRIBUTE.finditer(text, piece.start("inside"), piece.end("inside")):
                value = each[3]
                element.values[each[2]] = unescape(value[1:-1])
                element.stretches[each[2]] = (each.start(), *each.span(2), each.start(3), each.end())
            found.append(element)
            if piece["inside"].rstrip().endswith("/"):
                element.end = piece.end()
            else:
                open_.append(element)
        if open_:
            raise MarkupError(open_[-1].tag)
        return cls(text, found)


@dataclass(slots=True)
class Source:
    """A file of a model: its markup, and the nodes of the tree that stand in it (None: an `<include>` or a root)."""

    markup: Markup
    nodes: Sequence[Node | None]

    def rewritten(self, root: Node | None, renamed: Mapping[Node, Mapping[str, str]]) -> str:
        """The text with all that the nodes are now otherwise than they are written.

        `root` is the root of the whole tree where this is its file: what is new in it is written here. `renamed` has
        the attributes of a node that have another name now, by the new one.
        """
        edits: list[tuple[int, int, str]] = []
        text = self.markup.text
        place = {
            node: each
            for node, each in zip(self.nodes, self.markup.elements, strict=True)
            if node is not None
        }
        gone: list[tuple[int, int]] = []
        for node, written in place.items():
            if any(start <= written.start < end for start, end in gone):
                continue
            if root is not None and not _is_below(node, root):
                start, end = _whole_lines(text, written.start, written.end)
                gone.append((start, end))
                edits.append((start, end, ""))
                continue
            edits.extend(_changes(node, written, renamed.get(node, {})))
            edits.extend(_additions(node, written, place, text=text))
        if "\r\n" in text:
            edits = [(start, end, new.replace("\n", "\r\n")) for start, end, new in edits]
        return _applied(text, edits)


def _is_below(node: Node, root: Node) -> bool:
    return node is root or any(above is root for above in node.iterancestors())


def _changes(node: Node, written: _Written, renamed: Mapping[str, str]) -> Iterator[tuple[int, int, str]]:
    now = {str(name): str(value) for name, value in node.items()}
    tag = str(node.tag)
    if tag != written.tag:
        yield written.start + 1, written.start + 1 + len(written.tag), tag
        if not written.is_empty:
            yield written.close + 2, written.close + 2 + len(written.tag), tag
    kept = set()
    for name, value in now.items():
        before = renamed.get(name, name)
        if before in written.values and (before == name or name not in written.values):
            kept.add(before)
            _, key, key_end, at, end = written.stretches[before]
            if before != name:
                yield key, key_end, name
            if value != written.values[before]:
                yield at, end, quoteattr(value)
    for name, (start, _, _, _, end) in written.stretches.items():
        if name not in kept and name not in now:
            yield start, end, ""
    new = "".join(
        f" {name}={quoteattr(value)}"
        for name, value in now.items()
        if name not in written.values and renamed.get(name, name) not in kept
    )
    if new:
        last = max(
            (stretch[4] for stretch in written.stretches.values()),
            default=written.start + 1 + len(written.tag),
        )
        yield last, last, new


def _additions(
    node: Node, written: _Written, place: Mapping[Node, _Written], text: str
) -> Iterator[tuple[int, int, str]]:
    """New children, each on a line of its own: before the next one that stands there, or last."""
    fresh = [child for child in node.iterchildren("*") if child not in place and is_made(child)]
    if not fresh:
        return
    indent = _indent(text, written.start)
    texts: dict[int, str] = {}
    known = [
        place[child].start
        for child in node.iterchildren("*")
        if child in place and _inside(place[child], written)
    ]
    step = "\t" if "\n\t" in text else _STEP
    inner = _indent(text, known[0]) if known and _begins_line(text, known[0]) else indent + step
    for child in fresh:
        following = next((place[each].start for each in child.itersiblings("*") if each in place
                          and _inside(place[each], written)), None)  # fmt: skip
        markup = _markup(child, inner, step)
        if following is not None:
            texts[following] = texts.get(following, "") + f"{markup}\n{inner}"
        else:
            texts[-1] = texts.get(-1, "") + f"\n{inner}{markup}"
    for at, added in texts.items():
        if at >= 0:
            yield at, at, added
        elif written.is_empty:
            slash = text.rindex("/", written.start, written.open_end)
            start = slash - (len(text[:slash]) - len(text[:slash].rstrip()))
            yield start, written.end, f">{added}\n{indent}</{node.tag!s}>"
        else:
            before = text[: written.close].rstrip(" \t\r\n")
            at = max(len(before), written.open_end)
            ends_line = "\n" in text[at : written.close]
            yield at, at, added if ends_line else f"{added}\n{indent}"


def _inside(child: _Written, parent: _Written) -> bool:
    return parent.start < child.start and child.end <= parent.end


def _markup(node: Node, indent: str, step: str) -> str:
    """An element that was made here, its children on lines below it."""
    start = "".join(
        [f"<{node.tag!s}", *(f" {name!s}={quoteattr(str(value))}" for name, value in node.items())]
    )
    children = list(node.iterchildren("*"))
    if not children:
        return f"{start}/>"
    inner = "".join(f"\n{indent}{step}{_markup(each, indent + step, step)}" for each in children)
    return f"{start}>{inner}\n{indent}</" + str(node.tag) + ">"


def _indent(text: str, at: int) -> str:
    line = text[text.rfind("\n", 0, at) + 1 : at]
    return line[: len(line) - len(line.lstrip(" \t"))]


def _begins_line(text: str, at: int) -> bool:
    return not text[text.rfind("\n", 0, at) + 1 : at].strip()


def _whole_lines(text: str, start: int, end: int) -> tuple[int, int]:
    """With the indentation and the line break where nothing else stands on these lines."""
    found = _INDENT.search(text, text.rfind("\n", 0, start) + 1, start)
    after = re.compile(r"[ \t]*\r?\n").match(text, end)
    if found is not None and _begins_line(text, start) and after is not None:
        return found.start(), after.end()
    return start, end


def _applied(text: str, edits: list[tuple[int, int, str]]) -> str:
    result, done = [], 0
    for start, end, new in sorted(edits, key=lambda each: (each[0], each[1])):
        if start < done:
            raise MarkupError(text[start:end])
        result += [text[done:start], new]
        done = end
    return "".join((*result, text[done:]))


def is_made(node: Node) -> bool:
    """Whether an element was made by a migration and is in no file yet."""
    return line_of(node) is None


def made(tag: str, attributes: Mapping[str, str]) -> Node:
    """A new element."""
    return etree.Element(tag, dict(attributes))

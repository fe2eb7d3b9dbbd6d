"""Malformed XML, and XML that MuJoCo ignores, explained to its author.

MuJoCo (3.2 to 4.0) has no schema for the contents of a `<frame>` or a `<replicate>`: it ignores unknown attributes and
misplaced elements there, and refuses them everywhere else. Parts are joined by frames, so a typo that MuJoCo reports
for the source alone would be lost in a composition.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.unit import line_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.tree.unit import Unit

_POINTER = "version https://git-lfs"

HELP = (
    "run `git lfs pull` in its repository; for a `git+` reference, run `mjcompose cache prune --all` and build again,"
    " or name the file of a clone by its path"
)


def is_pointer(content: bytes | str) -> bool:
    """Return whether this is a Git LFS pointer instead of the file. No I/O."""
    return content.startswith(_POINTER) if isinstance(content, str) else content.startswith(_POINTER.encode())


BLIND = ("frame", "replicate")
_HOLDERS = ("body", *BLIND)
"""MuJoCo reads these tag by tag, also below a frame."""


def unread(root: Node, version: str | None = None) -> Iterator[tuple[Node, str | None]]:
    """Yield each element with each of its attributes that MuJoCo ignores; None if it ignores the element itself.

    Without a `version` of MuJoCo, yield faults that any version ignores.

    >>> from lxml import etree
    >>> root = etree.fromstring("<mujoco><worldbody><frame><geom x='1'><y/></geom></frame></worldbody></mujoco>")
    >>> [(node.tag, name) for node, name in unread(root)]
    [('geom', 'x'), ('y', None)]
    """
    if next(root.iter(*BLIND), None) is None:
        return
    for worldbody in root.iterchildren("worldbody"):
        yield from _below(worldbody, GRAMMAR.section("worldbody"), False, version=version)


def _exists(what: ElementType | Attribute, version: str | None) -> bool:
    return what.since is None and what.until is None if version is None else what.exists_in(version)


@cache
def _readable(kind: ElementType, version: str | None) -> frozenset[str]:
    return frozenset(name for name, each in kind.attributes.items() if _exists(each, version))


def _below(parent: Node, kind: ElementType, blind: bool, version: str | None) -> Iterator[tuple[Node, str | None]]:
    stack = [(parent, kind, blind)]
    while stack:
        parent, kind, blind = stack.pop()
        for child in parent.iterchildren("*"):
            child_kind = kind.children.get(str(child.tag))
            is_read = child_kind is not None and _exists(child_kind, version)
            if not is_read and blind and parent.tag not in _HOLDERS:
                yield child, None
            if child_kind is None:
                continue
            unseen = blind or child.tag in BLIND
            if unseen:
                known = _readable(child_kind, version)
                yield from ((child, name) for name in map(str, child.keys()) if name not in known)
            if len(child):
                stack.append((child, child_kind, unseen))


def ignored(element: Node, name: str | None, unit: Unit) -> Diagnostic:
    """Return the warning that an attribute of an element, or (None) the element itself, has no effect."""
    span = unit.origins.span(element, unit.file, name, key=name is not None)
    if name is None:
        parent = element.getparent()
        place = "" if parent is None else f" in `<{parent.tag}>`"
        message = f"MuJoCo ignores `<{element.tag}>`{place}, which means nothing"
        return Diagnostic("unknown-element", message, span, severity=Severity.WARNING, help="remove it")
    kind = GRAMMAR.within("worldbody").get(str(element.tag))
    known = [] if kind is None else list(kind.attributes)
    message = f"MuJoCo ignores `{name}` of `<{element.tag}>`, which means nothing"
    near = None if kind is not None and name in kind.ignored else did_you_mean(name, known)
    notes = (exists_note("attribute", known, name),) if near else ()
    help = near or f"remove `{name}`"
    return Diagnostic("unknown-attribute", message, span, severity=Severity.WARNING, notes=notes, help=help)


def note_unread(unit: Unit) -> None:
    """Remember the faults that MuJoCo ignores in a source by itself, until it is known that they have no effect."""
    unit.origins.unread |= {_place(node, name, unit) for node, name in unread(unit.root)}


def is_unread_alone(element: Node, name: str | None, unit: Unit) -> bool:
    """Return whether MuJoCo also ignores it in the source of the unit."""
    return _place(element, name, unit) in unit.origins.unread


def _place(element: Node, name: str | None, unit: Unit) -> tuple[str, int | None, str | None]:
    owner = unit.origins.owner(element, unit.file)
    return owner if isinstance(owner, str) else "", line_of(element), name


def report(said: str, file: str, line: int, column: int, text: str, sink: Sink) -> None:
    """Report an `xml-syntax` error for lxml's message about `file`, with the tag that the message names by line."""
    if is_pointer(text):
        message = f"`{file}` is not XML: it is a pointer of Git LFS, not the file itself"
        sink.error("xml-syntax", message, Span(file, line, column), help=HELP)
        return
    said = re.sub(r", line \d+, column \d+.*", "", said, flags=re.DOTALL)
    matches = ((re.match(pattern, said), message, help) for pattern, message, help in _KNOWN)
    explained = ((found.expand(message), found.expand(help or "")) for found, message, help in matches if found)
    first = (said.strip().splitlines() or ["it cannot be read"])[0]
    plain = first if first[:2].isupper() else first[:1].lower() + first[1:]
    message, help = next(explained, (plain, ""))
    message = f"`{file}` is not XML: {message}"
    notes = tuple[Note, ...]()
    opened = _OPENED.search(said)
    if opened:
        lines = text.splitlines()
        at = int(opened["line"])
        tag = opened["tag"]
        begin = lines[at - 1].rfind(f"<{tag}") if 0 < at <= len(lines) else -1
        if begin >= 0:
            span = Span(file, at, begin + 1, end_line=at, end_column=begin + 2 + len(tag))
            notes = (Note(f"`<{tag}>` begins here", span),)
    sink.error("xml-syntax", message, Span(file, line, column), notes=notes, help=help or None)


_OPENED = re.compile(
    r"(?:Opening and ending tag mismatch:|Premature end of data in tag|Couldn't find end of Start Tag)"
    r" (?P<tag>\S+) line (?P<line>\d+)"
)


_KNOWN: tuple[tuple[str, str, str | None], ...] = (
    (r"Document is empty", "it is empty", None),
    (r"Start tag expected, '<' not found", "it does not begin with `<`", None),
    (r"Opening and ending tag mismatch: (\S+) line (\d+) and (\S+)", r"`</\3>` closes a tag, but `<\1>` is still open",
     r"end the tag with `/>`, or write `</\1>` first"),
    (r"Premature end of data in tag (\S+)", r"`<\1>` is never closed", r"write `</\1>`"),
    (r"Couldn't find end of Start Tag (\S+)", r"the tag `<\1` has no end",
     "end it with `>`, or with `/>` if it is empty"),
    (r"Unescaped '<' not allowed in attributes values", "the value of an attribute has a `<`",
     "close the quote before it; a real `<` is `&lt;`"),
    (r"AttValue: \" or ' expected", "the value of an attribute has no quotes", 'write `name="value"`'),
    (r"AttValue: ' expected", "the value of an attribute is never closed", "add the closing quote"),
    (r"Specification mandates? value for attribute (\S+)", r"the attribute `\1` has no value", r'write `\1="…"`'),
    (r"Attribute (\S+) redefined", r"the attribute `\1` appears twice in a tag", "keep one of them"),
    (r"xmlParseEntityRef: no name|EntityRef: expecting ';'", "a `&` appears by itself", "write `&amp;`"),
    (r"Entity '(\S+)' not defined", r"the entity `&\1;` is not defined", "write the character itself"),
    (r"Comment not terminated|Comment must not contain", "a comment is never closed", "close it with `-->`"),
    (r"Extra content at the end of the document", "something follows the end of its outermost element", None),
    (r"[Ee]xcessive depth in document: (\d+)", r"elements are nested more than \1 deep", None),
    (r"CData section not finished", "a `<![CDATA[` is never closed", "close it with `]]>`"),
    (r"xmlParseCharRef: invalid|PCDATA invalid Char|[Ii]nvalid character", "it has a character that XML cannot hold",
     "remove the character"),
    (r"[Ee]xpected '>'", "a tag lacks its `>`", None),
    (r"StartTag: invalid element name", "a `<` begins no tag", "a real `<` is `&lt;`"),
    (r"error parsing attribute name", "a tag does not end before the next tag begins", "end it with `>`, or with `/>`"),
    (r"attributes construct error", "two attributes have no space between them", "put a space between"),
    (r"Input is not proper UTF-8|Invalid bytes in character encoding|switching encoding: encoder error",
     "it is not UTF-8 text, and names no other encoding", "save the file as UTF-8"),
)  # fmt: skip
"""Patterns of lxml's messages, with the message and the help that they become."""

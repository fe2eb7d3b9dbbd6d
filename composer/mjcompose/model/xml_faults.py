"""Malformed XML, and XML that MuJoCo ignores, explained to its author.

MuJoCo (3.2 to 4.0) has no schema for the contents of a `<frame>` or a `<replicate>`: it ignores unknown attributes and
misplaced elements there, and refuses them everywhere else. Parts are joined by frames, so a typo that MuJoCo reports
for the source alone would be lost in a composition.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import cache
from typing import TYPE_CHECKING

from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.model.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.model.unit import line_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.model.unit import Unit

_POINTER = "version https://git-lfs"

HELP = (
    "run `git lfs pull` in its repository; of a `git+` reference such files are not fetched:"
    " name the file of a clone by its path"
)


def is_pointer(content: bytes | str) -> bool:
    """Return whether this is a Git LFS pointer instead of the file. No I/O."""
    if isinstance(content, str):
        return content.startswith(_POINTER)
    return content.startswith(_POINTER.encode())


BLIND = ("frame", "replicate")
_HOLDERS = ("body", *BLIND)
"""MuJoCo reads these tag by tag, also below a frame."""


def unread(root: Node, version: str | None = None) -> Iterator[tuple[Node, str | None]]:
    """Yield each element with each of its attributes that MuJoCo ignores; None if it ignores the element itself.

    Without a `version` of MuJoCo, yield what any version ignores.

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
    """Return the attributes that MuJoCo reads."""
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
    return Diagnostic(
        "unknown-attribute", message, span, severity=Severity.WARNING, notes=notes,
        help=near or f"remove `{name}`",
    )  # fmt: skip


def note_unread(unit: Unit) -> None:
    """Remember what MuJoCo ignores in a source by itself, if it is only known later that this has no effect."""
    unit.origins.unread |= {_place(node, name, unit) for node, name in unread(unit.root)}


def is_unread_alone(element: Node, name: str | None, unit: Unit) -> bool:
    """Return whether MuJoCo also ignores it in the source of the unit."""
    return _place(element, name, unit) in unit.origins.unread


def _place(element: Node, name: str | None, unit: Unit) -> tuple[str, int | None, str | None]:
    owner = unit.origins.owner(element, unit.file)
    return owner if isinstance(owner, str) else "", line_of(element), name


_Words = tuple[str, str | None]


def report(said: str, file: str, line: int, column: int, text: str, sink: Sink) -> None:
    """Report an `xml-syntax` error for lxml's message about `file`, with the tag that the message names by line."""
    if is_pointer(text):
        message = f"`{file}` is not XML: it is not the file itself but where Git LFS has it"
        sink.error("xml-syntax", message, Span(file, line, column), help=HELP)
        return
    said = re.sub(r", line \d+, column \d+.*", "", said, flags=re.DOTALL)
    message, help = next((make(found) for pattern, make in _KNOWN if (found := pattern.match(said))), _plain(said))
    notes: tuple[Note, ...] = ()
    if opened := _OPENED.search(said):
        lines = text.splitlines()
        at, tag = int(opened["line"]), opened["tag"]
        begin = lines[at - 1].rfind(f"<{tag}") if 0 < at <= len(lines) else -1
        if begin >= 0:
            span = Span(file, at, begin + 1, end_line=at, end_column=begin + 2 + len(tag))
            notes = (Note(f"`<{tag}>` begins here", span),)
    sink.error("xml-syntax", f"`{file}` is not XML: {message}", Span(file, line, column), notes=notes, help=help)


_OPENED = re.compile(r"(?:Opening and ending tag mismatch:|Premature end of data in tag|Couldn't find end of Start Tag)"
                     r" (?P<tag>\S+) line (?P<line>\d+)")  # fmt: skip


def _words(message: str, help: str | None = None) -> Callable[[re.Match[str]], _Words]:
    return lambda found: (found.expand(message), found.expand(help) if help else None)


def _plain(said: str) -> _Words:
    first = (said.strip().splitlines() or ["it cannot be read"])[0]
    return (first[:1].lower() + first[1:] if not first[:2].isupper() else first, None)


_KNOWN: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], _Words]], ...] = tuple(
    (re.compile(pattern), words)
    for pattern, words in (
        (r"Document is empty", _words("it is empty")),
        (r"Start tag expected, '<' not found", _words("it does not begin with `<`")),
        (
            r"Opening and ending tag mismatch: (\S+) line (\d+) and (\S+)",
            _words(r"`</\3>` stands where `<\1>` is still open", r"end the tag with `/>`, or write `</\1>` first"),
        ),
        (r"Premature end of data in tag (\S+)", _words(r"`<\1>` is never closed", r"write `</\1>`")),
        (
            r"Couldn't find end of Start Tag (\S+)",
            _words(r"the tag `<\1` has no end", "end it with `>`, or with `/>` if nothing stands in it"),
        ),
        (
            r"Unescaped '<' not allowed in attributes values",
            _words("a `<` stands in the value of an attribute", "close the quote before it; a real `<` is `&lt;`"),
        ),
        (r"AttValue: \" or ' expected", _words("the value of an attribute has no quotes", 'write `name="value"`')),
        (r"AttValue: ' expected", _words("the value of an attribute is never closed", "add the closing quote")),
        (
            r"Specification mandates? value for attribute (\S+)",
            _words(r"the attribute `\1` has no value", r'write `\1="…"`'),
        ),
        (r"Attribute (\S+) redefined", _words(r"the attribute `\1` is written twice in one tag", "keep one of them")),
        (r"xmlParseEntityRef: no name|EntityRef: expecting ';'", _words("a `&` stands by itself", "write `&amp;`")),
        (r"Entity '(\S+)' not defined", _words(r"nothing is known of `&\1;`", "write the character itself")),
        (
            r"Comment not terminated|Comment must not contain",
            _words("a comment is never closed", "close it with `-->`"),
        ),
        (
            r"Extra content at the end of the document",
            _words("something stands after the end of its one outermost element"),
        ),
        (r"[Ee]xcessive depth in document: (\d+)", _words(r"elements stand more than \1 deep inside one another")),
        (r"CData section not finished", _words("a `<![CDATA[` is never closed", "close it with `]]>`")),
        (
            r"xmlParseCharRef: invalid|PCDATA invalid Char|[Ii]nvalid character",
            _words("a character stands there that XML cannot hold", "take it out"),
        ),
        (r"[Ee]xpected '>'", _words("a tag lacks its `>`")),
        (r"StartTag: invalid element name", _words("a `<` begins no tag", "a real `<` is `&lt;`")),
        (
            r"error parsing attribute name",
            _words("a tag is not ended before the next one begins", "end it with `>`, or with `/>`"),
        ),
        (r"attributes construct error", _words("attributes are not parted from one another", "put a space between")),
        (
            r"Input is not proper UTF-8|Invalid bytes in character encoding|switching encoding: encoder error",
            _words("it is not UTF-8 text, and does not say what else", "save the file as UTF-8"),
        ),
    )
)

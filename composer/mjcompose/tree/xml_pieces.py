"""XML as written, piece by piece, even if it is half-written."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import PurePath
from typing import Literal, NamedTuple

from mjcompose.base.files import MJCF_FILES, RECIPES

"""The ends of the names of MJCF files."""
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


class Written(NamedTuple):
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
    attributes: tuple[Written, ...] = ()
    closed: bool = False
    complete: bool = True


_KINDS: tuple[tuple[str, Kind], ...] = (
    ("<!--", "comment"), ("<![CDATA[", "cdata"), ("<?", "other"), ("<!", "other"), ("</", "end"), ("<", "start"),
)  # fmt: skip


def pieces(text: str) -> Iterator[Piece]:
    """Yield the pieces of a text, which together are the whole text.

    >>> [(each.kind, each.tag) for each in pieces("<body><geom size='1'/></body>")]
    [('start', 'body'), ('start', 'geom'), ('end', 'body')]
    """
    at = 0
    while found := _PIECE.match(text, at):
        whole = found.group()
        kind: Kind = next((kind for mark, kind in _KINDS if whole.startswith(mark)), "text")
        if kind == "start":
            yield (piece := start_tag(text, at, whole[1:]))
            at = piece.end
            continue
        yield Piece(kind, at, found.end(), tag=whole[2:].rstrip(">").strip() if kind == "end" else "")
        at = found.end()


def start_tag(text: str, start: int, tag: str) -> Piece:
    """Return the start tag of an element that begins at a character."""
    attributes, at = [], start + 1 + len(tag)
    while found := _ATTRIBUTE.match(text, at):
        at = found.end()
        group = next((each for each in (2, 3) if found[each] is not None), None)
        value, (begin, end) = (None, (at, at)) if group is None else (found[group], found.span(group))
        attributes.append(Written(found[1], found.start(1), value, start=begin, end=end))
    if (closing := _TAG_END.match(text, at)) is not None:
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

"""The layout of a YAML text as data, and the order of its keys."""

from __future__ import annotations

import json
from dataclasses import field
from pathlib import Path as File

from mjcompose.base.dataclass import Struct
from mjcompose.text.load import Comment
from mjcompose.text.merge import in_own_model


class Leaf(Struct, frozen=False):
    """A scalar or an alias as written; `properties` are its anchor and tag."""

    text: str
    properties: str = ""
    depth: int = 0  # for a block scalar, the column where its content begins
    ended: bool = True  # for a block scalar, whether a line break follows


class TextEntry(Struct, frozen=False):
    """A key and its value, or an item of a list (`key` is None). `column`, from 0, is its place in the text."""

    column: int
    key: Leaf | None = None
    value: Leaf | Collection | None = None
    lead: list[Comment] = field(default_factory=list)  # comments on their own lines before it
    blank: bool = False  # whether an empty line precedes it and its comments
    head: Comment | None = None  # the comment on the line of a key whose value begins below
    inner: list[Comment] = field(default_factory=list)
    """Comments on their own lines between the key and a value that is not a block."""
    trail: Comment | None = None  # the comment after it, on the same line
    breaks: bool = False  # in brackets, whether it begins a line
    pinned: bool = False  # whether it has an anchor or an alias, which must keep their order

    @property
    def parted(self) -> bool:
        return self.lead[0].blank_before if self.lead else self.blank

    @parted.setter
    def parted(self, value: bool) -> None:
        if self.lead:
            self.lead[0].blank_before = value
        else:
            self.blank = value


class Collection(Struct, frozen=False):
    """A mapping or a list, in lines or (`flow`) in brackets; `broken` brackets span several lines."""

    mapping: bool
    flow: bool
    properties: str = ""
    entries: list[TextEntry] = field(default_factory=list)
    opening: Comment | None = None  # the comment after the opening bracket
    tail: list[Comment] = field(default_factory=list)  # comments on their own lines after the last entry
    broken: bool = False


class Document(Struct, frozen=False):
    """A whole text. `preface` are the lines up to `---`, if there is one."""

    preface: list[str]
    header: list[Comment]  # comments before the first key that are about the file
    parted: bool  # whether an empty line follows the header
    head: Comment | None
    root: Collection
    tail: list[Comment]


Path = tuple[str, ...]

FOR = "for"
"""A key that may be in every entry. It comes first: it declares the names that the other keys use."""
# Written by `composer/mjcompose/language/reference_page.py`.
_TABLES = json.loads(File(__file__).with_name("key_order.json").read_text(encoding="utf-8"))


def _by_path(table: dict[str, list[str]]) -> dict[Path, tuple[str, ...]]:
    return {tuple(path.split(".")) if path else (): tuple(keys) for path, keys in table.items()}


# Mappings in which all keys have a place. An unknown key stays after its predecessor.
WHOLE = _by_path(_TABLES["whole"])
# Mappings in which some keys come first; the others keep their order.
FIRST = _by_path(_TABLES["first"])


def is_free(path: Path) -> bool:
    """Return whether the order of the keys in the mapping at `path` has no meaning. Indices of lists are `*`.

    >>> is_free(("attach",)), is_free(("attach", "arm")), is_free(("variants", "hand", "left", "attach", "arm"))
    (False, True, True)
    """
    return _table(path)[0] != ()


def put_in_order(node: Collection, path: Path = ()) -> None:
    """Sort the keys in place, with their comments, but not below an anchor: the order may matter at its alias."""
    if "&" in node.properties:
        return
    if node.mapping:
        _sort(node, path)
    for entry in node.entries:
        if isinstance(entry.value, Collection):
            put_in_order(entry.value, (*path, _name(entry)))


def _sort(node: Collection, path: Path) -> None:
    order, whole = _table(path)
    if not order:
        return
    rank = {name: index for index, name in enumerate(order)} | {FOR: -1}
    ranks: list[int] = []
    for entry in node.entries:
        ranks.append(rank.get(_name(entry), (ranks[-1] if ranks else -1) if whole else len(order)))
    before = node.entries
    after = [before[index] for index in sorted(range(len(before)), key=lambda index: (ranks[index], index))]
    if after == before or [e for e in before if e.pinned] != [e for e in after if e.pinned]:
        return
    if node.flow:
        for entry, breaks in zip(after, [entry.breaks for entry in before], strict=True):
            entry.breaks = breaks
    else:
        after[0].parted, before[0].parted = before[0].parted, after[0].parted
    node.entries = after


def _name(entry: TextEntry) -> str:
    return "*" if entry.key is None else entry.key.text.strip("\"'")


def _table(path: Path) -> tuple[tuple[str, ...], bool]:
    if path[:1] == ("variants",):
        path = path[3:] if len(path) >= 3 else ("",)
    path = tuple(map(str, in_own_model(path)))
    for table in (WHOLE, FIRST):
        for known, order in table.items():
            if len(path) == len(known) and all(a in ("*", b) for a, b in zip(known, path, strict=True)):
                return order, table is WHOLE
    return (), False

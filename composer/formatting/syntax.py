"""The layout of a YAML text: values as written, comments and blank lines with their entries."""

from __future__ import annotations

from dataclasses import field

from composer.dataclass import dataclass
from composer.document.tokens import Comment


@dataclass(slots=True)
class Leaf:
    """A scalar or an alias as written; `properties` are its anchor and tag."""

    text: str
    properties: str = ""
    depth: int = 0
    """For a block scalar, the column where its content begins."""
    ended: bool = True
    """For a block scalar, whether a line break follows."""


@dataclass(slots=True)
class Entry:
    """A key and its value, or an item of a list (`key` is None).

    `column`, from 0, is where it begins in the original text.
    """

    column: int
    key: Leaf | None = None
    value: Leaf | Collection | None = None
    lead: list[Comment] = field(default_factory=list)
    """Comments on their own lines before it."""
    blank: bool = False
    """Whether an empty line precedes it and its comments."""
    head: Comment | None = None
    """The comment on the line of a key whose value begins below."""
    inner: list[Comment] = field(default_factory=list)
    """Comments on their own lines between the key and a value that is not a block."""
    trail: Comment | None = None
    """The comment after it, on the same line."""
    breaks: bool = False
    """In brackets, whether it begins a line."""
    pinned: bool = False
    """Whether it has an anchor or an alias, which must keep their order."""

    @property
    def parted(self) -> bool:
        """Whether an empty line precedes it and its comments."""
        return self.lead[0].blank_before if self.lead else self.blank

    @parted.setter
    def parted(self, value: bool) -> None:
        if self.lead:
            self.lead[0].blank_before = value
        else:
            self.blank = value


@dataclass(slots=True)
class Collection:
    """A mapping or a list, in lines or (`flow`) in brackets; `broken` brackets span several lines."""

    mapping: bool
    flow: bool
    properties: str = ""
    entries: list[Entry] = field(default_factory=list)
    opening: Comment | None = None
    """The comment after the opening bracket."""
    tail: list[Comment] = field(default_factory=list)
    """Comments on their own lines after the last entry."""
    broken: bool = False


@dataclass(slots=True)
class Document:
    """A whole text. `preface` are the lines up to `---`, if there is one."""

    preface: list[str]
    header: list[Comment]
    """Comments before the first key that are about the file."""
    parted: bool
    """Whether an empty line follows the header."""
    head: Comment | None
    root: Collection
    tail: list[Comment]

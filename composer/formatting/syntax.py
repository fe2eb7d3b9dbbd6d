"""A YAML text as it is laid out: values as they are written, comments and blank lines where they belong."""

from __future__ import annotations

from dataclasses import dataclass, field

from composer.document.tokens import Comment


@dataclass(slots=True)
class Leaf:
    """A scalar or an alias as it is written; `properties` are its anchor and tag."""

    text: str
    properties: str = ""
    depth: int = 0
    """Of a block scalar: the column from which its lines are its content."""
    ended: bool = True
    """Of a block scalar: whether a line break follows."""


@dataclass(slots=True)
class Entry:
    """A key and its value, or an item of a list (`key` is None).

    `column`, from 0, is where it begins in the text that was read.
    """

    column: int
    key: Leaf | None = None
    value: Leaf | Collection | None = None
    lead: list[Comment] = field(default_factory=list)
    """Comments on lines of their own before it."""
    blank: bool = False
    """Whether an empty line stands between it and what is before it, its own comments included."""
    head: Comment | None = None
    """What stands on the line of the key whose value begins below."""
    inner: list[Comment] = field(default_factory=list)
    """Comments on lines of their own between the key and a value that is not a block."""
    trail: Comment | None = None
    """The comment behind it."""
    breaks: bool = False
    """In brackets: whether it begins a line."""
    pinned: bool = False
    """Whether it has an anchor or an alias, which must keep their order."""

    @property
    def parted(self) -> bool:
        """Whether an empty line stands before it and its comments."""
        return self.lead[0].blank_before if self.lead else self.blank

    @parted.setter
    def parted(self, value: bool) -> None:
        if self.lead:
            self.lead[0].blank_before = value
        else:
            self.blank = value


@dataclass(slots=True)
class Collection:
    """A mapping or a list, in lines or (`flow`) in brackets; `broken` brackets stand on several lines."""

    mapping: bool
    flow: bool
    properties: str = ""
    entries: list[Entry] = field(default_factory=list)
    opening: Comment | None = None
    """The comment behind the opening bracket."""
    tail: list[Comment] = field(default_factory=list)
    """Comments on lines of their own behind the last entry."""
    broken: bool = False


@dataclass(slots=True)
class Document:
    """A whole text. `preface` are the lines up to `---`, if that exists."""

    preface: list[str]
    header: list[Comment]
    """Comments before the first key that are about the file."""
    parted: bool
    """Whether an empty line stands below the header."""
    head: Comment | None
    root: Collection
    tail: list[Comment]

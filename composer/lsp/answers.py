"""The answers of providers: plain data whose places are spans. Only `protocol` converts them to messages."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Change:
    """A replacement of a stretch of text. With an empty span, the text is inserted there."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Item:
    """One completion. Items with a smaller `rank` come first; `doc` is Markdown.

    `insert` replaces the word, if it is not the label itself. With `again`, the editor asks for completions again
    right after it has inserted the item.
    """

    label: str
    kind: str
    detail: str = ""
    doc: str = ""
    rank: float = 50
    insert: str = ""
    again: bool = False


@dataclass(frozen=True, slots=True)
class Hover:
    """Markdown about what is at a place."""

    text: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Action:
    """A change that is offered for a diagnostic or a place. `is_preferred` marks the most likely one."""

    title: str
    changes: tuple[Change, ...]
    diagnostic: Diagnostic | None = None
    is_preferred: bool = False
    kind: str = "quickfix"


@dataclass(frozen=True, slots=True)
class Symbol:
    """An entry of the outline."""

    name: str
    kind: str
    span: Span
    whole: Span
    detail: str = ""
    children: tuple[Symbol, ...] = ()


@dataclass(frozen=True, slots=True)
class Hint:
    """Text that an editor shows after a place, as if it were written there."""

    span: Span
    text: str
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Lens:
    """A command that is shown above a line; `arguments` are passed to it."""

    span: Span
    title: str
    command: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Fold:
    """A range of lines that can be folded, counted from 0."""

    first: int
    last: int
    kind: str = "region"


@dataclass(frozen=True, slots=True)
class Rename:
    """All changes that a new name needs, or the reason why it is refused."""

    changes: tuple[Change, ...] = ()
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class Completion:
    """The completions at a place, and the stretch of the line that they replace."""

    items: tuple[Item, ...] = ()
    span: Span | None = None

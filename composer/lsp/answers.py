"""What providers answer: plain data with places as spans. Only `protocol` makes messages of it."""

from __future__ import annotations

from dataclasses import dataclass

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span


@dataclass(frozen=True, slots=True)
class Change:
    """Text in place of a stretch; a span that is empty is a place to insert at."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Item:
    """Something to write. `rank` sorts what is offered, the smallest first; `doc` is Markdown.

    `insert` is what is written in place of the word, where that is not the label. `again` asks the editor to complete
    at once what comes behind it.
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
    """Markdown about what stands at a place."""

    text: str
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Action:
    """A change that is offered for a diagnostic, or for a place; `is_preferred` where it is most likely meant."""

    title: str
    changes: tuple[Change, ...]
    diagnostic: Diagnostic | None = None
    is_preferred: bool = False
    kind: str = "quickfix"


@dataclass(frozen=True, slots=True)
class Symbol:
    """A line of the outline."""

    name: str
    kind: str
    span: Span
    whole: Span
    detail: str = ""
    children: tuple[Symbol, ...] = ()


@dataclass(frozen=True, slots=True)
class Hint:
    """Text that is shown behind a place, as if it were written there."""

    span: Span
    text: str
    doc: str = ""


@dataclass(frozen=True, slots=True)
class Lens:
    """A command above a line; `arguments` go with it."""

    span: Span
    title: str
    command: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Fold:
    """Lines that can be folded away, from 0."""

    first: int
    last: int
    kind: str = "region"


@dataclass(frozen=True, slots=True)
class Rename:
    """All that follows from a new name, or why it cannot be."""

    changes: tuple[Change, ...] = ()
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class Completion:
    """What is offered at a place, and the stretch of the line that it replaces."""

    items: tuple[Item, ...] = ()
    span: Span | None = None

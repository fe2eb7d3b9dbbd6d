"""Changes of the elements of a model, recorded with their reasons while somebody asks for a record.

Every change of a model during composition goes through these functions, so the record is complete: `explain` reads it
and compares nothing. An element may be built freely until it is placed in a tree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Span

TAG = "<tag>"
PARENT = "<parent>"
SOURCE = "<source>"


class Because(NamedTuple):
    """The reason for a change in words, and its place. Without words, the value is written at the place."""

    words: str = ""
    span: Span | None = None


Why = Callable[[], Because | None]
"""Returns a reason. It is called only when somebody asks. None: the reason of the pass or step itself."""


def because(words: str, place: Span | Callable[[], Span | None] | None = None) -> Why:
    """Return a reason whose words are known already; its place may be a function, called only when somebody asks."""
    return lambda: Because(words, place() if callable(place) else place)


class TreeChange(NamedTuple):
    """A change of an attribute of an element, of its `TAG` or its `PARENT`; or a `SOURCE` that it replaces."""

    node: Node
    what: str
    before: str | Node | None
    after: str | Node | None
    why: Why | None = None


_RECORD: ContextVar[list[TreeChange] | None] = ContextVar("mjcompose.tree.journal", default=None)
_record = _RECORD.get
_REASON: ContextVar[Why | None] = ContextVar("mjcompose.tree.journal.reason", default=None)


@contextmanager
def recording(record: list[TreeChange] | None) -> Iterator[None]:
    """Append the changes in the block to the list; None records nothing."""
    token = _RECORD.set(record)
    try:
        yield
    finally:
        _RECORD.reset(token)


def is_recording(record: list[TreeChange]) -> bool:
    """Return whether changes are appended to this list now."""
    return _record() is record


@contextmanager
def explained(why: Why | None) -> Iterator[None]:
    """Give this reason to the changes in the block that have none of their own."""
    token = _REASON.set(why)
    try:
        yield
    finally:
        _REASON.reset(token)


def unrecorded() -> AbstractContextManager[None]:
    """Record nothing in the block, which must leave the model as it was."""
    return recording(None)


def _append(
    record: list[TreeChange],
    node: Node,
    what: str,
    before: str | Node | None,
    after: str | Node | None,
    why: Why | None,
) -> None:
    record.append(TreeChange(node, what, before, after, why or _REASON.get()))


def write(node: Node, name: str, text: str, why: Why | None = None) -> None:
    """Write an attribute of an element."""
    if (record := _record()) is not None:
        _append(record, node, name, node.get(name), text, why)
    node.set(name, text)


def write_all(node: Node, texts: Mapping[str, str], why: Why | None = None) -> None:
    """Write several attributes of an element. Its other attributes stay."""
    for name, text in texts.items():
        write(node, name, text, why)


def drop(node: Node, name: str, why: Why | None = None) -> str | None:
    """Remove an attribute if the element has it, and return its text."""
    text = node.get(name)
    if text is None:
        return None
    if (record := _record()) is not None:
        _append(record, node, name, text, None, why)
    del node.attrib[name]
    return text


def drop_all(node: Node, why: Why | None = None) -> None:
    """Remove every attribute of an element."""
    for name in list(map(str, node.keys())):
        drop(node, name, why)


def retag(node: Node, tag: str, why: Why | None = None) -> None:
    """Make an element one of another kind."""
    if (record := _record()) is not None:
        _append(record, node, TAG, str(node.tag), tag, why)
    node.tag = tag


def place(holder: Node, node: Node, at: int | None = None, why: Why | None = None) -> None:
    """Put an element, new or from elsewhere, into a holder: at the end, or before its child number `at`."""
    if (record := _record()) is not None:
        _append(record, node, PARENT, node.getparent(), holder, why)
    if at is None:
        holder.append(node)
    else:
        holder.insert(at, node)


def place_all(holder: Node, nodes: Iterable[Node], why: Why | None = None) -> None:
    """Put elements at the end of a holder, in their order."""
    for node in list(nodes):
        place(holder, node, why=why)


def exchange(old: Node, new: Node, why: Why | None = None) -> None:
    """Put an element where another one is, which leaves the tree. The new one may still be elsewhere in it."""
    holder = old.getparent()
    assert holder is not None
    if (record := _record()) is not None:
        _append(record, new, PARENT, new.getparent(), holder, why)
        _append(record, old, PARENT, holder, None, why)
    holder.replace(old, new)


def remove(node: Node, why: Why | None = None) -> None:
    """Remove an element from its tree if it is in one."""
    if (holder := node.getparent()) is not None:
        if (record := _record()) is not None:
            _append(record, node, PARENT, holder, None, why)
        holder.remove(node)


def note_source(node: Node, source: Node, why: Why | None = None) -> None:
    """Record that a new element replaces or copies another element, and why it differs from it."""
    if (record := _record()) is not None:
        _append(record, node, SOURCE, None, source, why)

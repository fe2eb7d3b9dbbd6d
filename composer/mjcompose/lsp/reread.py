"""Read a changed text of a recipe again, without a look at the entries whose lines are the same."""

from __future__ import annotations

from collections.abc import Sequence as Items
from dataclasses import replace
from typing import NamedTuple

from mjcompose.base.alignment import common_ends
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.node import Key, Mapping, Node, Sequence

_UNUSUAL = "&*?%\t"
"""Anchors, aliases, keys that are not text, and directives reach other lines."""


class _Stretch(NamedTuple):
    """The entries from `first` to `last` of a section, and their lines from `start` to `end`, counted from 0."""

    first: int
    last: int
    start: int
    end: int


def reread(tree: Node, old: Items[str], new: Items[str], file: str) -> Node | None:
    r"""Return the tree of the lines `new`, given that of `old`; None if they have to be read from the start.

    It is returned only if as many lines of one section have changed, and the entries on them have no faults of YAML.

    >>> old = ["recipe: 1", "params:", "  a: 1", "  b: 2", "  c: 3"]
    >>> tree = load("\n".join(old), "r.yaml", Sink())
    >>> new = [*old[:3], "  b: [4]", old[4]]
    >>> reread(tree, old, new, "r.yaml") == load("\n".join(new), "r.yaml", Sink())
    True
    """
    head, tail = common_ends(old, new)
    last = len(old) - tail
    if len(old) != len(new) or head == last or not isinstance(tree, Mapping):
        return tree if old == new else None
    if any(set(_UNUSUAL) & set(line) or line[:1].strip() for line in (*old[head:last], *new[head:last])):
        return None
    name = _section_at(tree, head, last, len(old))
    if name is None:
        return None
    key, value = tree.entries[name]
    if not isinstance(value, Mapping | Sequence):
        return None
    stretch = _stretch(value, head, last, _end(tree, name, len(old)))
    if stretch is None or _indent(old[stretch.start]) != _indent(new[stretch.start]):
        return None
    if isinstance(value, Sequence) and not _begins_at_items(value, stretch, old):
        return None
    read = _entries(new, stretch, key, file)
    changed = None if read is None else _with_entries(value, read, stretch)
    return None if changed is None else Mapping({**tree.entries, name: (key, changed)}, tree.span)


def _section_at(tree: Mapping, head: int, last: int, count: int) -> str | None:
    """Return the name of the section whose lines, below its key, contain the lines from `head` to `last`."""
    for name, (key, _) in tree.entries.items():
        if key.span.line <= head and last <= _end(tree, name, count):
            return name
    return None


def _end(tree: Mapping, name: str, count: int) -> int:
    starts = sorted(key.span.line - 1 for key, _ in tree.entries.values())
    own = tree.entries[name][0].span.line - 1
    return next((start for start in starts if start > own), count)


def _stretch(value: Mapping | Sequence, head: int, last: int, end: int) -> _Stretch | None:
    starts = [span.line - 1 for span in _spans(value)]
    is_one_a_line = sorted(set(starts)) == starts
    if not starts or not is_one_a_line or starts[0] > head:
        return None
    first = max(at for at, start in enumerate(starts) if start <= head)
    behind = next((at for at in range(first, len(starts)) if starts[at] >= last), len(starts))
    return _Stretch(first, behind, starts[first], starts[behind] if behind < len(starts) else end)


def _spans(value: Mapping | Sequence) -> list[Span]:
    if isinstance(value, Mapping):
        return [key.span for key, _ in value.entries.values()]
    return [item.span for item in value.items]


def _begins_at_items(value: Sequence, stretch: _Stretch, lines: Items[str]) -> bool:
    """Return whether the stretch and the next item begin at a dash: two items may share a line."""
    starts = (stretch.start, stretch.end) if stretch.last < len(_spans(value)) else (stretch.start,)
    return all(_is_item(lines[line]) for line in starts)


def _is_item(line: str) -> bool:
    return line.lstrip().startswith("-")


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def _entries(lines: Items[str], stretch: _Stretch, key: Key, file: str) -> Mapping | Sequence | None:
    """Return the section with only the entries of a stretch, at their places; None if they have faults.

    The first entry begins at the same line as in the earlier text: the lines before it are complete.
    """
    at = key.span.line - 1
    if stretch.start <= at:
        return None
    gap = [""] * (stretch.start - at - 1)
    text = "\n".join([*[""] * at, f"{key.name}:", *gap, *lines[stretch.start : stretch.end], ""])
    sink = Sink()
    tree = load(text, file, sink)
    if sink.diagnostics or not isinstance(tree, Mapping) or list(tree.entries) != [key.name]:
        return None
    value = tree.entries[key.name][1]
    if isinstance(value, Mapping | Sequence) and _spans(value) and _spans(value)[0].line - 1 == stretch.start:
        return value
    return None


def _with_entries(value: Mapping | Sequence, read: Mapping | Sequence, stretch: _Stretch) -> Node | None:
    """Return a section in which the entries of a stretch are others."""
    span = value.span if stretch.first else read.span
    if isinstance(value, Mapping) and isinstance(read, Mapping):
        entries = list(value.entries.items())
        before = entries[: stretch.first]
        behind = entries[stretch.last :]
        if not read.entries.keys().isdisjoint(name for name, _ in (*before, *behind)):
            return None
        return Mapping(dict([*before, *read.entries.items(), *behind]), span)
    if isinstance(value, Sequence) and isinstance(read, Sequence):
        items = (*value.items[: stretch.first], *read.items, *value.items[stretch.last :])
        template = next((item.span.template for item in items if item.span.template is not None), None)
        return Sequence(items, replace(span, template=template))
    return None

"""The located tree: YAML values, each with its place in the file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics import Span


@dataclass(frozen=True, slots=True)
class Scalar:
    """A single value.

    `text` is the written text, without quotes and with escapes resolved; `plain` says that it has neither quotes
    nor a block style, so that `value` follows the rules of the YAML 1.2 core schema. For a literal block (`|`),
    `block` is the line and column where its text begins: each line of `text` is a line of the file.
    """

    value: bool | int | float | str | None
    span: Span
    text: str
    plain: bool
    block: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class Key:
    """A key of a mapping: always text, as written (`1`, `no` and `12:30` are names too)."""

    name: str
    span: Span


@dataclass(frozen=True, slots=True)
class Mapping:
    """Keys and values in the order of the file. Not to be changed once built.

    The span of a mapping over several lines covers its first line.
    """

    entries: dict[str, tuple[Key, Node]]
    span: Span


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list of values. The span of a list over several lines covers its first line."""

    items: tuple[Node, ...]
    span: Span


Node = Scalar | Mapping | Sequence


def texts(node: Node) -> Iterator[str]:
    """Yield every key and value as written."""
    if isinstance(node, Scalar):
        yield node.text
    elif isinstance(node, Sequence):
        for item in node.items:
            yield from texts(item)
    else:
        for name, (_, value) in node.entries.items():
            yield name
            yield from texts(value)


def spans(node: Node) -> Iterator[Span]:
    """Yield the place of every key and value."""
    yield node.span
    if isinstance(node, Sequence):
        for item in node.items:
            yield from spans(item)
    elif isinstance(node, Mapping):
        for key, value in node.entries.values():
            yield key.span
            yield from spans(value)


def to_python(node: Node) -> Any:
    """Return plain dicts, lists and values, without places. Recursive, because `load` keeps trees shallow."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, Sequence):
        return [to_python(item) for item in node.items]
    return {name: to_python(value) for name, (_, value) in node.entries.items()}


def find(node: Node, path: tuple[str | int, ...]) -> Node | None:
    """Return the node at `path`, or None if a step of it does not exist."""
    found: Node | None = node
    for step in path:
        if isinstance(found, Mapping) and isinstance(step, str):
            found = found.entries[step][1] if step in found.entries else None
        elif isinstance(found, Sequence) and isinstance(step, int):
            found = found.items[step] if 0 <= step < len(found.items) else None
        else:
            return None
    return found


def locate(node: Node, path: tuple[str | int, ...], key: bool = False) -> Span:
    """Return the place of the node at `path`, or of the deepest existing node on the way.

    A step is a key's name or an item's index; a step that does not exist is skipped. That way a validator's path
    with the names of chosen alternatives in it, such as `("sensor", "imu", "force", "site")`, finds its node. With
    `key`, or if the path ends in `"[key]"`, return the place of the last key on the way instead of its value's.
    """
    if path and path[-1] == "[key]":
        path, key = path[:-1], True
    span = node.span
    for step, following in zip(path, (*path, None)[1:], strict=True):
        if isinstance(node, Mapping) and isinstance(step, str) and step in node.entries:
            found, value = node.entries[step]
            if isinstance(value, Scalar) and following in node.entries:
                continue  # the name of an alternative that is also a key
            node = value
            span = found.span if key else value.span
        elif isinstance(node, Sequence) and isinstance(step, int) and 0 <= step < len(node.items):
            node = node.items[step]
            span = node.span
    return span

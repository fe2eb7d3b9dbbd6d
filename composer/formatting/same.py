"""Compare the contents of two trees."""

from __future__ import annotations

from composer.document.node import Mapping, Node, Scalar, Sequence
from composer.formatting.order import Path, is_free


def difference(one: Node, other: Node) -> str | None:
    """Return the path of the first value that differs between two trees, or None if they are equal.

    Texts, types and numbers are compared, and the order of keys if it has a meaning.
    """
    waiting: list[tuple[Node, Node, Path, str]] = [(one, other, (), "")]
    while waiting:
        a, b, path, shown = waiting.pop()
        if isinstance(a, Scalar) and isinstance(b, Scalar):
            if (a.text, a.plain, repr(a.value)) != (b.text, b.plain, repr(b.value)):
                return shown
        elif isinstance(a, Sequence) and isinstance(b, Sequence) and len(a.items) == len(b.items):
            for index, (x, y) in enumerate(zip(a.items, b.items, strict=True)):
                waiting.append((x, y, (*path, "*"), f"{shown}[{index}]"))
        elif isinstance(a, Mapping) and isinstance(b, Mapping) and _same_keys(a, b, path):
            for name, (_, value) in a.entries.items():
                waiting.append((value, b.entries[name][1], (*path, name), f"{shown}.{name}".lstrip(".")))
        else:
            return shown
    return None


def _same_keys(a: Mapping, b: Mapping, path: Path) -> bool:
    if is_free(path):
        return a.entries.keys() == b.entries.keys()
    return list(a.entries) == list(b.entries)

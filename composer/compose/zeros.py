"""Warn about a factor applied to zero. It has no effect, which is rarely intended: many of MuJoCo's defaults are 0."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lxml.etree import _Element as Node

from composer.compose.editing import Editing
from composer.diagnostics.diagnostic import Note
from composer.link import numbers
from composer.recipe.fault import Path
from composer.recipe.subscript import attribute_and_index
from composer.tree.kinds import kind_of


def only_zeros(editing: Editing, found: Iterable[Node], keys: Iterable[str]) -> list[str]:
    """Return the attributes, or single numbers of them (`friction[0]`), that are zero on every element."""
    nodes = list(found)
    return [key for key in keys if nodes and all(_is_zero(editing, node, key) for node in nodes)]


def report_only_zeros(editing: Editing, found: Sequence[Node], key: str, at: Path, help: str) -> None:
    """Warn about a factor for a value that is zero on every element."""
    whose = editing.called(found[0]) if len(found) == 1 else f"each of the {len(found)} selected elements"
    editing.sink.warning(
        "scale-of-zero",
        f"`{key}` of {whose} is 0, and a factor does not change it",
        editing.span(at),
        notes=[Note(f"{editing.called(found[0])} is written here", editing.span_of(found[0]))],
        help=help,
    )


def _is_zero(editing: Editing, node: Node, key: str) -> bool:
    name, subscript = attribute_and_index(key)
    attribute = kind_of(node).attributes.get(name)
    if attribute is None or not attribute.is_number:
        return False
    have = numbers.read(editing.effective(node, name) or "")
    those = have if subscript is None else have[subscript : subscript + 1]
    return bool(those) and not any(those)

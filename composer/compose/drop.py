"""Step: leave out unwanted elements of a base or a part, and everything that refers to them."""

from __future__ import annotations

from collections.abc import Iterable

from lxml.etree import _Element as Node

from composer.compose.editing import Editing
from composer.compose.select import select_counted
from composer.compose.verbs.remove import remove
from composer.link.subtree import Left
from composer.recipe.drop import Drop
from composer.recipe.fault import Path

_SETTINGS = ("option", "size", "visual", "statistic")


def drop(entries: Iterable[Drop], editing: Editing, at: Path) -> list[Left]:
    """Remove the elements that the entries select. Return all removed elements in the order of the entries."""
    gone: list[Left] = []
    for entry in entries:
        path = (*at, entry.index)
        if entry.select is not None:
            found = select_counted(
                editing, entry.select, path, expect=entry.expect, optional=entry.optional, counted_at=path
            )
        else:
            found = _section(editing, str(entry.section), path)
        if found:
            gone += remove(editing, found, cascade=True, at=path)
    for section in list(editing.root.iterchildren("*")):
        if section.tag != "worldbody" and not len(section) and not section.attrib:
            editing.root.remove(section)
    return gone


def _section(editing: Editing, tag: str, path: Path) -> list[Node]:
    sections = list(editing.root.iterchildren(tag))
    found = (
        sections if tag in _SETTINGS else [each for section in sections for each in section.iterchildren("*")]
    )
    unit = editing.linking.base
    if any(each.path.startswith(f"{tag}/") for each in unit.adopted):
        unit.adopted = tuple(each for each in unit.adopted if not each.path.startswith(f"{tag}/"))
        return found
    if not found:
        message = f"`{editing.linking.base.label}` has nothing in `{tag}` that could be left out"
        editing.sink.error("selector", message, editing.span(path), help=f"take `{tag}` out of `drop`")
    return found

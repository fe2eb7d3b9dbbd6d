"""The elements that a selector matches in the model that was composed last."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from composer.lsp.cursor import Path
from composer.lsp.places import own_part, part_called, without_variant
from composer.lsp.question import Question
from composer.recipe.select import NARROWING, read_selector
from composer.tree.pattern import BadPattern
from composer.tree.select import Selection, name_of
from composer.tree.selector import Selector, paths_of
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.lsp.analysis import Analysis


def selector_around(question: Question) -> tuple[Path, dict[str, Any]] | None:
    """Return the innermost selector around a cursor: its path and what is written there."""
    path = question.path
    for length in range(len(path), 0, -1):
        written = question.at(path[:length])
        if isinstance(written, dict) and is_selector(path[:length], written):
            return path[:length], written
    return None


def is_selector(path: Path, written: dict[str, Any]) -> bool:
    if not path:
        return False
    is_place = path[-1] in ("select", "parent", "in") or (len(path) > 1 and path[-2] in ("drop", "exists"))
    tags = [name for name in written if name not in NARROWING]
    return is_place and len(tags) == 1 and bool(paths_of(tags[0]))


def matches(path: Path, written: dict[str, Any], analysis: Analysis) -> list[Node] | None:
    """Return the elements that a selector matches, or None if that is not known. `where` is not evaluated."""
    selector = read_selector({**written, **({"where": {}} if "where" in written else {})}, path, "", [])
    if selector is None:
        return None
    own = own_part(without_variant(path))
    try:
        if own:
            unit = analysis.names.sources.get(part_called(own, analysis.plan))
            return None if unit is None else _selected(unit, selector, "/")
        model = analysis.model
        return None if model is None else _selected(model.unit, selector, analysis.separator, model.parts)
    except BadPattern:
        return None


def _selected(
    unit: Unit, selector: Selector, separator: str, parts: Mapping[Node, str] | None = None
) -> list[Node]:
    return Selection(unit.root, unit.classes, separator, parts or {}).of(selector)


def label(node: Node) -> str:
    """Return the name of an element for lists."""
    name = name_of(node)
    return f"`{name}`" if name else f"an unnamed `<{node.tag}>`"

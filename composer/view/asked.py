"""Which model of a target is shown."""

from __future__ import annotations

from dataclasses import field, replace
from typing import Any

from composer.cache.cells import cells_of
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.operand import Kind, Operand
from composer.document.node import Mapping, Node, Scalar, find
from composer.plan.read import read_recipe

CELL = "cell"
_MOST_CELLS = 200
_NONE = "(no cell)"


@dataclass(frozen=True, slots=True)
class Asked:
    """Values of parameters and variants, a cell of the matrix, a sample of what is drawn."""

    given: dict[str, Node] = field(default_factory=dict)
    pick: str | None = None
    sample: int | None = None

    def choosing(self, name: str, value: str) -> Asked:
        """Return the selection with a choice from a menu of the page."""
        if name == CELL:
            return replace(self, pick=None if value == _NONE else value, sample=None)
        given = {**self.given, name: Scalar(value, Span(f"--variant {name}", 1, 1), value, plain=False)}
        return replace(self, given=given)


def choices(operand: Operand, asked: Asked) -> list[dict[str, Any]]:
    """Return the menus of a recipe: its variants, unless a cell sets them, and its cells and samples."""
    if operand.kind is not Kind.RECIPE:
        return []
    context = replace(operand.context, sink=Sink())
    document = read_recipe(context.folder / operand.path, context)
    if not isinstance(document, Mapping):
        return []
    menus = []
    cells = (
        [cell.name for cell in cells_of(operand.path, context, dict(asked.given))]
        if _has_cells(document)
        else []
    )
    variants = find(document, ("variants",))
    if isinstance(variants, Mapping) and asked.pick is None:
        for axis, (_, values) in variants.entries.items():
            if isinstance(values, Mapping):
                menus.append(
                    _menu(axis, f"variant {axis}", list(values.entries), value=_now(asked.given.get(axis)))
                )
    if cells:
        known = [_NONE, *cells[:_MOST_CELLS]]
        menus.append(_menu(CELL, "cell or sample", known, value=asked.pick or _NONE))
    return menus


def _has_cells(document: Mapping) -> bool:
    return any(find(document, (key,)) is not None for key in ("matrix", "randomize"))


def _now(node: Node | None) -> str | None:
    return node.text if isinstance(node, Scalar) else None


def _menu(name: str, label: str, values: list[str], value: str | None) -> dict[str, Any]:
    return {"name": name, "label": label, "values": values, "value": value}

"""Code lenses: commands above a recipe and above the cells of its matrix."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Scalar, find, locate
from composer.expand.matrix import cells
from composer.lsp.analysis import Analysis
from composer.lsp.answers import Lens

COMMANDS = ("view", "build", "check")
_MOST = 12


def lenses(analysis: Analysis) -> list[Lens]:
    """Return the commands for the model, and for each cell of the matrix if there are not too many."""
    tree = analysis.mapping
    return [] if tree is None else list(_of(tree, analysis))


def _of(tree: Mapping, analysis: Analysis) -> Iterator[Lens]:
    top = next((name for name in ("recipe", "extends") if name in tree.entries), None)
    if top is None:
        return
    at = analysis.now(locate(tree, (top,), key=True), analysis.tree_of)
    if at is not None:
        for command in COMMANDS:
            yield Lens(at, command, f"mjcompose.{command}", (str(analysis.path),))
    at = (
        None
        if "matrix" not in tree.entries
        else analysis.now(locate(tree, ("matrix",), key=True), analysis.tree_of)
    )
    if at is None:
        return
    named = find(tree, ("name",))
    every = cells(tree, named.text if isinstance(named, Scalar) else analysis.path.stem, Sink())
    for cell in every[:_MOST]:
        for command in COMMANDS:
            yield Lens(at, f"{command} {cell.name}", f"mjcompose.{command}", (str(analysis.path), cell.name))

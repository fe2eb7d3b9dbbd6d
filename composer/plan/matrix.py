"""The matrix of a recipe file: its cells, with all names, values and drawn parameters checked."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from composer.context import Context, as_text
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, Scalar, find
from composer.expand.expand import scope_of
from composer.expand.matrix import Cell, cells, settled_name
from composer.expr.opening import is_template
from composer.plan.concrete import expanded
from composer.plan.drawn_parameters import drawn_parameters
from composer.plan.read import read_recipe
from composer.recipe.validate import judge

_DRAWN = ("recipe", "randomize")


class Matrix(NamedTuple):
    """A recipe of this name, merged over the recipes that it extends, and the cells of its matrix, if any."""

    document: Mapping
    name: str
    cells: list[Cell]


def read_matrix(recipe: Path, context: Context, given: Map[str, Node] | None = None) -> Matrix | None:
    """Return the matrix, or None if the recipe is unreadable. Errors go to the context's sink."""
    path = context.folder / recipe
    document = read_recipe(path, context)
    if not isinstance(document, Mapping):
        return None
    named = find(document, ("name",))
    name = named.text if isinstance(named, Scalar) else as_text(path.stem)
    own = settled_name(name, scope_of(document, given or {})) if is_template(name) else name
    matrix = Matrix(document, own, cells(document, name, context.sink, given=given))
    if _draws_parameters(document):
        _check_draws(matrix, path, given or {}, context=context)
    return matrix


@dataclass(frozen=True, slots=True)
class FilledValues:
    """The values for planning a recipe without a chosen cell.

    Parameters without a default take the values of the first cell: `cell` is its name, None if it is not needed,
    and `taken` are these parameters.
    """

    given: Map[str, Node]
    cell: str | None = None
    taken: tuple[str, ...] = ()


def filled_from_first_cell(recipe: Path, context: Context, given: Map[str, Node]) -> FilledValues:
    """Return the given values, with those of the first cell for parameters that would have none."""
    aside = replace(context, sink=Sink())
    document = read_recipe(context.folder / recipe, aside)
    if not isinstance(document, Mapping) or find(document, ("matrix",)) is None:
        return FilledValues(given)
    concrete = expanded(context.folder / recipe, given, aside)
    assert concrete is not None
    needed = {name for name in concrete.parameters if name not in concrete.scope and name not in given}
    matrix = read_matrix(recipe, aside, given) if needed else None
    first = matrix.cells[0] if matrix is not None and matrix.cells else None
    if first is None or not needed <= first.given.keys():
        return FilledValues(given)
    taken = {name: node for name, node in first.given.items() if name in needed}
    return FilledValues({**given, **taken}, first.name, tuple(taken))


def _draws_parameters(document: Mapping) -> bool:
    """Return whether a field of `randomize`, in the recipe or in a variant, draws a parameter."""
    variants = find(document, ("variants",))
    axes = [axis for _, axis in variants.entries.values()] if isinstance(variants, Mapping) else []
    pieces = [piece for axis in axes if isinstance(axis, Mapping) for _, piece in axis.entries.values()]
    sections = [find(piece, ("randomize", "fields")) for piece in (document, *pieces)]
    fields = [field for each in sections if isinstance(each, Mapping) for _, field in each.entries.values()]
    return any(find(field, ("param",)) is not None for field in fields)


def _check_draws(matrix: Matrix, path: Path, given: Map[str, Node], context: Context) -> None:
    """Report draws in cells that their parameters do not accept; other errors are reported elsewhere."""
    found: dict[str, list[Diagnostic]] = {}
    for cell in matrix.cells:
        concrete = expanded(path, {**given, **cell.given}, replace(context, sink=Sink()))
        if concrete is None:
            continue
        kept = {name: each for name, each in concrete.document.entries.items() if name in _DRAWN}
        document = Mapping(kept, matrix.document.span)
        recipe, _ = judge(document)
        randomize = recipe.randomize if recipe is not None else None
        if randomize is None:
            continue
        drawn = [str(field.param) for field in randomize.of_parameters]
        known = [(concrete.scope.get(name), concrete.parameters.get(name)) for name in drawn]
        alike = repr((randomize, known))
        if alike not in found:
            own = Sink()
            drawn_parameters(randomize, 0, concrete, document=document, sink=own)
            found[alike] = own.diagnostics
        for each in found[alike]:
            context.sink.add_of_cell(cell.label, each)

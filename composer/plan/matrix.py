"""The matrix of a recipe file: its cells, all names and values checked."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from composer.context import Context, as_text
from composer.document.node import Mapping, Scalar, find
from composer.expand.matrix import Cell, cells
from composer.plan.read import read_recipe


class Matrix(NamedTuple):
    """A recipe called `name`, merged over what it extends, and the cells of its matrix; none without one."""

    document: Mapping
    name: str
    cells: list[Cell]


def read_matrix(recipe: Path, context: Context) -> Matrix | None:
    """None where the recipe cannot be read; that and what is wrong with the matrix goes to the context's sink."""
    path = context.folder / recipe
    document = read_recipe(path, context)
    if not isinstance(document, Mapping):
        return None
    named = find(document, ("name",))
    name = named.text if isinstance(named, Scalar) else as_text(path.stem)
    return Matrix(document, name, cells(document, name, context.sink))

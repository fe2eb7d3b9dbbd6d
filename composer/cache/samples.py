"""The samples of a recipe that draws. Each is built and named like a cell of the matrix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.document.node import Mapping, Node, Scalar, find, locate
from composer.expand.matrix import Cell
from composer.limits import advice, in_force
from composer.plan.concrete import expanded
from composer.plan.matrix import Matrix


def sample_name(name: str, sample: int) -> str:
    """Return the name of a sample of a model.

    >>> sample_name("cell", 1)
    'cell-s0001'
    """
    return f"{name}-s{sample:04d}"


def with_samples(path: Path, matrix: Matrix, given: dict[str, Node], context: Context) -> list[Cell]:
    """Return every cell, or the recipe if it has no matrix, as its samples, the nominal model first.

    A cell stays as it is if it draws nothing, or if a single model with worlds is wanted.
    """
    document, cells, sink = matrix.document, matrix.cells, context.sink
    if not {"randomize", "variants"} & document.entries.keys() or (
        "matrix" in document.entries and not cells
    ):
        return cells
    before = sink.error_count
    found: list[Cell] = []
    for cell in cells or [Cell(matrix.name, {}, document.span)]:
        made = expanded(path, {**given, **cell.given}, replace(context, sink=Sink()))
        assert made is not None
        concrete = made.document
        if "randomize" in concrete.entries:
            _check_axes(concrete, cell, sink)
            found += _samples(concrete, cell)
        elif cells:
            found.append(cell)
        if len(found) > in_force().models:
            sink.error(
                "limit-exceeded",
                f"there are more than {in_force().models} models in all",
                locate(concrete, ("randomize",)),
                help=advice("models"),
            )
            break
    _check_names(found, sink)
    return found if sink.error_count == before else []


def _samples(concrete: Mapping, cell: Cell) -> Iterator[Cell]:
    written, emit = find(concrete, ("randomize", "samples")), find(concrete, ("randomize", "emit"))
    count = written.value if isinstance(written, Scalar) else None
    whole = isinstance(count, int | float) and not isinstance(count, bool) and 0 < count <= in_force().samples
    if not whole or (isinstance(emit, Scalar) and emit.value == "worlds"):
        yield cell  # planning reports its errors
        return
    assert isinstance(count, int | float)
    for sample in range(int(count) + 1):
        yield replace(cell, name=sample_name(cell.name, sample), sample=sample, is_sample=True)


def _check_axes(concrete: Mapping, cell: Cell, sink: Sink) -> None:
    """Report draws that would replace a value that a cell sets."""
    fields = find(concrete, ("randomize", "fields"))
    for name, (_, field) in fields.entries.items() if isinstance(fields, Mapping) else ():
        param = find(field, ("param",))
        if not isinstance(param, Scalar) or param.text not in cell.given or not isinstance(field, Mapping):
            continue
        if not {"scale", "offset"} & field.entries.keys():
            message = f"`{param.text}` is an axis of the matrix, whose value field `{name}` would replace"
            sink.error("unknown-name", message, param.span,
                       help="draw relative to it, with `scale` or `offset`, or take it out of the axes")  # fmt: skip


def _check_names(found: Iterable[Cell], sink: Sink) -> None:
    seen: set[str] = set()
    for cell in found:
        if cell.name in seen:
            message = f"a cell of the matrix is called `{cell.name}`, as a sample of another is"
            sink.error("name-clash", message, cell.span, help="give the cell another name")
            return
        seen.add(cell.name)

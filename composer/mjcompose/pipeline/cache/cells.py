"""Cells, samples and variants that a command selects."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.language.expand import Cell
from mjcompose.language.parameters import read_axes
from mjcompose.plan.locked import use_lock
from mjcompose.plan.matrix import Matrix, read_matrix
from mjcompose.plan.read import expanded_recipe, read_recipe
from mjcompose.sources.context import Context
from mjcompose.text.node import Mapping, Node, Scalar, find, locate, to_python, walk

MANY = 64


def choices_of(recipe: Path, context: Context) -> Iterator[dict[str, Node]]:
    """Yield all combinations; if there are more than `MANY`, every value once with the other axes at their default."""
    node = read_recipe(context.folder / recipe, context)
    axes = read_axes(node, Sink()) if isinstance(node, Mapping) else {}
    values: dict[str, list[Node]] = {
        axis: [Scalar(key.name, key.span, key.name, plain=True) for key, _ in pieces.entries.values()]
        for axis, pieces in axes.items()
    }
    if not values:
        return
    if math.prod(map(len, values.values())) <= MANY:
        yield from (dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values()))
    else:
        yield from ({axis: value} for axis, every in values.items() for value in every)


def sample_name(name: str, sample: int) -> str:
    """Return the name of a sample of a model.

    >>> sample_name("cell", 1)
    'cell-s0001'
    """
    return f"{name}-s{sample:04d}"


def with_samples(path: Path, matrix: Matrix, given: dict[str, Node], context: Context) -> list[Cell]:
    """Return every cell, or the recipe without a matrix, as its samples, if it draws any; the nominal model first."""
    document = matrix.document
    cells = matrix.cells
    sink = context.sink
    if not {"randomize", "variants"} & document.entries.keys() or ("matrix" in document.entries and not cells):
        return cells
    before = sink.error_count
    found: list[Cell] = []
    for cell in cells or [Cell(matrix.name, {}, document.span)]:
        made = expanded_recipe(path, {**given, **cell.given}, replace(context, sink=Sink()))
        assert made is not None
        concrete = made.document
        if "randomize" in concrete.entries:
            _check_axes(concrete, cell, sink)
            found += _samples(concrete, cell)
        elif cells:
            found.append(cell)
        if len(found) > in_force().models:
            message = f"there are more than {in_force().models} models in all"
            sink.error("limit-exceeded", message, locate(concrete, ("randomize",)), help=advice("models"))
            break
    seen: set[str] = set()
    for cell in found:
        if cell.name in seen:
            message = f"a cell of the matrix has the same name as a sample of another: `{cell.name}`"
            sink.error("name-clash", message, cell.span, help="give the cell another name")
            break
        seen.add(cell.name)
    return found if sink.error_count == before else []


def _samples(concrete: Mapping, cell: Cell) -> Iterator[Cell]:
    written = find(concrete, ("randomize", "samples"))
    count = written.value if isinstance(written, Scalar) else None
    if not isinstance(count, int | float) or isinstance(count, bool) or not 0 < count <= in_force().samples:
        yield cell  # planning reports its errors
        return
    for sample in range(int(count) + 1):
        yield replace(cell, name=sample_name(cell.name, sample), sample=sample, is_sample=True)


def _check_axes(concrete: Mapping, cell: Cell, sink: Sink) -> None:
    """Report draws that would replace a value that a cell sets."""
    fields = find(concrete, ("randomize", "fields"))
    if isinstance(fields, Mapping):
        for name, (_, field) in fields.entries.items():
            param = find(field, ("param",))
            if not isinstance(param, Scalar) or param.text not in cell.given or not isinstance(field, Mapping):
                continue
            if not {"scale", "offset"} & field.entries.keys():
                message = f"`{param.text}` is an axis of the matrix, whose value field `{name}` would replace"
                sink.error(
                    "unknown-name",
                    message,
                    param.span,
                    help="draw relative to it, with `scale` or `offset`, or remove it from the axes",
                )


def cells_of(
    recipe: Path, context: Context, given: dict[str, Node] | None = None, *, worlds: bool = False
) -> list[Cell]:
    """Return the cells that `--all` builds, each with its samples unless they are `worlds`; none after errors."""
    if use_lock(recipe, context) is None or (matrix := read_matrix(recipe, context, given)) is None:
        return []
    if worlds:
        return matrix.cells or [Cell(matrix.name, {}, matrix.document.span)]
    return with_samples(context.folder / recipe, matrix, given or {}, context=context)


class WorldsOfRecipe(Struct):
    """The cells that can be worlds of one model; `draws` says whether the recipe draws samples."""

    cells: int
    draws: bool


def worlds_of(recipe: Path, context: Context, given: dict[str, Node]) -> WorldsOfRecipe:
    """Return the cells of a recipe that are worlds; for a faulty recipe none. Axes that `given` sets have one value."""
    own = replace(context, sink=Sink())
    if use_lock(recipe, own) is None or (matrix := read_matrix(recipe, own, given)) is None:
        return WorldsOfRecipe(0, draws=True)
    is_chosen = any(given.keys() & cell.given.keys() for cell in matrix.cells)
    written = read_recipe(context.folder / recipe, own)
    keys = [] if written is None else [visit.key.name for visit in walk(written) if visit.key is not None]
    return WorldsOfRecipe(0 if is_chosen else len(matrix.cells), draws="randomize" in keys)


def select_cells(every: Sequence[Cell], picks: Iterable[str], sink: Sink, recipe: str) -> list[Cell]:
    """Return the picked cells, each once, in the order of the picks; a pick that matches nothing is an error.

    A pick is the name of a sample, of a cell (all its samples), or `AXIS=VALUE[,AXIS=VALUE...]`: all with these values.
    """

    def text_of(cell: Cell, axis: str) -> str | None:
        return pick_text(cell.given[axis]) if axis in cell.given else None

    found: dict[str, Cell] = {}
    for pick in picks:
        chosen = [each for each in every if pick in (each.name, each.cell)]
        wanted = [item.partition("=") for item in pick.split(",")]
        if not chosen and all(equals for _, equals, _ in wanted):
            chosen = [each for each in every if all(text_of(each, axis) == value for axis, _, value in wanted)]
        found.update((each.name, each) for each in chosen)
        if not chosen:
            _report_none(every, pick, sink, recipe=recipe)
    return list(found.values())


def of_samples(cells: Iterable[Cell], samples: Iterable[int], sink: Sink) -> list[Cell]:
    """Return the cells with one of these samples; a sample that does not exist is an error."""
    cells = list(cells)
    wanted = list(dict.fromkeys(samples))
    known = sorted({cell.sample for cell in cells if cell.is_sample})
    for sample in wanted:
        if cells and sample not in known:
            there = f"has the samples 0 to {known[-1]}" if known else "draws nothing"
            sink.error("unknown-name", f"sample {sample} does not exist: the recipe {there}")
    return [cell for cell in cells if cell.is_sample and cell.sample in wanted]


def select_cell(every: Sequence[Cell], pick: str, sample: int | None, sink: Sink, recipe: str) -> Cell | None:
    """Return the one picked cell; of samples, the nominal model or the given `sample`. Anything else is an error."""
    chosen = select_cells(every, [pick], sink, recipe=recipe)
    if sample is not None:
        chosen = of_samples(chosen, [sample], sink)
    if len({each.cell for each in chosen}) > 1:
        names = list(dict.fromkeys(each.cell or each.name for each in chosen))
        message = f"`--pick {pick}` chooses {len(names)} cells of `{recipe}`, not one"
        sink.error("selector", message, notes=(exists_note("cell", names),), help="name one of them")
        return None
    return chosen[0] if chosen else None


def check_axes_are_free(chosen: Iterable[Cell], given: Iterable[str], sink: Sink, instead: str) -> None:
    """Report values that the user gives although a cell sets them; `instead` says what to do."""
    names = dict.fromkeys(name for cell in chosen for name in cell.given)
    for name in given:
        if name in names:
            sink.error(
                "unknown-name",
                f"`{name}` is an axis of the matrix, whose cells set it",
                help=f"do not set it, or {instead}",
            )


def _report_none(every: Sequence[Cell], pick: str, sink: Sink, recipe: str) -> None:
    axis, equals, value = pick.partition("=")
    values = list(dict.fromkeys(pick_text(cell.given[axis]) for cell in every if axis in cell.given))
    if equals and values and "," not in value:
        sink.error(
            "unknown-name",
            f"no cell of `{recipe}` has `{axis}` = `{value}`",
            notes=(exists_note("value", values, value),),
            help=did_you_mean(value, values, f"--pick {axis}={{}}"),
        )
        return
    names = {each.name: each for each in every}
    sink.error(
        "unknown-name",
        f"the matrix of `{recipe}` has no cell `{pick}`",
        notes=(exists_note("cell", names, pick),),
        help=did_you_mean(pick, names, "--pick {}"),
    )


def pick_text(node: Node) -> str:
    """Return a value in the syntax of a pick."""
    return node.text if isinstance(node, Scalar) else json.dumps(to_python(node))

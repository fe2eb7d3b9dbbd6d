"""The cells of a recipe's matrix, with drawn parameters."""

from __future__ import annotations

from collections.abc import Mapping as Map
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note
from mjcompose.base.distribution import CHOICE
from mjcompose.base.draw_stream import bits
from mjcompose.base.files import own_name
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.language.expand import Cell, Concrete, cells, scope_of, settled_name
from mjcompose.language.parameters import Parameter, node_of
from mjcompose.language.validate import judge
from mjcompose.plan.plan import Drawn, Plan
from mjcompose.plan.read import expanded_recipe, read_recipe
from mjcompose.sources.context import Context, as_text
from mjcompose.text.expression import Angle, Value, kind, number_of
from mjcompose.text.node import Mapping, Node, Scalar, find, is_template, locate

if TYPE_CHECKING:
    from mjcompose.language.randomize import DrawField, Randomize


def draw_parameters(
    randomize: Randomize, sample: int, concrete: Concrete, document: Mapping, sink: Sink
) -> tuple[dict[str, Node], tuple[Drawn, ...]]:
    """Return the values of a sample by name; sample 0 has none, and checks all other samples."""
    values: dict[str, Node] = {}
    drawn: list[Drawn] = []
    taken: dict[str, DrawField] = {}
    for field in randomize.of_parameters:
        name = str(field.param)
        if name in taken:
            span = locate(document, (*field.at, "param"))
            note = Note("drawn here too", locate(document, (*taken[name].at, "param")))
            sink.error("name-clash", f"two fields draw the parameter `{name}`", span, notes=(note,), subjects=(name,))
            continue
        taken[name] = field
        source = _Source(field, concrete, document, sink=sink)
        if not source.can_be_drawn():
            continue
        numbers = (sample,) if sample else range(1, randomize.samples + 1)
        for number in numbers:
            value = source.value(randomize.seed, number)
            if value is None:
                break
            if sample:
                values[name] = node_of(value, locate(document, field.drawn_at))
                draw = source.draw(randomize.seed, sample)
                drawn.append(Drawn(field.name, None, name, operation=field.operation, value=draw))
    return values, tuple(drawn)


class _Source:
    """The source of the values of one parameter or variant."""

    def __init__(self, field: DrawField, concrete: Concrete, document: Mapping, sink: Sink) -> None:
        self.field = field
        self.concrete = concrete
        self.document = document
        self.sink = sink
        self.name = str(field.param)
        self.parameter: Parameter | None = concrete.parameters.get(self.name)
        nominal = concrete.scope.get(self.name)
        self.nominal: Value | None = None if nominal is None else number_of(nominal)

    def can_be_drawn(self) -> bool:
        """Return whether the parameter exists and can be drawn in this way."""
        field = self.field
        distribution = self.field.distribution
        span = locate(self.document, (*field.at, "param"))
        drawn_at = locate(self.document, field.drawn_at)
        if self.name in self.concrete.parameters and self.nominal is None:
            return False  # its missing value is reported already
        if self.nominal is None:
            known = list(self.concrete.scope)
            message = f"the recipe has no parameter `{self.name}` to draw"
            self.sink.add(unknown_name("parameter", self.name, known, span=span, message=message, written="param: {}"))
            return False
        numbers = self.nominal if isinstance(self.nominal, tuple) else (self.nominal,)
        is_number = all(isinstance(each, int | float) and not isinstance(each, bool) for each in numbers)
        code = "wrong-type"
        help = None
        if not is_number and (distribution.kind != CHOICE or field.operation != "set"):
            nominal = "a variant" if self.parameter is None else kind(self.nominal)
            message = f"`{self.name}` is {nominal}, and only a `{CHOICE}` can draw it"
            help = f"write `{CHOICE}: [VALUE, …]`"
        elif distribution.unit is not None and not (self.parameter and self.parameter.is_angle):
            message = f"parameter `{self.name}` is not an angle, but its draws are angles"
            span = drawn_at
            help = f"declare it as an angle: `{self.name}: {{unit: {distribution.unit}, …}}`"
        elif distribution.components not in (None, len(numbers)):
            expected = f"`{distribution.kind}` {distribution.components}"
            code = "wrong-length"
            span = drawn_at
            message = f"parameter `{self.name}` has {len(numbers)} numbers, {expected}"
        else:
            return True
        self.sink.error(code, message, span, help=help, subjects=(self.name,))
        return False

    def draw(self, seed: int, sample: int) -> Value:
        """Return the draw: a number, one for each component of a vector, or the chosen value."""
        distribution = self.field.distribution
        field = self.field

        def component(n: int) -> Any:
            return distribution.draw(bits(seed, sample, field.stream, element="", component=n), n)

        if isinstance(self.nominal, tuple) and not distribution.is_whole:
            return tuple(map(component, range(len(self.nominal))))
        chosen = component(0)
        return tuple(chosen) if isinstance(chosen, list) else chosen

    def value(self, seed: int, sample: int) -> Value | None:
        """Return the value of the parameter in a sample, or None after a report that it does not accept the value."""
        drawn = self.draw(seed, sample)
        parameter = self.parameter
        if isinstance(drawn, tuple):
            nominal = self.nominal if isinstance(self.nominal, tuple) else (self.nominal,) * len(drawn)
            value: Value = tuple(self._applied(*pair) for pair in zip(nominal, drawn, strict=False))
        else:
            value = self._applied(self.nominal, drawn)
        if parameter is None:
            return value
        read = parameter.read(value)
        if not isinstance(read, Diagnostic):
            return read
        help = read.help
        if parameter.type == "int" and read.code == "wrong-type":
            help = "draw `integers: [FIRST, LAST]`"
        elif read.code == "out-of-range" and not parameter.choices:
            help = "draw from a distribution with bounds, such as `truncnormal`"
        span = locate(self.document, self.field.drawn_at)
        notes = (Note("the parameter is declared here", parameter.span),)
        self.sink.error(read.code, f"{read.message} in sample {sample}", span, notes=notes, help=help)
        return None

    def _applied(self, nominal: Value | None, drawn: Value) -> Value:
        unit = self.field.distribution.unit
        if unit is not None and self.parameter is not None and isinstance(drawn, int | float):
            drawn = Angle(drawn, unit).in_unit(str(self.parameter.unit))
        if self.field.operation == "set":
            return drawn
        assert isinstance(nominal, int | float) and isinstance(drawn, int | float)
        return nominal * drawn if self.field.operation == "scale" else nominal + drawn


def check_sample(plan: Plan, sample: int, sink: Sink) -> bool:
    """Return whether the recipe has this sample, and report a missing one. Sample 0 is the model without draws."""
    if sample <= (plan.randomize.samples if plan.randomize else 0):
        return True
    span = None if plan.randomize is None else locate(plan.document, ("randomize", "samples"))
    there = "has no `randomize`" if plan.randomize is None else f"has the samples 0 to {plan.randomize.samples}"
    sink.error("unknown-name", f"sample {sample} does not exist: the recipe {there}", span)
    return False


_DRAWN = ("recipe", "randomize")


class Matrix(NamedTuple):
    """A recipe, merged over the recipes that it extends, and the cells of its matrix, if any."""

    document: Mapping
    name: str
    cells: list[Cell]


def read_matrix(recipe: Path, context: Context, given: Map[str, Node] | None = None) -> Matrix | None:
    """Return the matrix, or None if the recipe is unreadable. Report errors."""
    path = context.folder / recipe
    document = read_recipe(path, context)
    if not isinstance(document, Mapping):
        return None
    named = find(document, ("name",))
    name = named.text if isinstance(named, Scalar) else as_text(own_name(path))
    own = settled_name(name, scope_of(document, given or {})) if is_template(name) else name
    matrix = Matrix(document, own, cells(document, name, context.sink, given=given))
    if _draws_parameters(document):
        _check_draws(matrix, path, given or {}, context=context)
    return matrix


class FilledValues(Struct):
    """Values for planning without a chosen cell: the values `taken` from the first cell, `cell`, have no default."""

    given: Map[str, Node]
    cell: str | None = None
    taken: tuple[str, ...] = ()


def filled_from_first_cell(recipe: Path, context: Context, given: Map[str, Node]) -> FilledValues:
    """Return the given values, and the first cell's values for parameters that would have no value."""
    aside = replace(context, sink=Sink())
    document = read_recipe(context.folder / recipe, aside)
    if not isinstance(document, Mapping) or find(document, ("matrix",)) is None:
        return FilledValues(given)
    concrete = expanded_recipe(context.folder / recipe, given, aside)
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
    known: dict[str, list[Diagnostic]] = {}
    for cell in matrix.cells:
        concrete = expanded_recipe(path, {**given, **cell.given}, replace(context, sink=Sink()))
        if concrete is None:
            continue
        kept = {name: entry for name, entry in concrete.document.entries.items() if name in _DRAWN}
        document = Mapping(kept, matrix.document.span)
        recipe, _ = judge(document)
        randomize = recipe.randomize if recipe is not None else None
        if randomize is None:
            continue
        drawn = [str(field.param) for field in randomize.of_parameters]
        alike = repr((randomize, [(concrete.scope.get(name), concrete.parameters.get(name)) for name in drawn]))
        if alike not in known:
            own = Sink()
            draw_parameters(randomize, 0, concrete, document=document, sink=own)
            known[alike] = own.diagnostics
        for diagnostic in known[alike]:
            context.sink.add_of_cell(cell.label, diagnostic)

"""Turn a recipe into a concrete one: variants, conditions, expressions, cells of the matrix."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Collection, Iterable, Iterator, Mapping as Map
from pathlib import PurePosixPath

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import CellName, Note, Span
from mjcompose.base.limits import advice, in_force
from mjcompose.base.naming import odd_character
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note, unknown_name
from mjcompose.language.condition import Condition
from mjcompose.language.left_out import LeftOut
from mjcompose.language.parameters import (
    Axes,
    Parameter,
    Substitution,
    choose,
    merged,
    plain,
    read_axes,
    report,
    same,
    settle,
)
from mjcompose.language.repeat import Repeater, has_repetitions, misplaced_names
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError, Value, shown
from mjcompose.text.merge import Path, without_ids
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, find, is_template, locate


class Concrete(Struct):
    """A recipe without parameters and variants, and the values it was made with.

    `scope` has the values by name, with variants as text; `lost` has the names that are left out or in doubt because of
    errors, and `gone` has the paths of the keys that are left out. `left_out` has the entries that the model does not
    have by the recipe itself.
    """

    document: Mapping
    scope: Map[str, Value]
    parameters: Map[str, Parameter]
    variants: Map[str, str]
    lost: frozenset[str] = frozenset()
    gone: frozenset[Path] = frozenset()
    left_out: tuple[LeftOut, ...] = ()


def expand(document: Mapping, given: Map[str, Node], sink: Sink, any: bool = False) -> Concrete:
    """Return the recipe with the given values or the defaults, without faulty pieces; `any` ignores each `when`."""
    from mjcompose.language.recipe import SETTLED

    axes = read_axes(document, sink)
    chosen = choose(axes, given, sink)
    document = merged(document, axes, chosen, sink=sink)
    parameters = _params(document, sink)
    _check_names(document, axes, parameters, given=given, sink=sink)
    scope: dict[str, Value] = {
        **settle(parameters, given, sink, in_cells=_declared(document, "matrix", "axes")),
        **chosen,
    }
    unsettled = {name: entry for name, entry in document.entries.items() if name not in SETTLED}
    rest = without_ids(Mapping(unsettled, document.span), sink)
    broken = (_declared(document, "params") | _declared(document, "variants")) - scope.keys()
    lost: set[str] = set()
    left_out: list[LeftOut] = []
    misplaced = misplaced_names(rest)
    if has_repetitions(rest):
        repeater = Repeater(scope, axes, broken, sink=sink, any=any)
        rest = repeater.repeated(rest)
        lost |= repeater.lost
        left_out += repeater.left_out
    condition = Condition(scope, axes, broken, sink=sink, any=any)
    substitution = Substitution(scope, broken | misplaced, sink=sink)
    substituted = substitution.of(condition.kept(rest))
    assert isinstance(substituted, Mapping)
    lost |= condition.in_doubt | substitution.lost
    left_out += condition.left_out
    return Concrete(
        substituted,
        scope,
        parameters,
        variants=chosen,
        lost=frozenset(lost),
        gone=frozenset(substitution.gone),
        left_out=tuple(left_out),
    )


def scope_of(document: Mapping, given: Map[str, Node]) -> dict[str, Value]:
    """Return the values by name that `expand` would use, without expanding anything; its errors are reported there."""
    sink = Sink()
    axes = read_axes(document, sink)
    chosen = choose(axes, given, sink)
    taken = {axis: _only_params(axes[axis], value) for axis, value in chosen.items()}
    return {**settle(_params(merged(_section(document), taken, chosen, sink=sink), sink), given, sink), **chosen}


def _params(document: Mapping, sink: Sink) -> dict[str, Parameter]:
    if "params" not in document.entries:
        return {}
    from mjcompose.language.variation import read_params  # most recipes have none

    return read_params(document, sink)


def _only_params(values: Mapping, chosen: str) -> Mapping:
    """Return the chosen value of an axis with only the `params` of its piece."""
    key, piece = values.entries[chosen]
    return Mapping({chosen: (key, _section(piece) if isinstance(piece, Mapping) else piece)}, values.span)


def _section(document: Mapping) -> Mapping:
    return Mapping({name: each for name, each in document.entries.items() if name == "params"}, document.span)


def _check_names(
    document: Mapping, axes: Axes, parameters: Map[str, Parameter], given: Map[str, Node], sink: Sink
) -> None:
    for name in axes.keys() & parameters.keys():
        variants = document.entries["variants"][1]
        assert isinstance(variants, Mapping)
        notes = (Note("the parameter", parameters[name].span),)
        sink.error("name-clash", f"`{name}` is a variant and a parameter", variants.entries[name][0].span, notes=notes)
    tried = _declared(document, "params") | _declared(document, "variants")
    for name, node in given.items():
        if name not in tried:
            message = f"the recipe has no parameter or variant `{name}`"
            sink.add(unknown_name("name", name, [*axes, *parameters], span=node.span, message=message))


def _declared(document: Mapping, *path: str) -> frozenset[str]:
    """Return the names in a section, including those of faulty entries."""
    found = find(document, path)
    return frozenset(found.entries) if isinstance(found, Mapping) else frozenset()


class Cell(Struct):
    """One combination: its name, and the value of every axis of the matrix that it sets, by name.

    `cell` is the name of the combination, None without a matrix. `sample` is the number of its sample; 0 has no
    draws. `is_sample` says that it is one of several samples. `weight` is its share of worlds, relative to other cells.
    """

    name: str
    given: dict[str, Node]
    span: Span
    sample: int = 0
    cell: str | None = None
    is_sample: bool = False
    weight: float = 1.0

    @property
    def label(self) -> CellName:
        return CellName(self.name, self.cell, self.sample if self.is_sample else None)

    def values(self) -> dict[str, Value | None]:
        return {name: plain(node) for name, node in self.given.items()}


def cells(document: Mapping, name: str, sink: Sink, given: Map[str, Node] | None = None) -> list[Cell]:
    """Return the cells of a recipe in order, `include` last; names and values are checked before anything is built."""
    found = document.entries.get("matrix")
    if found is None:
        return []
    before = sink.error_count
    matrix = _Matrix(document, found, given or {}, sink=sink)
    combinations = list(matrix.combinations())
    for axis in matrix.axes:
        nodes = [given[axis] for given, _ in combinations if axis in given]
        matrix.labels[axis] = labels_of_paths(node.text for node in nodes if isinstance(node, Scalar))
    if sink.error_count > before:
        return []
    named = [(matrix.name_of(name, given), given, span) for given, span in combinations]
    matrix.check_weights([given for given, _ in combinations])
    made = [Cell(each, given, span, cell=each, weight=matrix.weight_of(given)) for each, given, span in named]
    if sink.error_count == before:
        _check_names_of_cells(made, matrix, sink)
    return made if sink.error_count == before else []


class _Matrix:
    def __init__(self, document: Mapping, entry: tuple[Key, Node], given: Map[str, Node], sink: Sink) -> None:
        from mjcompose.language.variation import read_grid  # most recipes have none

        self.document = document
        self.given = given
        self.sink = sink
        self.key, node = entry
        self.grid = read_grid(document, sink)
        self.node = node if isinstance(node, Mapping) else Mapping({}, node.span)
        self.around: dict[str, Node] = {}
        self.labels: dict[str, Map[str, str]] = {}
        self.axes = self._axes() if self.grid is not None else {}

    def _axes(self) -> dict[str, tuple[Node, ...]]:
        written = find(self.node, ("axes",))
        assert isinstance(written, Mapping)
        axes = {key.name: values.items for key, values in written.entries.values() if isinstance(values, Sequence)}
        self.around = self._around(axes)
        for axis, items in axes.items():
            for value in items:  # check each alone: does the name exist, and may it have that value?
                concrete = expand(self.document, {**self.around, axis: value}, self.sink)
                if axis not in concrete.parameters and axis not in concrete.variants:
                    break  # reported, and the same for all its values
        return axes

    def _around(self, axes: Map[str, tuple[Node, ...]]) -> dict[str, Node]:
        """Return the given values, and one for each axis that is a parameter without a default: every cell sets it."""
        found = expand(self.document, self.given, Sink())
        needed = {
            axis: values[0]
            for axis, values in axes.items()
            if axis in found.parameters and found.parameters[axis].default is None
        }
        known = found.parameters.keys() | found.variants.keys()
        return {**needed, **{name: node for name, node in self.given.items() if name in known}}

    def combinations(self) -> Iterator[tuple[dict[str, Node], Span]]:
        size = math.prod(map(len, self.axes.values()))
        most = in_force().cells
        if size > most:
            message = f"the matrix has {size} cells; {most} are allowed"
            self.sink.error("limit-exceeded", message, self.key.span, help=advice("cells", size))
            return
        excluded = list(self._entries("exclude"))
        hit = [False] * len(excluded)
        if self.axes:
            for values in itertools.product(*self.axes.values()):
                given = dict(zip(self.axes, values, strict=True))
                out = [all(_same(given[key.name], node) for key, node in each.entries.values()) for each in excluded]
                hit = [*map(operator.or_, hit, out)]
                if not any(out):
                    yield given, self.key.span
        for entry in itertools.compress(excluded, map(operator.not_, hit)):
            self.sink.error(
                "unknown-name",
                "no cell of the matrix is like this one to be excluded",
                entry.span,
                help="its values come from the axes, as they are written there",
            )
        for entry in self._entries("include"):
            given = {key.name: node for key, node in entry.entries.values()}
            expand(self.document, {**self.around, **given}, self.sink)
            yield given, entry.span

    def _entries(self, name: str) -> Iterator[Mapping]:
        written = find(self.node, (name,)) if self.grid is not None else None
        if isinstance(written, Sequence):
            for item in written.items:
                keys = [key for key, _ in item.entries.values()] if isinstance(item, Mapping) else []
                wrong = [key for key in keys if key.name not in self.axes and name == "exclude"]
                for key in wrong:
                    message = f"the matrix has no axis `{key.name}`"
                    self.sink.add(unknown_name("axis", key.name, self.axes, span=key.span, message=message))
                if isinstance(item, Mapping) and not wrong:
                    yield item

    def check_weights(self, cells: Collection[Map[str, Node]]) -> None:
        """Report weights of axes and values that no cell has."""
        for axis, weights in (self.grid.weights if self.grid is not None else {}).items():
            span = locate(self.node, ("weights", axis), key=True)
            if axis not in self.axes:
                message = f"the matrix has no axis `{axis}`"
                self.sink.add(unknown_name("axis", axis, self.axes, span=span, message=message))
                continue
            known = {_text(given[axis]): None for given in cells if axis in given}
            for value in weights:
                if value not in known:
                    span = locate(self.node, ("weights", axis, value), key=True)
                    message = f"`matrix.weights.{axis}` has `{value}`, which is not a value of the axis"
                    notes = (exists_note("value", known, value),)
                    self.sink.error("out-of-range", message, span, notes=notes, help=did_you_mean(value, known))
        if cells and not any(map(self.weight_of, cells)):
            span = locate(self.node, ("weights",), key=True)
            self.sink.error("out-of-range", "all weights are 0", span, help="give one cell a weight")

    def weight_of(self, given: Map[str, Node]) -> float:
        """Return the product of the weights of a cell's values."""
        weights = self.grid.weights if self.grid is not None else {}
        return math.prod(weights[axis].get(_text(node), 1.0) for axis, node in given.items() if axis in weights)

    def name_of(self, name: str, given: dict[str, Node]) -> str:
        scope = scope_of(self.document, {**self.given, **given})
        name = settled_name(name, scope)
        node = find(self.node, ("name",))
        if not isinstance(node, Scalar):
            axes = (*self.axes, *(given.keys() - self.axes.keys()))
            values = [(axis, shown(scope[axis])) for axis in axes]
            return "-".join([name, *(self.labels.get(axis, {}).get(value, value) for axis, value in values)])
        try:
            return str(Template.parse(str(node.value)).value({**scope, "name": name}))
        except ExpressionError as error:
            report(error, node, ["name", *scope], broken=frozenset(), sink=self.sink)
            return name


def _text(node: Node) -> str:
    return node.text if isinstance(node, Scalar) else str(plain(node))


def labels_of_paths(values: Iterable[str]) -> Map[str, str]:
    """Return the name in cells of each value that is a relative path: the stem of the file if that is enough.

    >>> labels_of_paths(["./pick/cube.xml", "none"]), labels_of_paths(["./a/mug.xml", "./b/mug.xml"])
    ({'./pick/cube.xml': 'cube'}, {'./a/mug.xml': 'a_mug', './b/mug.xml': 'b_mug'})
    """
    values = list(dict.fromkeys(values))
    paths = [value for value in values if value.startswith(("./", "../"))]
    others = [value for value in values if value not in paths]
    stems = [PurePosixPath(path).stem for path in paths]
    long = ["_".join(PurePosixPath(path).with_suffix("").parts).replace(".._", "") for path in paths]
    for labels in (stems, long):
        if len({*labels, *others}) == len(values):
            return dict(zip(paths, labels, strict=True))
    return {}


def settled_name(name: str, scope: Map[str, Value]) -> str:
    """Return a recipe's name with its expressions evaluated; their errors are reported when it is expanded."""
    try:
        return str(Template.parse(name).value(scope)) if is_template(name) else name
    except ExpressionError:
        return name


def _same(a: Node, b: Node) -> bool:
    if isinstance(a, Scalar) and isinstance(b, Scalar) and a.text == b.text:
        return True
    first = plain(a)
    second = plain(b)
    return first is not None and second is not None and same(first, second)


def _check_names_of_cells(made: list[Cell], matrix: _Matrix, sink: Sink) -> None:
    for cell in made:
        character = odd_character(cell.name)
        if character is not None:
            texts = [node for node in cell.given.values() if isinstance(node, Scalar)]
            values = [node.span for node in texts if odd_character(node.text) is not None]
            entry = matrix.node.entries.get("name")
            names = [] if entry is None else [entry[1].span]
            span = next(iter((*values, *names)), cell.span)
            help = "use letters, digits and `_ . -`, or write a `name` into `matrix` that omits this value"
            sink.error("bad-name", f"the name of a cell has {character} in it", span, help=help)
            return
    _check_unique(made, matrix, sink)


def _check_unique(made: list[Cell], matrix: _Matrix, sink: Sink) -> None:
    seen: dict[str, Cell] = {}
    for cell in made:
        other = seen.setdefault(cell.name, cell)
        if other is not cell:
            entry = matrix.node.entries.get("name")
            differing = [
                axis for axis in cell.given if not _same(cell.given[axis], other.given.get(axis, cell.given[axis]))
            ]
            message = f"two cells of the matrix are called `{cell.name}`"
            span = entry[1].span if entry else cell.span
            notes = (Note(f"they differ in {', '.join(f'`{axis}`' for axis in differing)}"),) if differing else ()
            help = f"put `${{{differing[0]}}}` into the name" if differing else "take one of the two out"
            sink.error("name-clash", message, span, notes=notes, help=help)
            return

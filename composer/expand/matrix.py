"""The section `matrix`: the combinations of variants and parameters to build, and their names."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from collections.abc import Mapping as Map

from composer.dataclass import dataclass
from composer.diagnostics.cell_name import CellName
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.unknown import unknown_key, unknown_name
from composer.document.node import Key, Mapping, Node, Scalar, Sequence
from composer.expand.expand import expand, scope_of
from composer.expand.plain import plain, same
from composer.expand.substitute import report
from composer.expr.error import ExpressionError
from composer.expr.opening import is_template
from composer.expr.template import Template
from composer.expr.value import Value, shown
from composer.limits import advice, in_force

KEYS = {
    "axes": "The values of each variant or parameter, all combinations of which are built.",
    "exclude": "Combinations that are not built.",
    "include": "More combinations.",
    "name": "What a combination is called, with `${…}` for its values.",
    "emit": "What `build --worlds` makes of combinations that have different parts: nothing, which is an error"
    " (`models`), or one model with the parts of all (`union`).",
}
"""The keys of a matrix with their meaning, in the order in which `fmt` writes them."""
EMITS = ("models", "union")


@dataclass(frozen=True, slots=True)
class Cell:
    """One combination: its name, and the value of every axis of the matrix that it sets, by name.

    `cell` is the name of the combination, None without a matrix. `sample` is the number of its sample; 0 has no
    draws. `is_sample` says that it is one of several samples.
    """

    name: str
    given: dict[str, Node]
    span: Span
    sample: int = 0
    cell: str | None = None
    is_sample: bool = False

    @property
    def label(self) -> CellName:
        """Its name in diagnostics."""
        return CellName(self.name, self.cell, self.sample if self.is_sample else None)

    def values(self) -> dict[str, Value | None]:
        return {name: plain(node) for name, node in self.given.items()}


def cells(document: Mapping, name: str, sink: Sink, given: Map[str, Node] | None = None) -> list[Cell]:
    """Return all cells of a recipe of this name, in order: the last axis changes fastest, `include` comes last.

    Without a matrix there are none. Unique names and all values are checked here, before anything is built. Other
    parameters have the value of `given`, or their default.
    """
    found = document.entries.get("matrix")
    if found is None:
        return []
    before = sink.error_count
    matrix = _Matrix(document, found, given or {}, sink=sink)
    combinations = list(matrix.combinations())
    if sink.error_count > before:
        return []
    named = [(matrix.name_of(name, given), given, span) for given, span in combinations]
    made = [Cell(each, given, span, cell=each) for each, given, span in named]
    if sink.error_count == before:
        _check_unique(made, matrix, sink)
    return made if sink.error_count == before else []


class _Matrix:
    def __init__(self, document: Mapping, entry: tuple[Key, Node], given: Map[str, Node], sink: Sink) -> None:
        self.document, self.given, self.sink = document, given, sink
        self.key, node = entry
        self.node = node if isinstance(node, Mapping) else Mapping({}, node.span)
        if not isinstance(node, Mapping):
            self._wrong("`matrix` is a mapping", node)
        for each, _ in self.node.entries.values():
            if each.name not in KEYS:
                message = f"`matrix` has no key `{each.name}`"
                sink.add(unknown_key(each.name, KEYS, each.span, message=message))
        emit = self.node.entries.get("emit")
        if emit is not None and not (isinstance(emit[1], Scalar) and emit[1].value in EMITS):
            sink.error("unknown-name", "`emit` of a matrix is `models` or `union`", emit[1].span)
        self.around: dict[str, Node] = {}
        self.axes = self._axes()

    def _wrong(self, message: str, node: Node) -> None:
        help = "write `matrix: {axes: {gripper: [small, large]}}`"
        self.sink.error("wrong-type", message, node.span, help=help)

    def _axes(self) -> dict[str, tuple[Node, ...]]:
        entry = self.node.entries.get("axes")
        if entry is None:
            self.sink.error("missing-key", "`matrix` lacks `axes`", self.key.span,
                            help="write `matrix: {axes: {gripper: [small, large]}}`")  # fmt: skip
            return {}
        if not isinstance(entry[1], Mapping):
            self._wrong("`axes` is a mapping from variants and parameters to lists of values", entry[1])
            return {}
        axes: dict[str, tuple[Node, ...]] = {}
        for key, values in entry[1].entries.values():
            if not isinstance(values, Sequence) or not values.items:
                got = "an empty list" if isinstance(values, Sequence) else "no list"
                self._wrong(f"axis `{key.name}` is a list of values, got {got}", values)
                continue
            axes[key.name] = values.items
        self.around = self._around(axes)
        for axis, items in axes.items():
            for value in items:  # check each alone: does the name exist, and may it have that value?
                concrete = expand(self.document, {**self.around, axis: value}, self.sink)
                if axis not in concrete.parameters and axis not in concrete.variants:
                    break  # reported, and the same for all its values
        return axes

    def _around(self, axes: Map[str, tuple[Node, ...]]) -> dict[str, Node]:
        """Return the given values, with one for each axis that is a parameter without a default.

        Every cell sets such a parameter. Unknown names are reported when a model is planned.
        """
        found = expand(self.document, self.given, Sink())
        needed = {
            axis: values[0]
            for axis, values in axes.items()
            if axis in found.parameters and found.parameters[axis].default is None
        }
        known = found.parameters.keys() | found.variants.keys()
        return {**needed, **{name: node for name, node in self.given.items() if name in known}}

    def combinations(self) -> Iterator[tuple[dict[str, Node], Span]]:
        size = 1
        for values in self.axes.values():
            size *= len(values)
        most = in_force().cells
        if size > most:
            self.sink.error(
                "limit-exceeded",
                f"the matrix has {size} cells; {most} are allowed",
                self.key.span,
                help=advice("cells", size),
            )
            return
        excluded = list(self._entries("exclude"))
        hit = [False] * len(excluded)
        for values in itertools.product(*self.axes.values()) if self.axes else ():
            given = dict(zip(self.axes, values, strict=True))
            out = False
            for index, entry in enumerate(excluded):
                if all(_same(given[key.name], node) for key, node in entry.entries.values()):
                    out = hit[index] = True
            if not out:
                yield given, self.key.span
        for entry, seen in zip(excluded, hit, strict=True):
            if not seen:
                self.sink.error("unknown-name", "no cell of the matrix is like this one to be excluded", entry.span,
                                help="its values are those of the axes, as they are written there")  # fmt: skip
        for entry in self._entries("include"):
            given = {key.name: node for key, node in entry.entries.values()}
            expand(self.document, {**self.around, **given}, self.sink)
            yield given, entry.span

    def _entries(self, name: str) -> Iterator[Mapping]:
        found = self.node.entries.get(name)
        if found is None:
            return
        if not isinstance(found[1], Sequence):
            self._wrong(f"`{name}` is a list of mappings from axes to values", found[1])
            return
        for item in found[1].items:
            if not isinstance(item, Mapping) or not item.entries:
                self._wrong(f"an item of `{name}` is a mapping from axes to values", item)
            elif name == "include" or self._are_axes(item):
                yield item

    def _are_axes(self, item: Mapping) -> bool:
        wrong = [key for key, _ in item.entries.values() if key.name not in self.axes]
        for key in wrong:
            message = f"the matrix has no axis `{key.name}`"
            self.sink.add(unknown_name("axis", key.name, self.axes, span=key.span, message=message))
        return not wrong

    def name_of(self, name: str, given: dict[str, Node]) -> str:
        scope = scope_of(self.document, {**self.given, **given})
        name = settled_name(name, scope)
        entry = self.node.entries.get("name")
        if entry is None:
            return "-".join(
                [name, *(shown(scope[axis]) for axis in (*self.axes, *(given.keys() - self.axes.keys())))]
            )
        node = entry[1]
        if not isinstance(node, Scalar) or not isinstance(node.value, str):
            self._wrong("`name` of the matrix is text", node)
            return name
        try:
            return str(Template.parse(node.value).value({**scope, "name": name}))
        except ExpressionError as error:
            report(error, node, ["name", *scope], broken=frozenset(), sink=self.sink)
            return name


def settled_name(name: str, scope: Map[str, Value]) -> str:
    """Return a recipe's name with its expressions evaluated; their errors are reported when it is expanded."""
    try:
        return str(Template.parse(name).value(scope)) if is_template(name) else name
    except ExpressionError:
        return name


def _same(a: Node, b: Node) -> bool:
    if isinstance(a, Scalar) and isinstance(b, Scalar) and a.text == b.text:
        return True
    first, second = plain(a), plain(b)
    return first is not None and second is not None and same(first, second)


def _check_unique(made: list[Cell], matrix: _Matrix, sink: Sink) -> None:
    seen: dict[str, Cell] = {}
    for cell in made:
        other = seen.setdefault(cell.name, cell)
        if other is not cell:
            entry = matrix.node.entries.get("name")
            differing = [
                axis
                for axis in cell.given
                if not _same(cell.given[axis], other.given.get(axis, cell.given[axis]))
            ]
            sink.error(
                "name-clash",
                f"two cells of the matrix are called `{cell.name}`",
                entry[1].span if entry else cell.span,
                notes=(Note(f"they differ in {', '.join(f'`{axis}`' for axis in differing)}"),)
                if differing
                else (),
                help=f"put `${{{differing[0]}}}` into the name" if differing else "take one of the two out",
            )
            return

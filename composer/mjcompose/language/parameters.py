"""The sections `params` and `variants`, and the values that they give to expressions."""

from __future__ import annotations

import operator
import re
from collections.abc import Collection, Mapping as Map
from dataclasses import replace
from functools import cache

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, unknown_name
from mjcompose.language.columns import fault_of_columns, place_in, quoted
from mjcompose.text.expression import (
    ELEMENT,
    UNITS,
    Angle,
    DataTable,
    ExpressionError,
    RowPlace,
    Unit,
    UnknownName,
    Value,
    leaves,
    shown,
    with_leaves,
    written,
)
from mjcompose.text.merge import Path, is_of_elements, merge
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, is_template, walk

# Names that expressions in `edit` define, and names that readers would confuse with parts of the language.
RESERVED = frozenset({"name", "value", "index", "parent", "base"})
_NAME = re.compile(r"[^\W\d]\w*")


def is_usable(key: Key, what: str, sink: Sink) -> bool:
    """Return whether an expression can use the name; `what` describes the named thing in messages."""
    from mjcompose.text.expression import CONSTANTS, FUNCTIONS, KEYWORDS

    if _NAME.fullmatch(key.name) is None:
        suggested = re.sub(r"\W", "_", key.name)
        help = f"write `{suggested}`" if _NAME.fullmatch(suggested) else None
        sink.error("bad-name", f"{what} has letters, digits and `_` in its name, got `{key.name}`", key.span, help=help)
        return False
    if key.name in RESERVED or key.name in KEYWORDS or key.name in FUNCTIONS or key.name in CONSTANTS:
        message = f"`{key.name}` has a meaning of its own in expressions and cannot name {what}"
        sink.error("bad-name", message, key.span, help=f"write for instance `{key.name}_`")
        return False
    return True


def plain(node: Node) -> Value | None:
    """Return the value of a scalar, a list, or a mapping, which is a table; None for null, or null inside."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, Sequence):
        items = tuple(value for item in node.items if (value := plain(item)) is not None)
        return items if len(items) == len(node.items) else None
    rows = {name: value for name, (_, row) in node.entries.items() if (value := plain(row)) is not None}
    if len(rows) < len(node.entries):
        return None
    return DataTable(rows, {name: RowPlace(key.span, row.span) for name, (key, row) in node.entries.items()})


def node_of(value: Value, span: Span) -> Node:
    """Return a node with this value and place."""
    if isinstance(value, tuple):
        return Sequence(tuple(node_of(item, span) for item in value), span)
    if isinstance(value, DataTable):
        return Mapping({name: (Key(name, span), node_of(item, span)) for name, item in value.items()}, span)
    if isinstance(value, Angle):
        text = str(written(value))
        return Scalar(text, span, text, plain=False)
    return Scalar(value, span, shown(value), plain=not isinstance(value, str))


def same(a: Value, b: Value) -> bool:
    """Return whether two values are equal; `true` is not 1.

    >>> same(1, 1.0), same(True, 1), same((1, 2), (1.0, 2))
    (True, False, True)
    """
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, DataTable) and isinstance(b, DataTable):
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    if isinstance(a, Angle) and isinstance(b, Angle):
        return a.compared_to(b) == 0
    return isinstance(a, bool) == isinstance(b, bool) and a == b


def in_unit(value: Value, unit: Unit) -> Value:
    """Return the value with the number in that unit for each angle. Bare numbers are in that unit already.

    >>> in_unit(("180deg", 1), "rad")
    (3.141592653589793, 1)
    """

    def number(single: Value) -> Value:
        angle = _angle(single)
        return angle.in_unit(unit) if isinstance(angle, Angle) else single

    return with_leaves(value, number)


def with_unit(value: Value, unit: Unit) -> Value:
    """Return the value with an angle in that unit for each bare number."""

    def angle(single: Value) -> Value:
        if isinstance(single, int | float) and not isinstance(single, bool):
            return Angle(single, unit)
        return single

    return with_leaves(value, angle)


def with_angles(value: Value) -> Value:
    """Return the value with an angle for each text that is one, such as `30deg`."""
    return with_leaves(value, _angle)


def _angle(value: Value) -> Value:
    """Return the angle that a text writes; other values stay."""
    return (Angle.read(value) or value) if isinstance(value, str) else value


class Parameter(Struct):
    """A parameter of a recipe.

    `low` and `high` bound numbers and every component of a vector; a parameter with `default` None must be given.
    `unit` is for readers, except `deg` and `rad`: then every number of the value is an angle, and `low`, `high` and
    `choices` are numbers in that unit. A list or a table may also have angles that are written with their unit.
    `columns` are the columns of every row of a table, None if its first row declares them.
    """

    name: str
    type: str
    default: Value | None
    span: Span
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    length: int | None = None
    unit: str | None = None
    doc: str = ""
    columns: tuple[str, ...] | None = None

    @property
    def is_angle(self) -> bool:
        return self.unit in ("deg", "rad")

    def read(self, value: Value) -> Value | Diagnostic:
        """Return the value, in which every number of an angle is an `Angle` in its unit, or the error about it."""
        plain = self._plain(value)
        fault = self._fault(plain)
        return self._quantity(plain) if fault is None else fault

    def _fault(self, value: Value) -> Diagnostic | None:
        fault = (
            self._fault_of_type(value)
            or self._fault_of_choice(value)
            or self._fault_of_length(value)
            or self._fault_of_bounds(value)
        )
        if fault is not None:
            return fault
        default = None if self.default is None else self._plain(self.default)
        return fault_of_columns(self.name, value, self.columns, default)

    def _fault_of_type(self, value: Value) -> Diagnostic | None:
        if _has_type(value, self.type):
            return None
        help = "declare it as `{type: float, …}` to allow any number" if self.type == "int" else None
        angle = Angle.read(value) if isinstance(value, str) else None
        if angle is not None:
            help = f"declare it as an angle: `{self.name}: {{unit: {angle.unit}, …}}`"
        message = f"parameter `{self.name}` is {_NOUNS[self.type]}, got {quoted(value)}"
        return Diagnostic("wrong-type", message, help=help)

    def _fault_of_choice(self, value: Value) -> Diagnostic | None:
        if not self.choices or any(self._same(value, choice) for choice in self.choices):
            return None
        known = [self._shown(choice) for choice in self.choices]
        listed = ", ".join(f"`{choice}`" for choice in known)
        help = did_you_mean(self._shown(value), known)
        message = f"parameter `{self.name}` is one of {listed}, got {quoted(value)}"
        return Diagnostic("out-of-range", message, help=help)

    def _fault_of_length(self, value: Value) -> Diagnostic | None:
        if not isinstance(value, tuple) or self.length is None or len(value) == self.length:
            return None
        noun = "numbers" if self.type == "vector" else "values"
        return Diagnostic("wrong-length", f"parameter `{self.name}` has {self.length} {noun}, got {len(value)}")

    def _fault_of_bounds(self, value: Value) -> Diagnostic | None:
        for number in leaves(value):
            if isinstance(number, bool) or not isinstance(number, (int, float)):
                continue
            for bound, word, beyond in ((self.low, "least", operator.lt), (self.high, "most", operator.gt)):
                if bound is not None and beyond(number, bound) and not self._same(number, bound):
                    message = f"parameter `{self.name}` is at {word} {self._shown(bound)}, got {self._shown(number)}"
                    return Diagnostic("out-of-range", message, place_in(value, number))
        return None

    def _plain(self, value: Value) -> Value:
        """Return the value with the numbers of angles in the unit of the parameter."""
        if self.is_angle:
            return in_unit(value, UNITS[str(self.unit)])
        return with_angles(value) if self.type in _MIXED else value

    def _quantity(self, value: Value) -> Value:
        return with_unit(value, UNITS[str(self.unit)]) if self.is_angle else value

    def _same(self, a: Value, b: Value) -> bool:
        """Return whether two values are equal, and of angles whether only the change of a unit rounds them."""
        return same(self._quantity(a), self._quantity(b)) if self.is_angle else a == b

    def _shown(self, value: Value) -> str:
        return shown(value) + (str(self.unit) if self.is_angle and isinstance(value, int | float) else "")


_NOUNS = {
    "bool": "`true` or `false`",
    "int": "a whole number",
    "float": "a number",
    "string": "text",
    "vector": "a list of numbers",
    "list": "a list of values",
    "table": "a table, a mapping from names to rows",
}
_MIXED = ("list", "table")
"""The types whose values have single values of any type."""


def _has_type(value: Value, type: str) -> bool:
    if type == "bool" or isinstance(value, bool):
        return type == "bool" and isinstance(value, bool)
    if type == "int":
        return isinstance(value, int)
    if type == "float":
        return isinstance(value, (int, float))
    if type == "string":
        return isinstance(value, str)
    if type == "table":
        return isinstance(value, DataTable)
    if type == "list":
        return isinstance(value, tuple)
    return isinstance(value, tuple) and all(_has_type(each, "float") for each in value)


def settle(
    parameters: Map[str, Parameter], given: Map[str, Node], sink: Sink, in_cells: Collection[str] = ()
) -> dict[str, Value]:
    """Return the value of every parameter: the given value, or its default, which also replaces faulty values.

    A parameter without a default that is not given has no value. The cells of a matrix set the parameters `in_cells`.
    """
    scope = {name: each.default for name, each in parameters.items() if each.default is not None}
    for name, parameter in parameters.items():
        node = given.get(name)
        if node is None:
            if parameter.default is None:
                cells = "with `--all` the cells of the matrix, which set it, " if name in in_cells else ""
                option = f"--set-file {name}=FILE" if parameter.type == "table" else f"--set {name}=…"
                help = f"build with `{option}`, {cells}or write `with: {{{name}: …}}` where the recipe is used"
                message = f"parameter `{name}` has no default and must be given"
                sink.error("missing-key", message, parameter.span, help=help)
            continue
        value = plain(node)
        answer = _missing(name, node) if value is None else parameter.read(value)
        if isinstance(answer, Diagnostic):
            notes = (*answer.notes, Note("the parameter is declared here", parameter.span))
            sink.add(replace(answer, span=answer.span or node.span, notes=notes))
        else:
            scope[name] = answer
    return scope


def _missing(name: str, node: Node) -> Diagnostic:
    """Return the error about a value that is null, or has null in it."""
    if isinstance(node, Scalar):
        return Diagnostic("wrong-type", f"parameter `{name}` is a value")
    empty = next(each.node for each in walk(node) if isinstance(each.node, Scalar) and each.node.value is None)
    return Diagnostic("wrong-type", f"a value of parameter `{name}` is missing", empty.span)


# Keys that belong to the recipe as a whole, and not to a piece of it.
NO_PIECE = ("recipe", "extends", "trust", "variants", "matrix", "separator", "angle", "eulerseq")

Axes = dict[str, Mapping]


def read_axes(document: Mapping, sink: Sink) -> Axes:
    """Return each axis with its pieces by value, without faulty ones."""
    entry = document.entries.get("variants")
    if entry is None:
        return {}
    help = "write `variants: {gripper: {small: {…}, large: {…}}}`"
    if not isinstance(entry[1], Mapping):
        words = _words(entry[1])
        if words:
            help = f"write `variants: {{AXIS: {_pieces(words)}}}`"
        sink.error("wrong-type", "`variants` is a mapping from axes to their values", entry[1].span, help=help)
        return {}
    axes: Axes = {}
    for key, values in entry[1].entries.values():
        if not is_usable(key, "a variant", sink):
            continue
        if not isinstance(values, Mapping) or not values.entries:
            message = f"variant `{key.name}` is a mapping from its values to pieces of recipe"
            words = _words(values)
            own = f"write `{key.name}: {_pieces(words)}`, each with its changes" if words else help
            sink.error("wrong-type", message, key.span, help=own)
            continue
        axes[key.name] = values
        for value, piece in values.entries.values():
            if not isinstance(piece, Mapping):
                message = f"`{value.name}` of variant `{key.name}` is a piece of recipe, a mapping"
                help = f"write `{value.name}: {{}}` for one that changes nothing"
                sink.error("wrong-type", message, value.span, help=help)
                continue
            if piece.entries.keys().isdisjoint(NO_PIECE):
                continue
            for name in NO_PIECE:
                if name in piece.entries:
                    sink.error(
                        "unknown-key",
                        f"`{name}` is not allowed in a variant",
                        piece.entries[name][0].span,
                        help="write it at the top of the recipe",
                    )
    return axes


def _words(node: Node) -> list[str]:
    items = node.items if isinstance(node, Sequence) else (node,)
    texts = [item.text for item in items if isinstance(item, Scalar) and item.text]
    return texts if len(texts) == len(items) else []


def _pieces(values: list[str]) -> str:
    return f"{{{', '.join(f'{value}: {{}}' for value in values)}}}"


def choose(axes: Axes, given: Map[str, Node], sink: Sink) -> dict[str, str]:
    """Return the value of every axis: the given value, or the first value."""
    chosen: dict[str, str] = {}
    for axis, values in axes.items():
        node = given.get(axis)
        if node is None:
            chosen[axis] = next(iter(values.entries))
            continue
        value = node.text if isinstance(node, Scalar) else ""
        if value in values.entries:
            chosen[axis] = value
            continue
        no_value(axis, value, values, node=node, sink=sink)
    return chosen


def no_value(axis: str, value: str, values: Mapping, node: Node, sink: Sink) -> None:
    """Report that an axis does not have a value."""
    message = f"variant `{axis}` has no value `{value}`"
    sink.add(unknown_name("value", value, values.entries, span=node.span, message=message))


def merged(document: Mapping, axes: Axes, chosen: Map[str, str], sink: Sink) -> Mapping:
    """Merge the chosen pieces over the recipe, in the order of their axes."""
    for axis, value in chosen.items():
        piece = axes[axis].entries[value][1]
        if isinstance(piece, Mapping):
            permitted = {name: entry for name, entry in piece.entries.items() if name not in NO_PIECE}
            document = merge(document, Mapping(permitted, piece.span), sink)
    return document


_XML = "xml"  # the key of a fragment of MJCF, in which numbers have no unit


class Turn(Struct):
    """One turn of a `for`: the values of its names and of the names of entries around it, and their text."""

    values: Map[str, Value]
    text: str

    @classmethod
    def of(cls, values: Map[str, Value]) -> Turn:
        return cls(values, ", ".join(f"`{name}` is {shown(value)}" for name, value in values.items()))


class Turned(Mapping):
    """An entry that a turn of a `for` has made: its conditions and expressions are settled."""


class Substitution:
    """Evaluates expressions; `lost` has the keys and texts omitted because of faults, and `gone` their paths.

    `turn` is the turn of the entry. Expressions that are evaluated for each element get its values now.
    """

    def __init__(self, scope: Map[str, Value], broken: frozenset[str], sink: Sink, turn: Turn | None = None) -> None:
        self.scope = scope
        self.broken = broken
        self.sink = sink
        self.turn = turn
        self.lost: set[str] = set()
        self.gone: set[Path] = set()

    def of(self, node: Node, path: Path = ()) -> Node | None:
        """Return the node with its expressions evaluated, or None if its own value is faulty."""
        if isinstance(node, Turned) or (self.turn is None and is_of_elements(path)):
            return node
        if isinstance(node, Scalar):
            if self.turn is not None and is_of_elements(path):
                return self._bound(node, self.turn)
            return self._scalar(node, is_markup=path[-1:] == (_XML,))
        if isinstance(node, Sequence):
            items = [self.of(item, (*path, index)) for index, item in enumerate(node.items)]
            if any(item is None for item in items):  # a list without one of its values would be another list
                return None
            return Sequence(tuple(item for item in items if item is not None), node.span)
        entries: dict[str, tuple[Key, Node]] = {}
        for name, (key, value) in node.entries.items():
            found = self.of(value, (*path, name))
            if found is None:
                self.lost.add(name)
                self.gone.add((*path, name))
            else:
                entries[name] = (self._in_turn(key) if isinstance(found, Mapping) else key, found)
        return Mapping(entries, node.span if self.turn is None else node.span.repeated(self.turn.text))

    def _in_turn(self, key: Key) -> Key:
        """Return the key of an element or of settings, whose place also says the turn."""
        return key if self.turn is None else Key(key.name, key.span.repeated(self.turn.text))

    def _scalar(self, node: Scalar, is_markup: bool) -> Node | None:
        if not isinstance(node.value, str) or not is_template(node.value):
            return node
        from mjcompose.text.evaluate import Template  # most recipes have no expression

        span = node.span if self.turn is None else node.span.repeated(self.turn.text)
        try:
            template = Template.parse(node.value)
            value = template.markup(self.scope) if is_markup else template.value(self.scope)
            span = span.taken_from(template.place(self.scope))
        except ExpressionError as error:
            self._report(error, replace(node, span=span))
            return None
        return node_of(value, span)

    def _bound(self, node: Scalar, turn: Turn) -> Node | None:
        """Return a text that is evaluated for each element, with the values of the turn."""
        if not isinstance(node.value, str) or not is_template(node.value):
            return node
        from mjcompose.text.evaluate import Template, bound, keys_in

        span = node.span.repeated(turn.text)
        try:
            names = keys_in(node.value)
            self._check_names(node.value)
            if names.isdisjoint(turn.values):
                return replace(node, span=span)
            known = {name: self.scope[name] for name in names if self._is_same_for_all(name, turn)}
            if len(known) == len(names):
                template = Template.parse(node.value)
                value = template.value(known)
                if _is_final(value):
                    return node_of(value, span.taken_from(template.place(known)))
            text = bound(node.value, turn.values, known)
        except ExpressionError as error:
            self._report(error, replace(node, span=span))
            return None
        return Scalar(text, span, text, plain=False)

    def _check_names(self, text: str) -> None:
        """Raise `ExpressionError` for a name that nothing has: no turn, parameter or element."""
        from mjcompose.text.evaluate import Template
        from mjcompose.text.expression import CONSTANTS

        for name in Template.parse(text).names():
            known = name.name in self.scope or name.name in _attributes() or name.name in {*RESERVED, *CONSTANTS}
            if not name.space and not known:
                raise UnknownName(name.name, name.at)

    def _is_same_for_all(self, name: str, turn: Turn) -> bool:
        """Return whether a name of the turn, or one that is not an attribute, means the same for every element."""
        return name in turn.values or (name in self.scope and name not in _attributes())

    def _report(self, error: ExpressionError, node: Scalar) -> None:
        self.lost.add(node.text)
        report(error, node, [*self.scope], broken=self.broken, sink=self.sink)


def _is_final(value: Value) -> bool:
    """Return whether a value means the same without `${…}`: a condition needs these, and a text must not have any."""
    if isinstance(value, bool | DataTable):
        return False
    return not any(isinstance(each, str) and is_template(each) for each in leaves(value))


@cache
def _attributes() -> frozenset[str]:
    """Return all names of attributes: in an edit, such a name may be an attribute of the element."""
    from mjcompose.tree.grammar import GRAMMAR

    return frozenset(name for path in GRAMMAR.paths for name in GRAMMAR.element(path).attributes)


def report(error: ExpressionError, node: Scalar, known: list[str], broken: frozenset[str], sink: Sink) -> None:
    """Report an error in an expression, at its place in the scalar; errors about a `broken` name are follow-ups."""
    if isinstance(error, UnknownName) and error.name in broken:
        return
    span = within(node, *error.at)
    if not isinstance(error, UnknownName):
        sink.error("expression", error.message, span, help=error.help)
        return
    if error.space == ELEMENT:
        message = f"`{ELEMENT}.{error.name}` is an attribute of an element, and only `edit` has elements"
        sink.error("expression", message, span, help=f"write `{error.name}` for the parameter")
        return
    declared = f"declare it: `params: {{{error.name}: …}}`"
    sink.add(unknown_name("parameter", error.name, known, span=span, otherwise=declared))


def within(node: Scalar, start: int, end: int) -> Span:
    """Return the place of characters of a scalar's text, or of the scalar if the file writes them differently."""
    span = node.span
    if span.end_line not in (None, span.line) or span.end_column is None:
        return span
    quotes = span.end_column - span.column - len(node.text)
    if quotes not in (0, 2):
        return span
    first = span.column + quotes // 2
    last = first + max(end, start + 1)
    return replace(span, column=first + start, end_line=span.line, end_column=last, template=None, source=None)

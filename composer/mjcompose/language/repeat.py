"""Repeat entries of a recipe: `for` makes one entry for each combination of its values."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping as Map, Sequence as Values
from dataclasses import replace
from typing import Final, NamedTuple

from mjcompose.base.diagnostic import Note
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.language.columns import quoted
from mjcompose.language.condition import WHEN, Condition, has_items_below, is_item
from mjcompose.language.left_out import LeftOut
from mjcompose.language.parameters import Axes, Substitution, Turn, Turned, is_usable, plain, report, with_angles
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import DataTable, ExpressionError, Value, kind, shown
from mjcompose.text.merge import Path, in_own_model
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, find, is_template, walk

FOR: Final = "for"
_HELP = "write `for: {i: 3}` for 0, 1 and 2, or `for: {side: [left, right]}`"


def has_repetitions(node: Node) -> bool:
    return any(isinstance(each, Mapping) and FOR in each.entries and is_item(path) for path, _, each in walk(node))


def misplaced_names(node: Node) -> frozenset[str]:
    """Return the names of each `for` that is where none can be, which is an error."""
    found = [
        each.node.entries[FOR][1]
        for each in walk(node)
        if isinstance(each.node, Mapping) and FOR in each.node.entries and not is_item(each.path)
    ]
    return frozenset(name for names in found if isinstance(names, Mapping) for name in names.entries)


class _Entry(NamedTuple):
    """An entry that is repeated, without its `for`; the key is None in a list."""

    node: Mapping
    path: Path
    key: Key | None
    repeats: bool
    """Whether it has an inner `for`."""
    chooses: bool
    """Whether it has an inner `when`."""


class Repeater:
    """Repeats the entries of a recipe that have `for`; `lost` has names that are left out because of errors.

    `scope` has the values of parameters and variants. With `any`, conditions about these leave nothing out.
    """

    def __init__(
        self, scope: Map[str, Value], axes: Axes, broken: frozenset[str], sink: Sink, any: bool = False
    ) -> None:
        self.scope = scope
        self.axes = axes
        self.broken = broken
        self.sink = sink
        self.any = any
        self.lost: set[str] = set()
        self.left_out: list[LeftOut] = []
        self._made = 0

    def repeated(self, document: Mapping) -> Mapping:
        repeated = self._inside(document, (), {})
        assert isinstance(repeated, Mapping)
        return repeated

    def _inside(self, node: Node, path: Path, around: Map[str, Value]) -> Node:
        """Return a node with its entries repeated; `around` has the values of entries that contain it."""
        if not has_items_below(path):
            return node
        if isinstance(node, Sequence):
            items: list[Node] = []
            for index, item in enumerate(node.items):
                items += [made for _, made in self._entries(None, item, (*path, index), around)]
            return Sequence(tuple(items), node.span)
        if isinstance(node, Mapping):
            entries: dict[str, tuple[Key, Node]] = {}
            for name, (key, value) in node.entries.items():
                for own, made in self._entries(key, value, (*path, name), around):
                    assert own is not None
                    self._add(entries, own, made)
            return Mapping(entries, node.span)
        return node

    def _entries(
        self, key: Key | None, node: Node, path: Path, around: Map[str, Value]
    ) -> Iterator[tuple[Key | None, Node]]:
        """Yield a value with its key, or the entries that its `for` makes."""
        if not isinstance(node, Mapping) or FOR not in node.entries or not is_item(path):
            yield key, self._inside(node, path, around)
            return
        turns = self.turns(*node.entries[FOR], path, around)
        if turns is None:
            self._lose(node, key)
            return
        if not turns:
            self.left_out.append(LeftOut(path, node, FOR, node.entries[FOR][1], {**self.scope, **around}))
        entry = _marked(node)
        size = sum(1 for _ in walk(entry))
        most = in_force().yaml_values
        if self._made + size * len(turns) > most:
            message = f"`{FOR}` makes more than {most} values"
            self.sink.error("limit-exceeded", message, node.entries[FOR][0].span, help=advice("yaml-values"))
            self._lose(node, key)
            return
        self._made += size * len(turns)
        inner = [each.node.entries for each in walk(entry) if isinstance(each.node, Mapping)]
        repeats, chooses = (any(word in entries for entries in inner) for word in (FOR, WHEN))
        written = _Entry(entry, path, key, repeats=repeats, chooses=chooses)
        names = set[str]()
        for turn in turns:
            own, made = self._turned(written, Turn.of({**around, **turn}))
            if made is None:
                continue
            if own is not None and own.name in names:
                self.sink.error("name-clash", f"`{FOR}` makes `{own.name}` twice", own.span, help=_apart(key, turn))
                continue
            names.update([] if own is None else [own.name])
            yield own, made

    def turns(self, key: Key, node: Node, path: Path, around: Map[str, Value]) -> list[dict[str, Value]] | None:
        """Return the values of each turn by name, or None after an error."""
        inside = in_own_model(path)
        if len(inside) == 1:
            message = f"`{FOR}` repeats an entry, and there is one `{inside[0]}`"
            self.sink.error("wrong-type", message, key.span, help=f"remove `{FOR}`")
            return None
        if not isinstance(node, Mapping) or not node.entries:
            message = f"`{FOR}` is a mapping from names to values"
            self.sink.error("wrong-type", message, key.span, help=_HELP)
            return None
        values: dict[str, Values[Value] | int] = {}
        for name, written in node.entries.values():
            listed = self._values(written, around) if self._is_free(name, around) else None
            if listed is not None:
                values[name.name] = listed
        if len(values) < len(node.entries):
            return None
        size = math.prod(map(_count, values.values()))
        most = in_force().copies
        if size > most:
            message = f"`{FOR}` has {size} turns; {most} are allowed"
            self.sink.error("limit-exceeded", message, key.span, help=advice("copies", size))
            return None
        combinations = itertools.product(*(_listed(value) for value in values.values()))
        return [dict(zip(values, combination, strict=True)) for combination in combinations]

    def _is_free(self, key: Key, around: Map[str, Value]) -> bool:
        """Return whether a name can have values, or report that it has another meaning."""
        if key.name in around:
            what = f"a name of the `{FOR}` around it"
        elif key.name in self.scope or key.name in self.broken:
            what = "a variant" if key.name in self.axes else "a parameter"
        else:
            return is_usable(key, f"a value of `{FOR}`", self.sink)
        self.sink.error("name-clash", f"`{key.name}` is {what}", key.span, help="give this one another name")
        return False

    def _values(self, node: Node, around: Map[str, Value]) -> Values[Value] | int | None:
        """Return the values of a name, or how many numbers from 0 it has; None after an error."""
        before = self.sink.error_count
        turn = Turn.of(around) if around else None
        written = Substitution({**self.scope, **around}, self.broken, self.sink, turn).of(node)
        value = None if written is None else plain(written)
        if isinstance(value, tuple):
            return [with_angles(each) for each in value]
        if isinstance(value, DataTable):
            return [*value]
        if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
            return value
        if written is not None or (self.sink.error_count == before and not self.broken):
            got = "nothing" if value is None else quoted(value)
            message = f"`{FOR}` takes a whole number, a list or a table, got {got}"
            self.sink.error("wrong-type", message, node.span, help=_HELP)
        return None

    def _turned(self, written: _Entry, turn: Turn) -> tuple[Key | None, Turned | None]:
        """Return the entry that a turn makes, with its key; None if `when` leaves it out, or after an error."""
        scope = {**self.scope, **turn.values}
        before = self.sink.error_count
        key = None if written.key is None else self._key(written.key, scope, turn)
        condition = Condition(scope, self.axes, self.broken, sink=self.sink, any=self.any, turn=turn)
        kept: Node | None = condition.item(written.node, written.path)
        if kept is not None and written.repeats:
            kept = self._inside(kept, written.path, turn.values)
        if kept is not None and written.chooses:
            kept = condition.of(kept, written.path)
        self.lost |= condition.in_doubt
        self.left_out += condition.left_out
        if kept is None:
            return key, None
        made = Substitution(scope, self.broken, self.sink, turn).of(kept, written.path)
        assert isinstance(made, Mapping)
        if self.sink.error_count > before or (key is None and written.key is not None):
            self._lose(made, key or written.key)
            return key, None
        return key, Turned(made.entries, made.span)

    def _key(self, key: Key, scope: Map[str, Value], turn: Turn) -> Key | None:
        span = key.span.repeated(turn.text)
        if not is_template(key.name):
            return Key(key.name, span)
        try:
            name = Template.parse(key.name).value(scope)
        except ExpressionError as error:
            report(error, Scalar(key.name, span, key.name, plain=False), [*scope], self.broken, self.sink)
            return None
        if isinstance(name, tuple | DataTable):
            self.sink.error("expression", f"a name is text, got {kind(name)}", span, help="write which item of it")
            return None
        return Key(shown(name), span)

    def _add(self, entries: dict[str, tuple[Key, Node]], key: Key, node: Node) -> None:
        """Add an entry, or report that its name exists."""
        other = entries.get(key.name)
        if other is None:
            entries[key.name] = key, node
            return
        if self.any:  # the two may belong to different builds
            return
        repeated, rest = (key, other[0]) if isinstance(node, Turned) else (other[0], key)
        self.sink.error(
            "name-clash",
            f"`{key.name}` exists already, and `{FOR}` makes it",
            repeated.span,
            notes=[Note("the other one", rest.span)],
            help=f"give one of them another name, or leave this turn out by `{WHEN}`",
        )

    def _lose(self, node: Node, key: Key | None) -> None:
        """Suppress errors about names of an entry that has errors."""
        self.lost.update(each.node.text for each in walk(node) if isinstance(each.node, Scalar))
        if key is not None:
            self.lost.add(key.name)


def _count(values: Values[Value] | int) -> int:
    return values if isinstance(values, int) else len(values)


def _listed(values: Values[Value] | int) -> Values[Value]:
    return range(values) if isinstance(values, int) else values


def _apart(key: Key | None, turn: Map[str, Value]) -> str:
    """Return the help for a key that is the same in several turns."""
    used = {each.name for each in Template.parse(key.name).names()} if key is not None else set()
    absent = next((name for name in reversed([*turn]) if name not in used), None)
    return "write each value once" if absent is None else f"put `${{{absent}}}` into the name"


def _marked(entry: Mapping) -> Mapping:
    """Return an entry without its `for`, whose places say that a `for` repeats them."""
    marked = _repeated(Mapping({name: each for name, each in entry.entries.items() if name != FOR}, entry.span))
    assert isinstance(marked, Mapping)
    return marked


def _repeated(node: Node) -> Node:
    span = node.span.repeated("")
    if isinstance(node, Scalar):
        return replace(node, span=span)
    if isinstance(node, Sequence):
        return Sequence(tuple(map(_repeated, node.items)), span)
    entries = {
        name: (Key(key.name, key.span.repeated("")), _repeated(value)) for name, (key, value) in node.entries.items()
    }
    return Mapping(entries, span)


def turns_at(document: Mapping, path: Path, scope: Map[str, Value]) -> Iterator[dict[str, Value]]:
    """Yield the values that the names of each `for` around a path have, turn by turn; errors are reported elsewhere.

    `scope` has the values of parameters and variants. The path of a name of a `for` has the turns around that `for`.
    """
    repeater = Repeater(scope, {}, frozenset(), Sink())
    yield from _turns_below(repeater, document, path, 1, {})


def _turns_below(
    repeater: Repeater, document: Mapping, path: Path, length: int, around: dict[str, Value]
) -> Iterator[dict[str, Value]]:
    for size in range(length, len(path) + 1):
        entry = find(document, path[:size])
        if not isinstance(entry, Mapping) or FOR not in entry.entries or not is_item(path[:size]):
            continue
        if path[size : size + 1] == (FOR,):
            break
        for turn in repeater.turns(*entry.entries[FOR], path[:size], around) or []:
            yield from _turns_below(repeater, document, path, size + 1, {**around, **turn})
        return
    yield around

"""The context of an edit: the model, its names, its selected elements, and the cost of editing."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field, replace
from functools import cache, cached_property, lru_cache
from pathlib import Path as PathlibPath
from typing import Any, NamedTuple

from lxml.etree import _Element as Node
from pydantic import BaseModel

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Fix, Note, Path, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import advice, in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.base.words import counted, element_text
from mjcompose.compose.actuators import ActuatorModel
from mjcompose.compose.effects import may_be_idle
from mjcompose.compose.elements import ElementBuilder
from mjcompose.compose.values import EntryValues, UnusableValue, matches_value
from mjcompose.language.datasheets import Sheet
from mjcompose.language.value import attribute_and_index
from mjcompose.link.key_layout import JOINTS
from mjcompose.link.linking import Linking
from mjcompose.link.submodels import add_named_file
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ELEMENT, PARAMETERS, ExpressionError, Value, Variable
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.classes import Classes, text_in_effect
from mjcompose.tree.edit import changing, names_in
from mjcompose.tree.files import written_path
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.names import WORLD, NameIndex
from mjcompose.tree.pattern import BadPattern, Selector, is_glob, is_pattern, is_regular, matcher, paths_of
from mjcompose.tree.select import Selection, kind_of, name_of, section_of
from mjcompose.tree.unit import RecipeValue

# Measured: in the 0.1 ms in which a value is written, a selector visits 30 elements, and 100 values are drawn, or 30
# for a table. A condition takes half of that, and as much again for 50 characters. A regular expression may take 2 s,
# and costs 500 values.
_LOOKS = 30
_CONDITION = 0.5
_CHARACTERS = 100
_EXPRESSION = 500
_DRAWS = 100
_DRAWS_OF_A_TABLE = 30


class EditCost(Struct, frozen=False):
    """The cost of all edits so far, in units of the time to write one value; `ended` is set beyond the limit."""

    spent: float = 0
    ended: bool = False

    def allows(self, cost: float, sink: Sink, span: Span) -> bool:
        """Add a cost. Return False if the limit is exceeded, which is reported the first time."""
        self.spent += cost
        most = in_force().edits
        if self.spent > most and not self.ended:
            self.ended = True
            message = f"the edits up to here cost as much as {self.spent:.0f} values; {most} are allowed"
            sink.error("limit-exceeded", message, span, help=advice("edits", max(2 * most, int(self.spent) + 1)))
        return not self.ended


def cost_of_selecting(selector: Selector, selection: Selection) -> float:
    selectors = list(selector.all())
    looks = 0 if selector.is_one_name else len(selectors) * selection.looks(selector)
    expressions = sum(is_regular(name) for each in selectors for name in (each.pattern, each.dclass or ""))
    return _EXPRESSION * expressions + looks / _LOOKS


def count_values(value: Any) -> int:
    """Return the number of values that an entry writes for each element.

    >>> from mjcompose.language.verbs.set import Set
    >>> count_values({"set": Set.model_validate({"size": [0.1, 0.2], "rgba": [1, 0, 0, 1]})})
    2
    """
    if isinstance(value, BaseModel):
        return sum(count_values(getattr(value, name)) for name in value.model_fields_set)
    return sum(map(count_values, value.values())) if isinstance(value, Mapping) else 1


def cost_of_draws(samples: int, tabled: bool) -> float:
    """Return the cost of checking the draws of all samples for one element, and of tabulating them."""
    return 1 + samples / (_DRAWS_OF_A_TABLE if tabled else _DRAWS)


_LAID_OUT = (*JOINTS, "default")
_FIRST_SELECTIONS = 8


@dataclass(eq=False)
class Editing:
    """A model that is edited, one unit alone or the flat one, with the part of each element."""

    linking: Linking
    making: ElementBuilder
    scope: Mapping[str, Value] = field(default_factory=dict)
    parts: Mapping[Node, str] = field(default_factory=dict)
    own: bool = False
    cost: EditCost = field(default_factory=EditCost)
    datasheets: Mapping[str, Sheet] = field(default_factory=dict)
    selections: int = 0
    actuator_models: dict[Node, ActuatorModel] = field(default_factory=dict)
    """The measured behavior of actuators that no edit has changed since."""

    def __post_init__(self) -> None:
        self.linking.keys.edited = True

    @property
    def root(self) -> Node:
        return self.linking.base.root

    @property
    def sink(self) -> Sink:
        return self.making.sink

    @property
    def classes(self) -> Classes:
        return self.linking.base.classes

    @cached_property
    def names(self) -> NameIndex:
        """The index of the model's names and references. After the first access, linking uses it too."""
        index = NameIndex.of(self.root)
        self.linking.names.declared = index.declared
        return index

    def levels(self) -> Iterator[tuple[Editing, str]]:
        """Yield only the model itself, which is not attached to anything."""
        yield self, ""

    def find_node(self, namespace: str, name: str) -> Node | None:
        return self.names.find(namespace, name)

    @property
    def index(self) -> NameIndex | None:
        """Return the index of names, or None for the first selections: one search is quicker than an index."""
        self.selections += 1
        return self.names if self.selections > _FIRST_SELECTIONS or "names" in vars(self) else None

    def in_part(self, part: str) -> list[Node]:
        """Return the elements of a part and of its parts, which may have been removed, in any order."""
        return self._of_parts.get(part, [])

    @cached_property
    def _of_parts(self) -> dict[str, list[Node]]:
        """The elements by the name of their part, as written with either separator."""
        found: dict[str, list[Node]] = {}
        names: dict[str, set[str]] = {}
        for node, part in self.parts.items():
            if part not in names:
                levels = part.split("/")
                paths = [levels[:depth] for depth in range(1, len(levels) + 1)]
                separators = ("/", self.linking.request.separator)
                names[part] = {separator.join(path) for path in paths for separator in separators}
            for name in names[part]:
                found.setdefault(name, []).append(node)
        return found

    def known_names(self, namespace: str) -> list[str]:
        return list(self.names.declared.get(namespace, ()))

    def kinds_of(self, name: str) -> list[str]:
        return self.linking.kinds_of(name)

    def may_generate(self, name: str) -> bool:
        return self.linking.may_generate(name)

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        """Return the namespace and name of everything in an element's subtree."""
        return names_in(node)

    def forget(self, node: Node) -> None:
        """Remove the names of a node from the index before the node changes."""
        self.names.forget(node, section_of(node))

    def note(self, node: Node) -> None:
        """Add the names of a changed node to the index, and record the other effects of the change."""
        self.names.note(node, section_of(node))
        self._has_changed(node)

    @contextmanager
    def writing(self, node: Node, attribute: Attribute) -> Iterator[None]:
        """Keep the facts about a node up to date while an attribute of it is written."""
        if not attribute.is_number:
            with changing(self, node):
                yield
            return
        yield  # numbers are not names, so the index is not needed, which needs a walk over the model
        if node.tag == "key":
            self.linking.keys.edited_keys.add(node)
        self._has_changed(node)

    def _has_changed(self, node: Node) -> None:
        if section_of(node) == "default":
            self.linking.base.forget_classes()
        if node.tag in _LAID_OUT or section_of(node) in ("default", "actuator"):
            self.reshaped(node)
        for flex in (node, *node.iterancestors("flexcomp")):  # its grid, pins, degrees of freedom
            if flex.tag == "flexcomp":
                self.reshaped(flex)

    def reshaped(self, node: Node) -> None:
        """Record that the number of values that a node has in a key may have changed. A class may affect any node."""
        changed = self.linking.keys.reshaped
        changed.add(node)
        if section_of(node) == "default":
            for section in self.root.iterchildren("worldbody", "actuator"):
                changed.update(section.iter(*JOINTS) if section.tag == "worldbody" else section.iterchildren("*"))

    def effective(self, node: Node, name: str) -> str | None:
        """Return the effective text of an attribute: the written text, a class's text, or MuJoCo's default."""
        return text_in_effect(node, kind_of(node), name, classes=self.classes)

    def called(self, node: Node) -> str:
        if node.tag == "worldbody":
            return f"`{WORLD}`"
        name = name_of(node)
        tag = "default class" if node.tag == "default" else str(node.tag)
        return element_text(tag, name)

    def subjects(self, node: Node) -> tuple[str, ...]:
        name = name_of(node)
        return (name,) if name else ()

    def span(self, path: Path, key: bool = False) -> Span:
        return locate(self.making.document, path, key=key)

    def span_of(self, node: Node, attribute: str | None = None) -> Span:
        return self.linking.span(self.linking.base, node, attribute)

    def note_value(self, node: Node, attribute: str, at: Path, value: RecipeValue | None = None) -> None:
        """Record a value of the recipe, which may turn out to have no effect."""
        if not may_be_idle(node, attribute):
            return
        if value is None:
            before = self.effective(node, attribute) if attribute == "friction" else None
            value = RecipeValue(attribute, self.span(at), "edit", before)
        values = self.making.origins.values.setdefault(node, [])
        if all((each.span, each.attribute) != (value.span, attribute) for each in values):
            values.append(value)

    def write(self, node: Node, places: Mapping[str, Path]) -> None:
        """Record where the new values of attributes are in the recipe."""
        before = self.making.origins.owner(node, self.making.base_file)

        def place(attribute: str | None) -> Span:
            if attribute is not None and attribute in places:
                return self.span(places[attribute])
            return self.making.origins.span_by(before, node, attribute)

        self.making.origins.update(node, place)
        settings = self.making.origins.settings.get(node, {})
        for name in places:
            settings.pop(name, None)


def is_limited_by_range(editing: Editing, node: Node, switch: str) -> bool:
    """Return whether a range that is written limits: by the word `switch`, or by itself, as with `autolimits`."""
    word = editing.effective(node, switch)
    return word == "true" or (word in (None, "auto") and editing.linking.flat().settings.autolimits != "false")


def take_files(editing: Editing) -> None:
    """Resolve the files that edits name relative to the recipe. They replace the elements' previous files."""
    making = editing.making
    linking = editing.linking
    for node, attribute, name in making.files:
        file = making.named_file(node, attribute, name)
        linking.files = [use for use in linking.files if use.element is not node or use.attribute != attribute]
        if not editing.own:
            add_named_file(linking, file)
            continue
        # The part's own access rules do not apply, because the recipe names the file.
        path = PathlibPath(os.path.realpath(file.folder / file.name))
        unit = linking.base
        try:
            file.door.admit(path)
        except Refused as refused:
            refused.report(editing.sink, file.span)
            continue
        journal.write(node, attribute, path.as_posix())
        unit.contents = {**unit.contents, written_path(unit.settings, node, path.as_posix()): path}
    making.files.clear()


_SHOWN = 12


def select(editing: Editing, selector: Selector, path: Path) -> list[Node] | None:
    """Return the selected elements, perhaps none, or None if the selector itself has an error, which is reported."""
    selection = _selection(editing)
    if not editing.cost.allows(cost_of_selecting(selector, selection), editing.sink, editing.span(path)):
        return None
    try:
        return selection.of(selector)
    except BadPattern as bad:
        editing.sink.error("selector", bad.message, editing.span(path), help=bad.help)
        editing.cost.ended |= bad.is_slow
    except UnusableValue:
        pass
    return None


class ExpectedCount(NamedTuple):
    """The number of elements that a selector may select: `expect`, written at `at`, or none if it is `optional`."""

    expect: int | None
    optional: bool
    at: Path


def select_counted(
    editing: Editing, selector: Selector, path: Path, count: ExpectedCount, *, values: float = 1
) -> list[Node]:
    """Return the selected elements, each of which gets `values`; none if their number is wrong."""
    expect = count.expect
    if (found := select(editing, selector, path)) is None:
        return []
    if expect is not None and len(found) != expect:
        notes = [Note(f"it selects {_names(editing, found)}")] if found else [*_existing(editing, selector)]
        count_found = counted(len(found), "element") if found else "nothing"
        message = f"`{selector}` selects {count_found}, expected {expect}"
        help = None if not found else f"write `expect: {len(found)}` if that is right"
        editing.sink.error("selector", message, editing.span(count.at), notes=notes, help=help)
        return []
    if not found and not count.optional and expect is None:
        _report_nothing(editing, selector, path)
    return found if editing.cost.allows(len(found) * values, editing.sink, editing.span(path)) else []


def _selection(editing: Editing) -> Selection:
    def holds(node: Node, selector: Selector) -> bool:
        return _holds(editing, selection, node, selector=selector)

    separator = editing.linking.request.separator
    base_class = editing.linking.base_class
    selection = Selection(
        editing.root,
        editing.classes,
        separator,
        parts=editing.parts,
        base_class=base_class,
        holds=holds,
        index=editing.index,
        in_part=editing.in_part,
    )
    return selection


def _holds(editing: Editing, selection: Selection, node: Node, selector: Selector) -> bool:
    at = (*selector.at, "where")
    where = selector.where
    cost = _CONDITION + len(where) / _CHARACTERS if isinstance(where, str) else len(where or ())
    if not editing.cost.allows(cost, editing.sink, editing.span(at)):
        raise UnusableValue
    values = EntryValues(editing, node, 0, at=at, count=lambda: selection.number(node))
    if isinstance(selector.where, str):
        return _expression_holds(values, selector, condition=selector.where)
    return all(_has_value(values, selection, key, wanted=wanted) for key, wanted in (selector.where or {}).items())


def _expression_holds(values: EntryValues, selector: Selector, condition: str) -> bool:
    """Return the value of a condition `${…}` for an element. Raises `UnusableValue` if it is not a boolean."""
    editing = values.editing
    # It may use an attribute that other elements of the family can have, but not this one.
    own = kind_of(values.node).attributes
    names = [each for each in _names_in(condition) if each.space == ELEMENT or each.name not in editing.scope]
    missing = {each.name for each in names if each.name not in own}
    if not missing.isdisjoint(_attributes_of(selector.tag)):
        return False
    found = values.evaluated(condition, values.at)
    if isinstance(found, bool):
        return found
    editing.sink.error("wrong-type", "`where` needs `true` or `false`", editing.span(values.at))
    raise UnusableValue


def _has_value(values: EntryValues, selection: Selection, key: str, wanted: object) -> bool:
    """Return whether an attribute of the element, or one of its numbers, has the value that `where` gives."""
    name, index = attribute_and_index(key)
    if (attribute := kind_of(values.node).attributes.get(name)) is None:
        return False
    have = values.called["name"] if name == "name" else values.now(attribute, index)
    if have is None:
        return False
    meant = values.of(wanted, (*values.at, key), have)
    if isinstance(meant, str) and (attribute.is_reference or name == "name") and is_pattern(meant):
        return selection.fits(meant)(str(have))
    return matches_value(attribute, have, meant)


@lru_cache(maxsize=64)
def _names_in(condition: str) -> tuple[Variable, ...]:
    """Return the names in a condition that may be attributes. Its errors are reported when it is evaluated."""
    try:
        return tuple(each for each in Template.parse(condition).names() if each.space != PARAMETERS)
    except ExpressionError:
        return ()


@cache
def _attributes_of(family: str) -> frozenset[str]:
    return frozenset(name for path in paths_of(family) for name in GRAMMAR.element(path).attributes)


def _report_nothing(editing: Editing, selector: Selector, path: Path) -> None:
    """Report that nothing is selected, and the part of the selector that matches nothing."""
    help = fix = None
    written = editing.span((*path, selector.tag))
    names = _selection(editing).names(selector)
    near = [] if is_pattern(selector.pattern) else closest(selector.pattern, names)
    if near:
        help = f"did you mean `{selector.tag}: {near[0]}`?"
        renamed = renaming(selector.pattern, names)
        fix = None if renamed is None else replace(renamed, span=written)
    elif is_glob(selector.pattern) and not selector.pattern.startswith("**"):
        separator = editing.linking.request.separator
        deeper = f"**{separator}{selector.pattern}"
        if any(map(matcher(deeper, separator), names)):
            help = f'`*` stops at `{separator}`: write `{selector.tag}: "{deeper}"`'
            fix = Fix(deeper, selector.pattern, written)
    message = f"`{selector}` selects nothing"
    if selector.tag == "inertial":
        help = help or "a body whose mass comes from its geoms has no `inertial`: write `optional: true` to skip it"
    help = help or "write `optional: true` if that is not a fault"
    subjects = (selector.pattern,) if selector.is_one_name else ()
    editing.sink.error(
        "selector",
        message,
        editing.span(path),
        notes=_existing(editing, selector),
        help=help,
        fix=fix,
        subjects=subjects,
    )


def _existing(editing: Editing, selector: Selector) -> Iterable[Note]:
    """Return notes about existing elements: all of the tag, or, if the name matches, the conditions against them."""
    selection = _selection(editing)
    narrowed = any((selector.parent, selector.inside, selector.part, selector.dclass, selector.where))
    wide = Selector(selector.tag, selector.pattern)
    if narrowed and (found := selection.of(wide)):
        notes = [Note(f"`{wide}` alone selects {_names(editing, found)}")]
        for word, outer in (("parent", selector.parent), ("in", selector.inside)):
            if outer is not None and not selection.of(outer):
                names = selection.names(outer)
                notes.append(Note(f"`{word}: {outer}` selects nothing"))
                notes.append(exists_note(outer.tag, names, outer.pattern))
        if selector.part is not None:
            here = (editing.parts.get(node, "base") for node in editing.root.iter("*"))
            parts = sorted({"base", *(part.replace("/", editing.linking.request.separator) for part in here)})
            notes.append(exists_note("part", parts, selector.part))
        if selector.dclass is not None:
            notes.append(exists_note("class", sorted(editing.classes.by_name), selector.dclass))
        return notes
    names = selection.names(selector)
    unnamed = sum(1 for _ in selection.of_kind(selector)) - len(names)
    notes = [exists_note(selector.tag, names, selector.pattern)]
    if unnamed and not names:
        notes.append(Note(f"{unnamed} without a name, which only `**` selects"))
    return notes


def _names(editing: Editing, found: list[Node]) -> str:
    counts = Counter(map(editing.called, found[:_SHOWN]))
    words = [called if count == 1 else f"{called} ({count} times)" for called, count in counts.items()]
    rest = len(found) - min(len(found), _SHOWN)
    return ", ".join(words) + (f" and {rest} more" if rest else "")

"""Find the elements that the selector of an edit means, and report if there are none or the wrong number."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fix, Note, Path
from mjcompose.base.suggest import closest, exists_note, renaming
from mjcompose.build.compose.editing import Editing, cost_of_condition, cost_of_selecting
from mjcompose.build.compose.values import UnusableValue, Values, attributes_scope, matches_value
from mjcompose.language.value import attribute_and_index
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import Angle, ExpressionError, Value
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.pattern import BadPattern, Selector, is_glob, is_pattern, matcher, paths_of
from mjcompose.tree.select import Selection, kind_of
from mjcompose.tree.values import is_in_degrees

_SHOWN = 12


def select(editing: Editing, selector: Selector, path: Path) -> list[Node] | None:
    """Return the selected elements, perhaps none, or None if the selector itself has an error, which is reported."""
    selection = _selection(editing)
    if not editing.cost.allows(cost_of_selecting(selector, editing.root), editing.sink, editing.span(path)):
        return None
    try:
        return selection.of(selector)
    except BadPattern as bad:
        editing.sink.error("selector", bad.message, editing.span(path), help=bad.help)
        editing.cost.ended |= bad.is_slow
    except UnusableValue:
        pass
    return None


class Count(NamedTuple):
    """The number of elements that a selector may select: `expect` at the place `at`, or none if it is `optional`."""

    expect: int | None
    optional: bool
    at: Path


def select_counted(editing: Editing, selector: Selector, path: Path, count: Count, *, values: float = 1) -> list[Node]:
    """Return the selected elements. Report if their number is wrong; the result is empty then.

    `values` is how many values are written on each element, which counts towards the limit on edits.
    """
    expect = count.expect
    found = select(editing, selector, path)
    if found is None:
        return []
    if expect is not None and len(found) != expect:
        notes = [Note(f"it selects {_names(editing, found)}")] if found else [*_existing(editing, selector)]
        message = f"`{selector}` selects {_count(len(found))}, expected {expect}"
        help = None if not found else f"write `expect: {len(found)}` if that is right"
        editing.sink.error("selector", message, editing.span(count.at), notes=notes, help=help)
        return []
    if not found and not count.optional and expect is None:
        _report_nothing(editing, selector, path)
    return found if editing.cost.allows(len(found) * values, editing.sink, editing.span(path)) else []


def _selection(editing: Editing) -> Selection:
    def holds(node: Node, selector: Selector) -> bool:
        return _holds(editing, selection, node, selector=selector)

    separator, base_class = editing.linking.request.separator, editing.linking.base_class
    selection = Selection(
        editing.root, editing.classes, separator, parts=editing.parts, base_class=base_class, holds=holds
    )
    return selection


def _holds(editing: Editing, selection: Selection, node: Node, selector: Selector) -> bool:
    at = (*selector.at, "where")
    if not editing.cost.allows(cost_of_condition(selector.where), editing.sink, editing.span(at)):
        raise UnusableValue
    values = Values(editing, node, 0, at=at)
    if isinstance(selector.where, str):
        return _expression_holds(values, selection, selector, condition=selector.where)
    return all(_has_value(values, selection, key, wanted=wanted) for key, wanted in (selector.where or {}).items())


def _expression_holds(values: Values, selection: Selection, selector: Selector, condition: str) -> bool:
    """Return the value of a condition `${…}` for an element. Raises `UnusableValue` if it is not a boolean."""
    editing = values.editing
    scope = {**values.scope, **attributes_scope(values)}
    scope["name"] = values.scope["name"]
    if "index" in _names_in(condition):
        scope["index"] = selection.number(values.node)
    if _is_of_others(values.node, selector, scope):
        return False
    found = values.evaluated(condition, values.at, scope)
    if isinstance(found, bool):
        return found
    editing.sink.error("wrong-type", "`where` needs `true` or `false`", editing.span(values.at))
    raise UnusableValue


def _has_value(values: Values, selection: Selection, key: str, wanted: object) -> bool:
    """Return whether an attribute of the element, or one of its numbers, has the value that `where` gives."""
    name, index = attribute_and_index(key)
    attribute = kind_of(values.node).attributes.get(name)
    if attribute is None:
        return False
    have = values.scope["name"] if name == "name" else values.now(attribute, index)
    if have is None:
        return False
    meant = values.of(wanted, (*values.at, key), have)
    if attribute.is_number:
        meant = _in_its_unit(values, attribute, index, meant=meant)
    if isinstance(meant, str) and (attribute.is_reference or name == "name") and is_pattern(meant):
        return selection.fits(meant)(str(have))
    return matches_value(attribute, have, meant)


def _is_of_others(node: Node, selector: Selector, scope: Mapping[str, Value]) -> bool:
    """Return whether the condition uses an attribute that other elements of the family can have, but not this one."""
    missing = _names_in(str(selector.where)) - scope.keys() - kind_of(node).attributes.keys()
    return bool(missing) and not missing.isdisjoint(_attributes_of(selector.tag))


@lru_cache(maxsize=64)
def _names_in(condition: str) -> frozenset[str]:
    """Return the names in a condition. Its errors are reported when it is evaluated."""
    try:
        return frozenset(each.name for each in Template.parse(condition).names())
    except ExpressionError:
        return frozenset()


@cache
def _attributes_of(family: str) -> frozenset[str]:
    """Return the attributes that any element of a family has."""
    return frozenset(name for path in paths_of(family) for name in GRAMMAR.element(path).attributes)


def _in_its_unit(values: Values, attribute: Attribute, index: int | None, meant: Any) -> Any:
    """Return the value to compare with, with angles in the unit of the element's value."""
    if isinstance(meant, list):
        return [_in_its_unit(values, attribute, n, meant=each) for n, each in enumerate(meant)]
    angle = Angle.read(meant) if isinstance(meant, str) else None
    if angle is None:
        return meant
    place = index or 0
    in_degrees = is_in_degrees(str(values.node.tag), attribute.name)
    if place in values.angles(attribute, place + 1):
        in_degrees = values.editing.making.angle_context.at(values.at).angle == "degree"
    return angle.in_unit("deg" if in_degrees else "rad")


def _report_nothing(editing: Editing, selector: Selector, path: Path) -> None:
    """Report that nothing is selected, and which part of the selector nothing matches."""
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
    help = help or "write `optional: true` if that is not a fault"
    editing.sink.error("selector", message, editing.span(path), notes=_existing(editing, selector), help=help, fix=fix)


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
    words = [editing.called(node) for node in found[:_SHOWN]]
    rest = len(found) - len(words)
    return ", ".join(words) + (f" and {rest} more" if rest else "")


def _count(number: int) -> str:
    return "nothing" if number == 0 else f"{number} element{'s' * (number != 1)}"

"""Verb `set`: give attributes new values, or remove them. Missing attributes are reported at the end."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Path
from mjcompose.compose.editing import Editing
from mjcompose.compose.values import UnusableValue, report_unusable
from mjcompose.compose.verbs.values import SET, Entry, change_all
from mjcompose.language.assign import unknown_target
from mjcompose.language.fragment import report_clashing, report_missing
from mjcompose.language.verbs.set import Set
from mjcompose.tree.classes import chain
from mjcompose.tree.edit import assign
from mjcompose.tree.select import kind_of

# An actuator must have one of these: else MuJoCo 4.0 says "missing transmission target for actuator".
_MOVED = ("joint", "jointinparent", "tendon", "site", "body", "cranksite")


def carry_out(verb: Set, entry: Entry, at: Path) -> None:
    going, values = _parted(verb.written)
    names = tuple(name for name, each in going.items() if each is None)
    if names:  # required attributes that are then lacking are reported at the end of the entry
        lacked = {node: _missing_attributes(entry.editing, node) for node in entry.found}
        entry.checks.append(lambda: _report_newly_missing(entry.editing, lacked, names, at=at))
    _remove(entry.editing, entry.found, going, at=at)
    if values:
        change_all(entry, SET, values, at=at)


def _parted(written: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the attributes to remove, and the other attributes with their values.

    >>> _parted({"mass": None, "geom": {"rgba": None, "size": 1}})
    ({'mass': None, 'geom': {'rgba': None}}, {'geom': {'size': 1}})
    """
    going: dict[str, Any] = {}
    values: dict[str, Any] = {}
    for name, each in written.items():
        if each is None:
            going[name] = each
        elif isinstance(each, Mapping):
            for found, kept in zip((going, values), _parted(each), strict=True):
                if kept:
                    found[name] = kept
        else:
            values[name] = each
    return going, values


def _remove(editing: Editing, found: list[Node], going: Mapping[str, Any], at: Path) -> None:
    """Remove attributes. Report an attribute that no selected element has."""
    for name, inner in going.items():
        path = (*at, name)
        if isinstance(inner, Mapping):
            _remove(editing, [child for node in found for child in node.iterchildren(name)], inner, at=path)
            continue
        if not (writing := [node for node in found if node.get(name) is not None]):
            given = next((node for node in found if editing.effective(node, name) is not None), None)
            by_class = given is not None and kind_of(given).takes_class and _by_class(editing, given, name)
            kinds = {kind_of(node): None for node in found}
            if not any(name in kind.attributes for kind in kinds):
                report_unusable(editing, found[0], unknown_target(name, str(found[0].tag), [*kinds], at=path))
            help = "its class gives it: change it there, `select: {default: CLASS}`" if by_class else None
            message = f"`{name}` is written on none of the selected elements"
            editing.sink.error("unknown-attribute", message, editing.span(path, key=True), help=help, subjects=(name,))
            raise UnusableValue
        for node in writing:
            editing.write(node, {name: path})
            assign(editing, node, {name: None})


def _missing_attributes(editing: Editing, node: Node) -> list[Fault]:
    kind = kind_of(node)
    present = [str(name) for name in node.keys()]  # noqa: SIM118 (an element is not a mapping)
    if kind.takes_class:
        present += [name for name in kind.attributes if _by_class(editing, node, name)]
    faults: list[Fault] = []
    report_missing(kind, present, editing.called(node), at=(), faults=faults)
    report_clashing(kind.constraints, present, editing.called(node), at=(), faults=faults)
    if kind.family == "actuator" and not any(name in present for name in _MOVED):
        faults.append(Fault("missing-key", f"{editing.called(node)} lacks what it moves", names=_MOVED))
    return faults


def _report_newly_missing(
    editing: Editing, before: Mapping[Node, list[Fault]], names: tuple[str, ...], at: Path
) -> None:
    """Report the first element that lacks something now that it did not lack `before`."""
    for node, lacked in before.items():
        for fault in _missing_attributes(editing, node):
            if fault in lacked:
                continue
            name = next((each for each in names if each in fault.names), names[0])
            help = f"leave `{name}` where it is, or set its replacement in the same entry"
            report_unusable(editing, node, replace(fault, at=(*at, name), key=True, help=help, fix=None), it="it")


def _by_class(editing: Editing, node: Node, name: str) -> bool:
    return any(step.lookup(str(node.tag), name) for step in chain(node, editing.classes))

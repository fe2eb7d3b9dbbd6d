"""Verb `unset`: remove attributes. Attributes that an element then lacks are reported when its entry is done."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.build.compose.editing import Editing
from mjcompose.build.compose.values import UnusableValue
from mjcompose.build.verbs.values import Entry
from mjcompose.language.fragment import report_clashing, report_missing
from mjcompose.model.classes import chain
from mjcompose.model.edit import assign
from mjcompose.model.select import kind_of

# An actuator must have one of these: else MuJoCo 4.0 says "missing transmission target for actuator".
_MOVED = ("joint", "jointinparent", "tendon", "site", "body", "cranksite")


def carry_out(entry: Entry, value: Any, at: Path) -> None:
    """Remove attributes. Required ones that are missing afterwards are reported at the end of the entry."""
    if not isinstance(value, Mapping):
        lacked = {node: missing_attributes(entry.editing, node) for node in entry.found}
        entry.checks.append(lambda: report_newly_missing(entry.editing, lacked, value, at=at))
    unset(entry.editing, entry.found, value, at=at)


def unset(editing: Editing, found: list[Node], names: Any, at: Path) -> None:
    """Remove attributes. Report one that no selected element writes."""
    if isinstance(names, Mapping):
        for tag, inner in names.items():
            below = [child for node in found for child in node.iterchildren(tag)]
            unset(editing, below, inner, at=(*at, tag))
        return
    for position, name in enumerate(names):
        writing = [node for node in found if node.get(name) is not None]
        if not writing:
            given = next((node for node in found if editing.effective(node, name) is not None), None)
            by_class = given is not None and kind_of(given).takes_class and _by_class(editing, given, name)
            help = "its class gives it: change it there, `select: {default: CLASS}`" if by_class else None
            editing.sink.error(
                "unknown-attribute",
                f"`{name}` is written on none of the selected elements",
                editing.span((*at, position)),
                help=help,
                subjects=(name,),
            )
            raise UnusableValue
        for node in writing:
            editing.write(node, {name: (*at, position)})
            assign(editing, node, {name: None})


def missing_attributes(editing: Editing, node: Node) -> list[Fault]:
    """Return a fault for each required attribute that an element lacks."""
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


def report_newly_missing(
    editing: Editing, before: Mapping[Node, list[Fault]], names: tuple[str, ...], at: Path
) -> None:
    """Report the first element that lacks something now that it did not lack `before`."""
    for node, lacked in before.items():
        for fault in missing_attributes(editing, node):
            if fault in lacked:
                continue
            meant = [n for n, name in enumerate(names) if name in fault.names]
            place = meant[0] if meant else 0
            notes = fault.all_notes()
            notes.append(Note("it is written here", editing.span_of(node)))
            help = f"leave `{names[place]}` where it is, or set what takes its place in the same entry"
            editing.sink.error(
                fault.code,
                fault.message,
                editing.span((*at, place)),
                notes=notes,
                help=help,
                subjects=(*fault.names, *editing.subjects(node)),
            )
            raise UnusableValue


def _by_class(editing: Editing, node: Node, name: str) -> bool:
    return any(step.lookup(str(node.tag), name) for step in chain(node, editing.classes))

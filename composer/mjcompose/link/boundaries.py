"""Passes: elements across the boundary of a `<replicate>`, which MuJoCo drops without an error.

With `ball` in a `<replicate>`, `<connect body1="ball" body2="bar"/>` means a constraint for each copy. If `bar` is
outside, MuJoCo (3.12 to 4.0) looks for `ball0` and `bar0`, finds no `bar0`, and drops the constraint. It drops
actuators with two sites and tuples in the same way. An element that names a copy, such as
`<connect body1="ball0" body2="bar"/>`, stays.

A recipe or a program that writes such an element gets one for each copy. In a source, it is an error: MuJoCo drops it
there, too, so the source alone is another model than it appears.
"""

from __future__ import annotations

import copy

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.link.expansion import Crossing, Expansion, Name, OutsideElement, names_of_copies
from mjcompose.link.linking import Linking, shown_name
from mjcompose.tree import journal
from mjcompose.tree.names import WORLD, declaration, own_references, word
from mjcompose.tree.unit import Unit

CODE = "not-as-written"
_AFFECTED = ("equality", "actuator", "custom")


def boundaries(linking: Linking) -> None:
    """Report elements of sources that MuJoCo drops from the source alone."""
    for unit in linking.units:
        reported: set[Node] = set()
        for crossing in _crossings(unit):
            element = crossing.row.element
            of_source = isinstance(unit.origins.owner(element, unit.file), str)
            # MuJoCo 4.0 keeps an equality with the world by its name.
            if of_source and crossing.outside[1] != WORLD and element not in reported:
                reported.add(element)
                _report(linking, unit, crossing)


def _crossings(unit: Unit) -> list[Crossing]:
    return list(_expansion(unit).crossings)


def _expansion(unit: Unit) -> Expansion:
    return Expansion.of(unit.root, _AFFECTED) if next(unit.root.iter("replicate"), None) is not None else Expansion({})


def has_crossings(unit: Unit) -> bool:
    """Return whether MuJoCo would drop an element of the unit because of a `<replicate>`."""
    return bool(_crossings(unit))


def _report(linking: Linking, unit: Unit, crossing: Crossing) -> None:
    element = crossing.row.element
    kind, inside = crossing.inside
    other_kind, outside = crossing.outside
    name = str(element.get("name") or "")
    message = (
        f"MuJoCo drops the `<{element.tag}>` {shown_name(element)}: "
        f"a `<replicate>` copies the {word(kind)} `{inside}`, but not the {word(other_kind)} `{outside}`"
    )
    linking.sink.error(
        CODE,
        message,
        linking.span(unit, element),
        notes=(_of_replicate(linking, unit, crossing),),
        help=_advice(unit, crossing),
        subjects=(name,),
    )


def _of_replicate(linking: Linking, unit: Unit, crossing: Crossing) -> Note:
    return Note("the `<replicate>`", linking.span(unit, crossing.replicate))


def _advice(unit: Unit, crossing: Crossing) -> str:
    kind, name = crossing.inside
    element = crossing.row.element
    section = crossing.row.section
    uses = [
        (attribute, node)
        for node in element.iter("*")
        for attribute, namespace, used, _ in own_references(node, section)
        if (namespace, used) == (kind, name)
    ]
    declared = next((node for node in unit.root.iterfind("worldbody//*[@name]") if node.get("name") == name), None)
    copies = [] if declared is None else names_of_copies(declared)
    if not uses or not copies:
        return f"write a `<{element.tag}>` for each copy"
    return f'write a `<{element.tag}>` for each copy: `{uses[0][0]}="{copies[0]}"` and so on'


def crossings(linking: Linking) -> None:
    """Write out every element that MuJoCo would drop: one for each copy, with the names of the copies."""
    base = linking.base
    expansion = _expansion(base)
    copies: dict[Node, list[OutsideElement]] = {crossing.row.element: [] for crossing in expansion.crossings}
    for row in (row for rows in expansion.rows.values() for row in rows):
        if row.element in copies:
            copies[row.element].append(row)
    for element, rows in copies.items():
        _write_out(linking, element, rows)


def _write_out(linking: Linking, element: Node, rows: list[OutsideElement]) -> None:
    base = linking.base
    holder = element.getparent()
    assert holder is not None
    at = holder.index(element)
    journal.remove(element)
    namespace, name = declaration(element, rows[0].section) or ("", "")
    declared = linking.names.declared.setdefault(namespace, {}) if name else {}
    declared.pop(name, None)
    for number, row in enumerate(rows):
        made = copy.deepcopy(element)
        for old, new in zip(element.iter("*"), made.iter("*"), strict=True):
            base.origins.own_as(new, old)
            journal.note_source(new, old)
            _refer_to_copies(new, row)
        if row.name:
            journal.write(made, "name", row.name)
            declared[row.name] = made
        journal.place(holder, made, at + number)


def _refer_to_copies(node: Node, row: OutsideElement) -> None:
    for attribute, namespace, name, _ in own_references(node, row.section):
        copied: Name | None = row.references.get((namespace, name))
        if copied is not None:
            journal.write(node, attribute, copied[1])

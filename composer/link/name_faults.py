"""Errors for names that are declared twice and for references to names that do not exist."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.unknown import unknown_name
from composer.link.linking import Linking
from composer.link.part import Part
from composer.tree.line import line_of
from composer.tree.names import word
from composer.tree.unit import Unit

Clash = tuple[str, str, Node, Node]
"""Namespace, name, the element that declares it, and the one that did before."""


def loose_end(
    linking: Linking,
    unit: Unit,
    prefix: str,
    namespace: str,
    name: str,
    element: Node,
    declared: Collection[str],
) -> None:
    """Report a reference to nothing within a source. Names are reported without the prefix, as in the source."""
    wanted = name.removeprefix(prefix)
    own = [each.removeprefix(prefix) for each in declared]
    attribute = next(
        (str(key) for key, value in element.items() if name in (value, *str(value).split())), None
    )
    linking.sink.add(
        unknown_name(
            word(namespace),
            wanted,
            own,
            linking.span(unit, element, attribute),
            purpose=f", which `<{element.tag}>` refers to,",
            written=f'{attribute}="{{}}"' if attribute else "{}",
        )
    )


def repeated(linking: Linking, unit: Unit, prefix: str, clash: Clash) -> None:
    """Report a name that a source itself declares twice."""
    namespace, name, element, earlier = clash
    linking.sink.error(
        _code(namespace),
        f"`{unit.file}` has two elements that are the {word(namespace)} `{name.removeprefix(prefix)}`",
        linking.span(unit, element, "name" if namespace != "default" else "class"),
        notes=(Note("the first one is here", linking.span(unit, earlier)),),
        subjects=(name.removeprefix(prefix),),
    )


def clash_with_others(linking: Linking, part: Part, clashes: Sequence[Clash]) -> None:
    """Report all names of a part that the model already has, as one fault."""
    namespace, name, element, earlier = min(clashes, key=lambda clash: line_of(clash[2]) or 0)
    here = linking.span(part.unit, element)
    there = linking.span(_unit_of(linking, earlier), earlier)
    count = len(clashes) - 1
    more = f"; {count} more of its names {'is' if count == 1 else 'are'} taken too" if count else ""
    notes = [Note("it is declared here first", there)]
    if part.span is not None and here != there:
        notes.insert(0, Note("the part declares it here", here))
    linking.sink.error(
        _code(namespace),
        f"`{part.called}` brings the {word(namespace)} `{name}`, and the model has one of that name{more}",
        part.span or here,
        notes=notes,
        help="give the part another prefix"
        if part.prefix
        else "let the part have a prefix: leave `prefix` out",
        subjects=(part.called, name),
    )


def _code(namespace: str) -> str:
    return "class-clash" if namespace == "default" else "name-clash"


def _unit_of(linking: Linking, element: Node) -> Unit:
    root = element.getroottree().getroot()
    return next((unit for unit in linking.units if unit.root is root), linking.base)

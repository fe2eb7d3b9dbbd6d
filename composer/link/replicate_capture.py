"""Pass: find elements of one unit that the `<replicate>` of another would multiply, because of a bug in MuJoCo.

MuJoCo (3.12 to 4.0) treats an element as replicated if all names in it still resolve with the copy's number
appended. That includes a sensor without an object, a tuple of assets, and an element that refers to `j1` if there
is a `j10` before the replicate, either written or made by another replicate.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Set

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking
from composer.link.multiplied import Name, names_made, suffixes
from composer.tree.names import REFERS, REFERS_BY, WORLD, naming_table, object_namespace
from composer.tree.unit import Unit

_SECTIONS = ("contact", "tendon", "equality", "actuator", "sensor", "custom")
_OF_NOTHING = ("numeric", "text")
# What a replicate copies; assets, numbers and texts keep their names, so that they always resolve.
_COPIED = frozenset(
    "body joint geom site camera light tendon equality actuator sensor pair exclude flex skin".split()
)


def check_replicates(linking: Linking) -> None:
    """Refuse a replicate that would change another unit.

    MuJoCo would copy the clock of the base, too, and the replicate must stay as the `<exclude>` refers to it:

    >>> from composer.link.example import after
    >>> part = (
    ...     '<worldbody><replicate count="2"><body name="b"/></replicate></worldbody>'
    ...     '<contact><exclude body1="b" body2="b"/></contact>'
    ... )
    >>> base = '<sensor><clock/></sensor>'
    >>> after(check_replicates, part, base)
    error: the `<replicate>` of `part.xml` would multiply the `<clock>` without a name of `base.xml`, too
    """
    waiting = {unit: list(things(unit)) for unit in linking.units if linking.notes.replicates}
    if not any(
        found for other, found in waiting.items() for unit, _ in linking.notes.replicates if other is not unit
    ):
        return
    places = {element: at for at, element in enumerate(linking.base.root.iter("*"))}
    made = names_made(linking.base.root)
    reported: set[tuple[Unit, Unit]] = set()
    for unit, replicate in linking.notes.replicates:
        for other in linking.units:
            if other is unit or (unit, other) in reported:
                continue
            thing = next(
                (each for each in waiting[other] if resolves(linking, each, replicate, places, made)), None
            )
            if thing is not None:
                reported.add((unit, other))
                _refuse(linking, unit, replicate, other, thing)


def things(unit: Unit) -> Iterator[Node]:
    """Yield the elements that a replicate may multiply."""
    for section in unit.root.iterchildren(*_SECTIONS):
        yield from (each for each in section.iterchildren("*") if each.tag not in _OF_NOTHING)


def resolves(
    linking: Linking, thing: Node, replicate: Node, places: Mapping[Node, int], made: Set[Name]
) -> bool:
    """Return whether MuJoCo also finds the thing's reference with a number appended when it reads the replicate."""
    names = list(referred(thing))
    found = (linking.names.find(kind, name + end) for kind, name in names for end in suffixes(replicate))
    here = places.get(replicate, 0)
    if made_from(names, suffixes(replicate), linking.names.find, made):
        return True
    return not names or any(
        element is not None and (_is_listed(element) or places.get(element, here) < here) for element in found
    )


def made_from(
    names: Iterable[Name], ends: Collection[str], find: Callable[[str, str], Node | None], made: Set[Name]
) -> bool:
    """Return whether a replicate makes one of the names with a number appended, but for another element."""
    return any(
        (kind, name + end) in made
        and (element := find(kind, name)) is not None
        and next(element.iterancestors("replicate"), None) is None
        for kind, name in names
        for end in ends
    )


def _is_listed(element: Node) -> bool:
    """Return whether an element is in a section that MuJoCo reads before the bodies."""
    section = element.getparent()
    return section is not None and section.tag in _SECTIONS


def referred(thing: Node) -> Iterator[tuple[str, str]]:
    """Yield the namespace and name of each reference of a thing to something that a replicate copies."""
    section = thing.getparent()
    assert section is not None
    table = naming_table(str(section.tag))
    for element in thing.iter("*"):
        for attribute, (action, namespace) in table.get(str(element.tag), {}).items():
            name = str(element.get(attribute) or "")
            kind = object_namespace(element, namespace) if action == REFERS_BY else namespace
            if name == WORLD and thing.tag == "tuple":
                continue
            if name and action in (REFERS, REFERS_BY) and kind in _COPIED:
                yield str(kind), name


def _refuse(linking: Linking, unit: Unit, replicate: Node, other: Unit, thing: Node) -> None:
    called = f"`{thing.get('name')}`" if thing.get("name") else "without a name"
    linking.sink.error(
        "not-supported",
        f"the `<replicate>` of `{unit.file}` would multiply the `<{thing.tag}>` {called} of `{other.file}`, too",
        linking.span(unit, replicate),
        notes=(Note("MuJoCo would take this for one of what it replicates", linking.span(other, thing)),),
        help="write the copies out instead of `<replicate>`",
    )

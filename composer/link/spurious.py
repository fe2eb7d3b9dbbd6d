"""Pass: what the `<replicate>` of one unit would multiply in another, by a fault of MuJoCo.

MuJoCo (3.12 to 4.0) takes for replicated what still resolves when the copy's number is appended to every name in
it: a sensor without an object, a tuple of assets, and what refers to `j1` where there is a `j10` too.
"""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.link.linking import Linking
from composer.link.multiplied import suffixes
from composer.tree.names import REFERS, REFERS_BY, WORLD, naming_table, object_namespace
from composer.tree.unit import Unit

_SECTIONS = ("contact", "tendon", "equality", "actuator", "sensor", "custom")
_OF_NOTHING = ("numeric", "text")
# What a replicate copies; assets, numbers and texts keep their names, so that they always resolve.
_COPIED = frozenset(
    "body joint geom site camera light tendon equality actuator sensor pair exclude flex skin".split()
)


def spurious(linking: Linking) -> None:
    """Refuse a replicate that would change another unit."""
    units = linking.units
    replicating = [
        (unit, found) for unit in units if (found := next(unit.root.iter("replicate"), None)) is not None
    ]
    if len(units) < 2 or not replicating:
        return
    for unit, _ in replicating:
        ends = {end for replicate in unit.root.iter("replicate") for end in suffixes(replicate)}
        for other in units:
            if other is not unit:
                thing = next((each for each in _things(other) if _resolves(linking, each, ends)), None)
                if thing is not None:
                    _refuse(linking, unit, other, thing)


def _things(unit: Unit) -> Iterator[Node]:
    for section in unit.root.iterchildren(*_SECTIONS):
        yield from (each for each in section.iterchildren("*") if each.tag not in _OF_NOTHING)


def _resolves(linking: Linking, thing: Node, ends: set[str]) -> bool:
    """Whether MuJoCo finds what the thing refers to with a number behind it, too."""
    referred = list(_referred(thing))
    return not referred or any(
        linking.names.find(kind, name + end) is not None for kind, name in referred for end in ends
    )


def _referred(thing: Node) -> Iterator[tuple[str, str]]:
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


def _refuse(linking: Linking, unit: Unit, other: Unit, thing: Node) -> None:
    replicate = next(unit.root.iter("replicate"))
    called = f"`{thing.get('name')}`" if thing.get("name") else "without a name"
    linking.sink.error(
        "not-supported",
        f"the `<replicate>` of `{unit.file}` would multiply the `<{thing.tag}>` {called} of `{other.file}`, too",
        linking.span(unit, replicate),
        notes=(Note("MuJoCo would take this for one of what it replicates", linking.span(other, thing)),),
        help="write the copies out instead of `<replicate>`",
    )

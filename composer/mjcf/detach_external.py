"""Remove a unit's references to the models attached to it, so that MuJoCo can compile it alone."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.tree.kinds import section_of
from composer.tree.name_index import NameIndex
from composer.tree.names import declaration
from composer.tree.removal import whole
from composer.tree.unit import Unit

_STAND_IN = "stands in for what is attached"
# What an actuator acts on, and what it needs of that.
_OF_TRANSMISSIONS = (
    "joint",
    "jointinparent",
    "tendon",
    "slidersite",
    "cranksite",
    "site",
    "refsite",
    "inheritrange",
)
# Here an element is part of the bodies and their mass, or of what they are made of.
_OF_BODIES = frozenset({"worldbody", "default", "asset", "extension"})


def without_outward(unit: Unit, prefixes: tuple[str, ...]) -> Unit:
    """Return the unit, or a copy without the elements that refer to names with one of the prefixes.

    Bodies and the elements on them stay. Their references to materials with these names are removed; if another name
    is missing, MuJoCo reports it. Actuators stay, in their order, and act on a placeholder site.
    """
    if not _outward(NameIndex.of(unit.root), prefixes):
        return unit
    unit = unit.copied()
    names = NameIndex.of(unit.root)
    waiting = _outward(names, prefixes)
    while waiting:
        namespace, name = waiting.pop()
        for node, attribute in names.users(namespace, name):
            section = section_of(node)
            if section == "actuator":
                _act_on_stand_in(unit, node)
            elif section not in _OF_BODIES:
                top = whole(node)
                declared = declaration(top, section)
                parent = top.getparent()
                if parent is not None:
                    parent.remove(top)
                    waiting += [declared] if declared else []
            elif namespace == "material":
                del node.attrib[attribute]
    return unit


def _outward(names: NameIndex, prefixes: tuple[str, ...]) -> list[tuple[str, str]]:
    return [
        (namespace, name)
        for namespace, uses in names.uses.items()
        for name in uses
        if name.startswith(prefixes) and names.find(namespace, name) is None
    ]


def _act_on_stand_in(unit: Unit, actuator: Node) -> None:
    if actuator.get("body"):
        actuator.set("body", "world")
        return
    for name in _OF_TRANSMISSIONS:
        if name in actuator.attrib:
            del actuator.attrib[name]
    world = unit.section("worldbody")
    if all(site.get("name") != _STAND_IN for site in world.iterchildren("site")):
        world.append(world.makeelement("site", {"name": _STAND_IN}))
    actuator.set("site", _STAND_IN)

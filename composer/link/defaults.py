"""Pass: the default classes of each part, and of the base, apply only to its own elements.

A part's unnamed top class becomes the class `PREFIX/`. If the base's top class sets anything, its settings move to
the class `base/`, because a part cannot undo an attribute that has no neutral value.
"""

from __future__ import annotations

from collections.abc import Mapping, Set

from lxml import etree
from lxml.etree import _Element as Node

from composer.link.flexes import in_world, keep_in_main
from composer.link.linking import Linking
from composer.tree.classes import NESTED, says_something
from composer.tree.comments import above
from composer.tree.unit import Unit

# Sections whose elements take a class but stand outside the body tree, where no childclass reaches them: MuJoCo 4.0
# gives a `<motor joint="j"/>` gear 1 though the body of `j` has a childclass with `<motor gear="5"/>`.
_CLASSED: Mapping[str, tuple[str, ...] | None] = {
    "asset": ("mesh", "material", "texture"),
    "contact": ("pair",),
    "equality": None,
    "tendon": ("spatial", "fixed"),
    "actuator": None,
}
_TREE = ("joint", "geom", "site", "camera", "light")


def defaults(linking: Linking) -> None:
    """Wrap the top classes, move all classes under the base's, and name the class of what has none.

    The actuator stands outside of the body tree and has to name the class:

    >>> from composer.link.example import after
    >>> part = (
    ...     '<default><motor gear="2"/></default>'
    ...     '<worldbody><site name="s"/></worldbody>'
    ...     '<actuator><motor site="s"/></actuator>'
    ... )
    >>> after(defaults, part)
    base: <default><default class="p/"><motor gear="2"/></default></default>
    part: <actuator><motor site="p/s" class="p/"/></actuator>
    """
    base = linking.base
    for unit in linking.units:
        unit.forget_classes()
    if linking.base_class is not None:
        own = _wrap(linking, base, linking.base_class)
        _claim_sections(base, linking.base_class, own | linking.request.isolated_tags)
        _claim_world(base, linking.base_class)
    _join(linking)


def _join(linking: Linking) -> None:
    """Wrap the top class of every part, and move the classes below that of the model."""
    base = linking.base
    if not linking.parts:
        return
    top = next(base.root.iterchildren("default"), None)
    if top is None:
        top = base.root.makeelement("default")
        base.insert(top)
    for part in linking.parts:
        own = _wrap(linking, part.unit, part.top_class)
        _claim_sections(part.unit, part.top_class, own)
        for section in list(part.unit.root.iterchildren("default")):
            for wrapped in list(section):
                top.append(wrapped)
                linking.base.origins.own(wrapped, part.unit.origins.owner(section, part.unit.file))
            part.unit.root.remove(section)
    keep_in_main(linking, top)
    base.forget_classes()


def choose_classes(linking: Linking) -> None:
    """Decide the name of every top class before anything is renamed.

    The top class of the base keeps its name as long as it sets nothing:

    >>> from composer.link.example import noted
    >>> noted(choose_classes, base='<default><default class="c"/></default>').base_class
    >>> linking = noted(choose_classes, base='<default><geom density="5"/></default>')
    >>> linking.base_class, linking.parts[0].top_class
    ('base/', 'p/')
    """
    separator = linking.request.separator
    prefixes = {part.prefix for part in linking.parts}
    # A unit that is itself a composition has wrapped classes already.
    taken = _class_names(linking.base, *(part.unit for part in linking.parts if not part.prefix))
    for part in linking.parts:
        own = part.prefix or f"{part.unit.model or part.unit.label}{separator}"
        part.top_class = _free(own, taken if part.prefix else taken | prefixes)
        taken.add(part.top_class)
    needed = any(flex.joint for flex in in_world(linking))
    # An element cannot take back all that a class says: with `<default><geom user="1 2"/></default>` in the base,
    # `<geom user=""/>` of a part still has 1 2 in MuJoCo 4.0. So the top class of the base may set nothing.
    if linking.parts and (linking.request.isolated_tags or needed or _top_kinds(linking.base.root)):
        linking.base_class = _free(f"base{separator}", taken | prefixes)


def _free(name: str, taken: Set[str]) -> str:
    # A class exists once in a model, wherever it is nested: else MuJoCo 4.0 says "repeated default class name".
    while name in taken:
        name = "_" + name
    return name


def _class_names(*units: Unit) -> set[str]:
    return {
        str(element.get("class"))
        for unit in units
        for section in unit.root.iterchildren("default")
        for element in section.iter("default")
    }


def _top_kinds(root: Node) -> set[str]:
    """Return the tags for which the top class itself sets attributes."""
    return {
        str(element.tag)
        for section in root.iterchildren("default")
        for element in section.iterchildren(etree.Element)
        if element.tag != "default" and says_something(element)
    }


def _wrap(linking: Linking, unit: Unit, name: str) -> set[str]:
    """Turn the unit's top class into the nested class `name`. Return the tags for which it sets attributes."""
    root = unit.root
    kinds = _top_kinds(root)
    sections = list(root.iterchildren("default"))
    if not sections:
        sections = [root.makeelement("default")]
        unit.insert(sections[0])
    outer: Node | None = None
    for at, section in enumerate(sections):
        last = at == len(sections) - 1
        wrapped = root.makeelement("default", {"class": name if last else f"{name}{at + 1}"})
        wrapped.extend([*(above(section, unit.header) if unit is not linking.base else ()), *section])
        # The top class can only be called `main` ("cannot be renamed" in MuJoCo 4.0), and a nested one has to have a
        # name ("empty class name").
        if "class" in section.attrib:
            del section.attrib["class"]
        if outer is None:
            section.append(wrapped)
        else:
            # What a later section says of the top class does not reach the classes of an earlier one: MuJoCo 4.0 copies
            # the parent when it reads a class. In `<default><geom size=".1"/><default class="c"/></default>
            # <default><geom size=".2"/></default>` the class `c` has size 0.1.
            outer.append(wrapped)
            root.remove(section)
        outer = wrapped
    assert outer is not None
    linking.names.declared.setdefault("default", {}).setdefault(name, outer)
    return kinds


def _claim_sections(unit: Unit, name: str, kinds: set[str]) -> None:
    """Set the top class on the elements outside the body tree that have no class of their own."""
    if not kinds:
        return
    # Sensors, keys and exclusions have no class: `<clock class="main"/>` violates the schema of MuJoCo 4.0.
    for section in unit.root:
        if section.tag not in _CLASSED:
            continue
        tags = _CLASSED[str(section.tag)]
        if section.tag in ("equality", "tendon") and section.tag not in kinds:
            continue
        if section.tag in ("asset", "contact"):
            tags = tuple(kinds.intersection(tags or ()))
            if not tags:
                continue
        for element in section.iterchildren(*(tags or ("*",))):
            if element.get("class") is None:
                element.set("class", name)


def _claim_world(unit: Unit, name: str) -> None:
    """Set the top class on elements in the world without a class. Below a body, its `childclass` has this effect."""
    # The world itself cannot take a class: `<worldbody childclass="c">` is "World body cannot have attributes" in
    # MuJoCo 4.0.
    for worldbody in unit.root.iterchildren("worldbody"):
        for element in worldbody:
            tag = element.tag
            if tag in NESTED:
                if not element.get("childclass"):
                    element.set("childclass", name)
            elif tag in _TREE and element.get("class") is None:
                element.set("class", name)

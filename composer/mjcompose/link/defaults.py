"""Passes: restrict default classes to the elements of their own part.

A part's unnamed top class becomes the class `PREFIX/`. If the base's top class sets anything, its settings move to
the class `base/`, because a part cannot undo an attribute that has no neutral value.

The gain of an actuator changes when several top-level `<default>` sections become separate classes. It takes the gain
of its class only if that class is for its own kind of actuator. Otherwise MuJoCo 4 looks in the enclosing classes, and
in the top class, which combines all top-level `<default>` sections. After wrapping, each section is a class of its own,
so the gain may come from another class. MuJoCo compiles the unit both ways; if a gain differs, the original gain is
written on the actuator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Set
from itertools import takewhile
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.link.angles import in_world, keep_in_main
from mjcompose.link.expansion import actuators_in_order, element_of
from mjcompose.link.linking import Linking, Part, shown_name
from mjcompose.link.names import called_here
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, NESTED, Classes, DefaultClass, says_something
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.journal import Why, because, explained
from mjcompose.tree.parse import above
from mjcompose.tree.unit import Unit

# Sections whose elements take a class but are outside the body tree, beyond any childclass: MuJoCo 4.0
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
    """Wrap the top classes, move all classes under the base's, and write the class of each element that has none."""
    base = linking.base
    for unit in linking.units:
        unit.forget_classes()
    if linking.base_class is not None:
        own = _wrap(linking, base, None, linking.base_class)
        _claim_sections(base, linking.base_class, own | linking.request.isolated_tags)
        _claim_world(base, linking.base_class)
    if not linking.parts:
        return
    top = next(base.root.iterchildren("default"), None)
    if top is None:
        top = base.root.makeelement("default")
        with explained(because("contains the default classes of the parts")):
            base.insert(top)
    for part in linking.parts:
        top_class = linking.top_class(part.unit)
        own = _wrap(linking, part.unit, part, top_class)
        _claim_sections(part.unit, top_class, own)
        for section in list(part.unit.root.iterchildren("default")):
            for wrapped in list(section):
                journal.place(top, wrapped)
                linking.base.origins.own(wrapped, part.unit.origins.owner(section, part.unit.file))
            journal.remove(section)
    keep_in_main(linking, top)
    base.forget_classes()


def choose_classes(linking: Linking) -> None:
    """Decide the name of every top class before anything is renamed."""
    separator = linking.request.separator
    prefixes = {part.prefix for part in linking.parts}
    # A unit that is itself a composition has wrapped classes already.
    taken = {
        str(element.get("class"))
        for unit in (linking.base, *(part.unit for part in linking.parts if not part.prefix))
        for section in unit.root.iterchildren("default")
        for element in section.iter("default")
    }
    for part in linking.parts:
        own = part.prefix or f"{part.unit.model or part.unit.label}{separator}"
        name = _free_class(own, taken if part.prefix else taken | prefixes)
        linking.top_classes[part.unit] = name
        taken.add(name)
    needed = any(flex.joint for flex in in_world(linking))
    # An element cannot revert everything in a class: with `<default><geom user="1 2"/></default>` in the base,
    # `<geom user=""/>` of a part still has 1 2 in MuJoCo 4.0. So the top class of the base may set nothing.
    if linking.parts and (linking.request.isolated_tags or needed or _top_kinds(linking.base.root)):
        linking.base_class = _free_class(f"base{separator}", taken | prefixes)


def _free_class(name: str, taken: Set[str]) -> str:
    # A class exists once in a model, wherever it is nested: else MuJoCo 4.0 says "repeated default class name".
    while name in taken:
        name = "_" + name
    return name


def _top_kinds(root: Node) -> set[str]:
    rows = (each for each in root.iterfind("default/*") if each.tag != "default")
    return {str(each.tag) for each in rows if says_something(each)}


def _wrap(linking: Linking, unit: Unit, part: Part | None, name: str) -> set[str]:
    """Turn the unit's top class into the nested class `name`. Return the tags for which it sets attributes."""
    root = unit.root
    kinds = _top_kinds(root)
    sections = list(root.iterchildren("default"))
    if not sections:
        sections = [root.makeelement("default")]
        unit.insert(sections[0])
        place = None
    else:
        place = unit.origins.lasting_place(sections[0], unit.file)
    top_class = because(f"the top class of {unit.file_name}", place)
    named = None if part is None else because("named after the part", part.span)
    outer: Node | None = None
    for at, section in enumerate(sections):
        last = at == len(sections) - 1
        wrapped = root.makeelement("default")
        journal.write(wrapped, "class", name if last else f"{name}{at + 1}", named)
        journal.place_all(wrapped, [*(above(section, unit.header) if unit is not linking.base else ()), *section])
        # The top class can only be called `main` ("cannot be renamed" in MuJoCo 4.0), and a nested one has to have a
        # name ("empty class name").
        journal.drop(section, "class", because(called_here(unit)))
        if outer is None:
            journal.place(section, wrapped, why=top_class)
        else:
            # The settings of a later section do not reach the classes of an earlier one: MuJoCo 4.0 copies the parent
            # when it reads a class. In `<default><geom size=".1"/><default class="c"/></default>
            # <default><geom size=".2"/></default>` the class `c` has size 0.1.
            journal.place(outer, wrapped, why=top_class)
            journal.remove(section)
        outer = wrapped
    assert outer is not None
    linking.names.declared.setdefault("default", {}).setdefault(name, outer)
    return kinds


def _claim_sections(unit: Unit, name: str, kinds: set[str]) -> None:
    """Set the top class on the elements outside the body tree that have no class of their own."""
    # Sensors, keys and exclusions have no class: `<clock class="main"/>` violates the schema of MuJoCo 4.0.
    if kinds:
        why = _without_class(unit)
        for section in unit.root.iterchildren(*_CLASSED):
            tag = str(section.tag)
            tags = _CLASSED[tag] or ("*",)
            if tag in ("asset", "contact"):
                tags = tuple(kinds.intersection(tags))
            if not tags or (tag in ("equality", "tendon") and tag not in kinds):
                continue
            for element in section.iterchildren(*tags):
                if element.get("class") is None:
                    journal.write(element, "class", name, why)


def _without_class(unit: Unit) -> Why:
    return because(f"elements without a class have the top class of {unit.file_name}")


def _claim_world(unit: Unit, name: str) -> None:
    """Set the top class on elements in the world without a class. Below a body, its `childclass` has this effect."""
    # The world itself cannot take a class: "World body cannot have attributes" in MuJoCo 4.0.
    why = _without_class(unit)
    for worldbody in unit.root.iterchildren("worldbody"):
        for element in worldbody:
            tag = element.tag
            if tag in NESTED:
                if not element.get("childclass"):
                    journal.write(element, "childclass", name, why)
            elif tag in _TREE and element.get("class") is None:
                journal.write(element, "class", name, why)


# All tags of actuators share one row of a class in MuJoCo 4.0: after `<default><position kp="50"/></default>` a
# `<general joint="j"/>` is a servo with a gain of 50, while a `<motor joint="j"/>` has 1 and keeps the range.
_OF_ANY_KIND = ("general", "motor", "plugin")
"""They take all settings of the class, or none."""
_OF_NONE = ("motor", "plugin")
_MIXED = ""
"""The kind of a class that itself would find another gain."""
_GAINS = ("gaintype", "gainprm", "biastype", "biasprm", "dyntype", "dynprm")
_Gains = Mapping[Node, list[list[float]]]


class _Class(NamedTuple):
    """The kind of actuator that a class is for, and the number of the section that declares it."""

    kind: str | None
    section: int


class _Suspect(NamedTuple):
    """An actuator whose gain may change, its attributes, its class's kind, and an element that sets actuators later."""

    actuator: Node
    written: dict[str, str]
    kind: str | None
    later: Node


def top_level_defaults(linking: Linking) -> None:
    """Write the gain that several top-level `<default>` elements set for an actuator, or refuse it if impossible."""
    wrapped = [part.unit for part in linking.parts]
    if linking.base_class is not None:
        wrapped.append(linking.base)
    for unit in wrapped:
        suspects = list(_suspects(unit))
        alone = (_gains(linking, unit) if suspects else None) or {}
        # At last, MuJoCo's own values without a class.
        if alone:
            for gain in (_found, _found_in_the_end, lambda classes, own, tag: None):
                for suspect in suspects:
                    _write(unit, suspect.actuator, gain)
                there = _gains(linking, unit, wrap=True)
                suspects = [each for each in suspects if not there or alone[each.actuator] != there[each.actuator]]
                for suspect in suspects:
                    journal.drop_all(suspect.actuator)
                    journal.write_all(suspect.actuator, suspect.written)
                if not suspects:
                    break
        for actuator, _, kind, later in suspects:
            own = f"is of another kind, `<{kind}>`" if kind else "is of no kind of its own"
            why = f"its class {own}, and the top class of its file is written in several `<default>`"
            what = f"the `<{actuator.tag}>` {shown_name(actuator)} would take another gain in the composition"
            notes = (Note("one of them sets actuators here", linking.span(unit, later)),)
            help = "join the top-level `<default>` sections of the file into one"
            linking.sink.error("not-supported", f"{what}: {why}", linking.span(unit, actuator), notes=notes, help=help)


def _suspects(unit: Unit) -> Iterator[_Suspect]:
    """Yield actuators whose class is of another kind, if the top class changes between sections."""
    sections = list(unit.root.iterchildren("default"))
    setting = [at for at, section in enumerate(sections) if _actuators(section)]
    if not setting or setting == [0]:
        return
    # Each class begins as a copy of the enclosing class at that point.
    classes: dict[str, _Class] = {}
    for at, section in enumerate(sections):
        kind = classes[MAIN].kind if at else None
        _read(section, MAIN, _Class(kind, at), earlier=any(number < at for number in setting), found=classes)
    for actuator in unit.root.findall("actuator/*"):
        found = classes.get(str(actuator.get("class") or MAIN))
        if found is None or (len(setting) == 1 and setting[0] <= found.section):
            continue
        fine = _OF_NONE if found.kind == _MIXED else (found.kind, *_OF_ANY_KIND)
        if actuator.tag not in fine:
            later = _actuators(sections[setting[-1]])[0]
            written = {str(name): str(value) for name, value in actuator.items()}
            yield _Suspect(actuator, written, found.kind, later=later)


def _read(node: Node, name: str, around: _Class, earlier: bool, found: dict[str, _Class]) -> None:
    """Read a class. `earlier` says whether the top class has set actuators in an earlier section."""
    kind = around.kind
    for actuator in _actuators(node):
        tag = str(actuator.tag)
        if kind != _MIXED:
            kind = _MIXED if earlier and tag not in (kind, *_OF_ANY_KIND) else tag
    found[name] = _Class(kind, around.section)
    for nested in node.iterchildren("default"):
        _read(nested, str(nested.get("class", "")), found[name], earlier=earlier, found=found)


def _actuators(node: Node) -> list[Node]:
    return list(node.iterchildren(*GRAMMAR.section("actuator").children))


def _gains(linking: Linking, unit: Unit, *, wrap: bool = False) -> _Gains | None:
    """Return the gains that MuJoCo computes for the unit's actuators, unchanged or with its top class wrapped."""
    if linking.measure is None:
        return None
    copy = unit.copied()
    if wrap:
        defaults(Linking(copy, [], Sink(), request=linking.request, base_class=f"top{linking.request.separator}"))
    arrays = tuple(f"actuator_{name}" for name in _GAINS)
    measured = linking.measure(copy, arrays, attempt=wrap)
    own = unit.root.findall("actuator/*")
    element = dict(zip(copy.root.findall("actuator/*"), own, strict=True))
    rows = [element[element_of(each)] for each in actuators_in_order(copy.root)]
    if not measured or len(measured[arrays[0]]) != len(rows):
        return None
    found: dict[Node, list[list[float]]] = {each: [] for each in own}
    for array in arrays:
        width = len(measured[array]) // len(rows)
        for row, holder in enumerate(rows):
            found[holder].append(measured[array][row * width : (row + 1) * width])
    return found


def _write(unit: Unit, actuator: Node, gain: Callable[[Classes, DefaultClass, str], DefaultClass | None]) -> None:
    """Write the values of the class that `gain` finds, if the composition has other values."""
    from mjcompose.tree.classes import default_text  # few models need it

    tag = str(actuator.tag)
    own = unit.classes.get(actuator.get("class"))
    alone = gain(unit.classes, own, tag)
    there = _found(unit.classes, own, tag)
    common = GRAMMAR.element("actuator/motor").attributes
    # Next to the actuator's own: "kv and dampratio cannot both be defined" in MuJoCo 4.0.
    one_of = ("kv", "dampratio")
    excluded = one_of if any(actuator.get(name) is not None for name in one_of) else ()
    for name, attribute in GRAMMAR.element(f"actuator/{tag}").attributes.items():
        if name in common or name in excluded or not attribute.in_default or actuator.get(name) is not None:
            continue
        settings = [None if level is None else level.lookup(tag, name) for level in (alone, there)]
        value, other = (default_text(attribute) if setting is None else setting[0] for setting in settings)
        if value is not None and value != other:
            journal.write(actuator, name, value)


def _found(classes: Classes, own: DefaultClass, tag: str) -> DefaultClass | None:
    """Return the nearest class of an actuator's kind after the sections are wrapped."""
    return next((level for level in own.line() if _is_of(level, tag)), None)


def _found_in_the_end(classes: Classes, own: DefaultClass, tag: str) -> DefaultClass | None:
    """Return the nearest class of an actuator's kind if the top class is the result of all sections."""
    below = takewhile(lambda level: level.name != MAIN, own.line())
    return next((level for level in below if _is_of(level, tag)), None) or _found(classes, classes.get(MAIN), tag)


def _is_of(found: DefaultClass, tag: str) -> bool:
    """Return whether the last actuator settings of a class are for this tag."""
    own = found.elements.get(tag)
    section = own[0].getparent() if own else None
    return section is not None and _actuators(section)[-1].tag == tag

"""Reduce a unit to one body and exactly what that needs; everything else is left behind and listed.

This is done to a unit by itself, before it is linked to anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diagnostics.unknown import unknown_name
from composer.link.dependencies import drop_unneeded
from composer.link.inertia import MEASURED, write_inertias
from composer.link.key_layouts import VECTORS, keys_of, layout_of, remove_keys
from composer.link.layout import Holder
from composer.link.linking import Linking, Measure
from composer.link.multiplied import element_of
from composer.link.part_keys import cut_row
from composer.link.partition import Concern, Side
from composer.link.request import KeyPolicy
from composer.tree.attached import attached_notes
from composer.tree.classes import childclass_of
from composer.tree.key_number import KeyRecord, Number, texts
from composer.tree.names import declaration, word
from composer.tree.unit import Unit

# What holds for a model as a whole and not for a body of it. `option` and `size` say how the body is to be read.
_OF_THE_WHOLE = ("statistic", "visual")
_CONCERNING = ("contact", "deformable", "tendon", "equality", "actuator", "sensor", "custom", "asset")
_ALSO_SETTLED = ("inertiafromgeom", "inertiagrouprange")


@dataclass(frozen=True, slots=True)
class Left:
    """One thing that is left behind: its kind, its name and, if it reaches into the subtree, what it lacks."""

    what: str
    name: str
    lacks: str | None = None
    span: Span | None = None

    @property
    def called(self) -> str:
        return f"{self.what} `{self.name}`" if self.name else f"{self.what} without a name"


@dataclass(frozen=True, slots=True)
class Subtree:
    """One body is taken from the model, with exactly what it needs.

    `body` is its name, None if all of the unit is taken; `left` lists what is left behind.
    """

    body: str | None
    left: tuple[Left, ...]

    @property
    def cut(self) -> tuple[Left, ...]:
        """The elements that belong to both the subtree and the rest, and would have been cut in two."""
        return tuple(each for each in self.left if each.lacks is not None)


def take_subtree(
    unit: Unit,
    name: str,
    sink: Sink,
    *,
    span: Span | None = None,
    keyframes: KeyPolicy = "merge",
    measure: Measure | None = None,
) -> Subtree | None:
    """Keep only the body `name` of `unit` and what it needs. Return None if that is impossible, with errors in `sink`.

    The body keeps its pose relative to its parent, which becomes the world. What concerns also something outside of
    it is left behind as a whole. `measure` is asked for what only MuJoCo knows of the whole unit.
    """
    before = sink.error_count
    body = _find(unit, name, sink, span)
    if body is None:
        return None
    linking = Linking(unit, [], sink, measure=measure)
    _settle_mass(linking)
    rows = _rows(linking, keyframes)
    if sink.error_count > before:
        return None
    inside = list(body.iter("*"))
    kept = set(inside)
    outside = [
        each for top in unit.root.iterchildren("worldbody") for each in top.iter("*") if each not in kept
    ]
    in_world = next(body.iterancestors("body"), None) is None
    concern = Concern(unit, inside, outside, in_world=in_world)
    left = [*_named(outside), *_cut_in_the_tree(concern, unit, inside)]
    _make_root(unit, body)
    left += _leave_sections(unit, concern)
    left += _leave_keys(unit, rows)
    left += (Left(word(namespace), each) for namespace, each in drop_unneeded(unit))
    unit.forget_classes()
    return Subtree(name, tuple(left))


def _find(unit: Unit, name: str, sink: Sink, span: Span | None) -> Node | None:
    """Return the body with this name, or None with an error if it does not exist or MuJoCo makes several of it."""
    bodies = [each for top in unit.root.iterchildren("worldbody") for each in top.iter("body")]
    body = next((each for each in bodies if each.get("name") == name), None)
    if body is None:
        names = [str(each.get("name")) for each in bodies if each.get("name")]
        message, notes = f"`{unit.label}` has no body `{name}` to take", attached_notes(unit, name)
        sink.add(unknown_name("body", name, names, span, message=message, written="subtree: {}", notes=notes))
        return None
    copies = next(body.iterancestors("replicate"), None)
    if copies is not None:
        sink.error(
            "not-supported",
            f"the body `{name}` cannot be taken alone: it stands in a `<replicate>`, which makes several of it",
            span,
            notes=(Note("the `<replicate>`", unit.origins.span(copies, unit.file)),),
            help="take a body around the `<replicate>`",
            subjects=(name,),
        )
        return None
    return body


def _settle_mass(linking: Linking) -> None:
    """Write out the masses that `settotalmass` gives the bodies of the whole unit, before bodies are left out."""
    unit = linking.base
    if float(unit.settings.settotalmass) <= 0:
        return
    # MuJoCo 4.0 makes 1 and 1 of two equal bodies under `settotalmass="2"`; one of them alone would become 2.
    write_inertias(linking, unit)
    for compiler in unit.root.iterchildren("compiler"):
        for setting in (*MEASURED, *_ALSO_SETTLED):
            compiler.attrib.pop(setting, "")
    unit.forget_settings()


# -- the body tree ----------------------------------------------------------------------------------------------


def _named(elements: Iterable[Node]) -> Iterator[Left]:
    """Yield the elements of the body tree that are left out, without frames and elements that only shape others."""
    for element in elements:
        if element.tag in ("worldbody", "frame", "replicate"):
            continue
        declared = declaration(element, "worldbody")
        if declared is not None or element.tag in (
            "body",
            "geom",
            "joint",
            "freejoint",
            "site",
            "light",
            "camera",
        ):
            tag = str(element.tag)
            yield Left("joint" if tag == "freejoint" else tag, declared[1] if declared else "")


def _cut_in_the_tree(concern: Concern, unit: Unit, inside: list[Node]) -> Iterator[Left]:
    """Yield the cameras and lights of the subtree that look at a body outside of it."""
    for element in inside:
        if element.tag not in ("camera", "light"):
            continue
        side, lacks = concern.of(element, "worldbody")
        if side is Side.OUTSIDE:
            yield _cut(element, "worldbody", lacks, unit)
            concern.leave(element)
            parent = element.getparent()
            assert parent is not None
            parent.remove(element)


def _cut(element: Node, section: str, lacks: str, unit: Unit) -> Left:
    declared = declaration(element, section)
    return Left(
        _what(element, section), declared[1] if declared else "", lacks, unit.origins.span(element, unit.file)
    )


def _what(element: Node, section: str) -> str:
    """Return the word for an element: its namespace if its tag is ambiguous (`joint` of an equality), else its tag."""
    declared = declaration(element, section)
    if section in ("contact", "worldbody"):
        return str(element.tag)
    if section in ("tendon", "equality", "actuator", "sensor"):
        return section
    return word(declared[0]) if declared else str(element.tag)


def _make_root(unit: Unit, body: Node) -> None:
    """Make the body the only one in the world, inside the frames between it and its parent."""
    # The bodies and frames around it go, and with them the class in force.
    inherited = childclass_of(body)
    if inherited and not body.get("childclass"):
        body.set("childclass", inherited)
    owner = unit.origins.owner(body, unit.file)
    top = body
    while (frame := top.getparent()) is not None and frame.tag == "frame":
        for other in list(frame):
            if other is not top:
                frame.remove(other)
        top = frame
    worldbodies = list(unit.root.iterchildren("worldbody"))
    world = next(each for each in top.iterancestors("worldbody"))
    for other in worldbodies:
        if other is not world:
            unit.root.remove(other)
    parent = top.getparent()
    assert parent is not None
    parent.remove(top)
    for other in list(world):
        world.remove(other)
    world.append(top)
    unit.origins.own(top, owner)


# -- what stands outside of it ----------------------------------------------------------------------------------


def _leave_sections(unit: Unit, concern: Concern) -> Iterator[Left]:
    """Remove and yield every element of the other sections that does not belong to the subtree alone."""
    going: list[tuple[Node, Left]] = []
    staying: list[tuple[Node, str]] = []
    for section in list(unit.root.iterchildren("*")):
        tag = str(section.tag)
        if tag in _OF_THE_WHOLE:
            yield from _strip(section, looks=next(unit.root.iter("camera"), None) is not None)
            continue
        for element in section.iterchildren("*") if tag in _CONCERNING else ():
            if tag == "asset" and element.tag != "skin":
                continue
            side, lacks = concern.of(element, tag)
            if side is Side.BOTH:
                going.append((element, _cut(element, tag, lacks, unit)))
            elif side is Side.INSIDE:
                staying.append((element, tag))
            else:
                declared = declaration(element, tag)
                going.append((element, Left(_what(element, tag), declared[1] if declared else "")))
    needed = concern.needed_by(staying)
    for element, left in going:  # only now: what an element concerns is found by way of others
        if element in needed:
            continue
        parent = element.getparent()
        assert parent is not None
        parent.remove(element)
        yield left
    for section in list(unit.root.iterchildren(*_CONCERNING)):
        if next(section.iterchildren("*"), None) is None:
            unit.root.remove(section)


def _strip(section: Node, looks: bool) -> Iterator[Left]:
    """Remove from a section of the whole model what no body needs. A camera needs `znear` for its intrinsics."""
    root, tag = section.getparent(), str(section.tag)
    assert root is not None
    if section.attrib:
        section.attrib.clear()
        yield Left("setting", tag)
    for child in list(section):
        near = child.get("znear") if looks and child.tag == "map" else None
        if near is not None:  # the element itself, which knows its line
            child.attrib.clear()
            child.set("znear", near)
            continue
        section.remove(child)
        if isinstance(child.tag, str):
            yield Left("setting", f"{tag}/{child.tag}")
    if not len(section):
        root.remove(section)


# -- keyframes --------------------------------------------------------------------------------------------------

_Rows = Mapping[Node, Mapping[str, Mapping[Holder, list[Number]]]]


def _rows(linking: Linking, policy: KeyPolicy) -> _Rows:
    """Return the numbers of every key, by vector and by owner, before the unit is cut."""
    unit = linking.base
    for size in list(unit.root.iterchildren("size")):
        size.attrib.pop("nkey", "")  # keys that say nothing
        if not size.attrib:
            unit.root.remove(size)
    if policy == "none":
        remove_keys(unit)
    keys = keys_of(unit)
    layout = layout_of(linking, unit) if keys else None
    if layout is None:
        return {}
    return {
        key: {
            vector: cut_row(linking, unit, layout, key, vector) or {} for vector in VECTORS if key.get(vector)
        }
        for key in keys
    }


def _leave_keys(unit: Unit, rows: _Rows) -> Iterator[Left]:
    """Keep the numbers of each key that belong to the subtree. Remove and yield the keys without such numbers."""
    staying = set(unit.root.iter("*"))
    for key, vectors in rows.items():
        said = False
        record = KeyRecord()
        for vector, columns in vectors.items():
            row = [
                number
                for holder, numbers in columns.items()
                if element_of(holder) in staying
                for number in numbers
            ]
            said = said or bool(row)
            if row:
                key.set(vector, " ".join(texts(row)))
                record.numbers[vector] = row
            else:
                del key.attrib[vector]
        unit.origins.keys[key] = record
        if not said:
            section = key.getparent()
            assert section is not None
            section.remove(key)
            yield Left("key", str(key.get("name") or ""))
    for section in list(unit.root.iterchildren("keyframe")):
        if next(section.iterchildren("*"), None) is None:
            unit.root.remove(section)

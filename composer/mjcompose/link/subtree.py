"""Reduce a unit, before it is linked, to one body and the elements that it needs, and list the dropped elements."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import unknown_name
from mjcompose.link import numbers
from mjcompose.link.excerpt import SECTIONS, SUPPORTING, Excerpt, Name
from mjcompose.link.expansion import element_of
from mjcompose.link.inertia import MEASURED, write_inertias
from mjcompose.link.key_layout import Holder
from mjcompose.link.keyframes import cut_row
from mjcompose.link.linking import Linking, ModelMeasure
from mjcompose.link.unit_keys import VECTORS, keys_of, layout_of, remove_keys
from mjcompose.tree import journal
from mjcompose.tree.classes import childclass_of
from mjcompose.tree.edit import attached_notes, bones, is_rod, twisted_by
from mjcompose.tree.files import written_path
from mjcompose.tree.merged_settings import KeyPolicy
from mjcompose.tree.names import GENERATORS, WORLD, declaration, references, word
from mjcompose.tree.select import section_of
from mjcompose.tree.unit import KeyRecord, Number, Unit, texts

_SUPPORT = ("default", "asset", "extension")


def drop_unneeded(unit: Unit) -> list[Name]:
    """Remove assets, classes and plugins that no element and no needed class refers to, and return their names."""
    supporting = list(_supporting(unit))
    needed = _needed(unit, dict(reversed(supporting)))
    supporting += [
        (("plugin", str(plugin.get("plugin") or "")), plugin) for plugin in unit.root.iterfind("extension/plugin")
    ]
    dropped = [(name, node) for name, node in supporting if node not in needed]
    for _, node in dropped:
        journal.remove(node)
    _remove_empty_sections(unit, _SUPPORT)
    return [name for name, _ in dropped]


def _remove_empty_sections(unit: Unit, tags: Iterable[str]) -> None:
    for section in list(unit.root.iterchildren(*tags)):
        if next(section.iterchildren("*"), None) is None:
            journal.remove(section)


def _supporting(unit: Unit) -> Iterator[tuple[Name, Node]]:
    for element in unit.root.iterfind("asset/*"):
        declared = declaration(element, "asset")
        if declared is not None and declared[0] in SUPPORTING:
            yield declared, element
        # Nothing refers to a skin: MuJoCo draws every skin.
        elif declared is None and element.tag != "skin":
            yield (str(element.tag), ""), element
    for element in unit.root.iterfind("default//default"):
        yield ("default", str(element.get("class") or "")), element
    for instance in unit.root.iterfind("extension/plugin/instance"):
        yield ("instance", str(instance.get("name") or "")), instance


def _settings_of(default: Node) -> list[Node]:
    return [child for child in default.iterchildren("*") if child.tag != "default"]


def _needed(unit: Unit, supporting: dict[Name, Node]) -> set[Node]:
    needed: set[Node] = set()
    waiting: list[tuple[Node, str]] = []
    plugins: set[str] = set()

    def need(node: Node, section: str) -> None:
        if node not in needed:
            needed.add(node)
            waiting.append((node, section))

    for section in unit.root.iterchildren("*"):
        if section.tag not in _SUPPORT:
            waiting.append((section, str(section.tag)))
        elif section.tag == "default":
            need(section, "default")
        elif section.tag == "asset":
            waiting.extend((skin, "asset") for skin in section.iterchildren("skin"))
    while waiting:
        node, inside = waiting.pop()
        parent = node.getparent()
        # A class begins with the settings of its parent, so it needs the parent even if no element names that.
        if node.tag == "default" and parent is not None and parent.tag == "default":
            need(parent, "default")
        tops = _settings_of(node) if node.tag == "default" else [node]
        for top in tops:
            for name in references(top, inside):
                supporter = supporting.get(name)
                if supporter is not None:
                    need(supporter, section_of(supporter))
            plugins.update(str(plugin.get("plugin")) for plugin in top.iter("plugin"))
    for plugin in unit.root.iterfind("extension/plugin"):
        if plugin.get("plugin") in plugins or any(instance in needed for instance in plugin):
            needed.add(plugin)
    return needed


class ReferenceSide(NamedTuple):
    """Whether an element refers inside the subtree, outside, both or neither; `lacks` is the first one outside."""

    inside: bool = False
    outside: bool = False
    lacks: str = ""


def side_of_world(element: Node) -> str | None:
    """Return which body of a `connect` or a `weld` is the world; an omitted second body is the world."""
    if element.tag not in ("connect", "weld") or not (first := element.get("body1")):
        return None  # it is about sites
    second = element.get("body2") or WORLD
    if first == second:
        return None
    return "body1" if first == WORLD else "body2" if second == WORLD else None


class SideFinder:
    """Finds the side of elements by the names that they refer to, directly or through other elements.

    `known` are further names in the world: those that are not inside are outside.
    """

    def __init__(
        self,
        unit: Unit,
        inside: Iterable[Node],
        outside: Iterable[Node],
        *,
        in_world: bool = True,
        known: Container[Name] = (),
    ) -> None:
        self._unit = unit
        self._in_world = in_world
        self._inside = _Names(inside)
        self._outside = _Names(outside)
        self._known = known
        self._sides: dict[Node, ReferenceSide] = {}
        self._others: dict[tuple[str, str], tuple[Node, str]] = {}
        for section in unit.root.iterchildren(*SECTIONS):
            tag = str(section.tag)
            for element in section.iterchildren("*"):
                declared = declaration(element, tag)
                if declared is not None and declared[0] not in SUPPORTING:
                    self._others.setdefault(declared, (element, tag))

    def of(self, element: Node, section: str) -> ReferenceSide:
        """Return the side that an element of that section belongs to."""
        known = self._sides.get(element)
        if known is not None:
            return known
        self._sides[element] = ReferenceSide()  # for elements that refer to one another in a ring
        within = False
        without = False
        lacks = ""
        others = []
        if element.tag == "skin" and (file := element.get("file")):
            named = bones(self._unit.source_of(written_path(self._unit.settings, element, str(file))))
            within = named is None  # it is reported when its file is read
            others = [("body", bone) for bone in named or ()]
        if is_rod(element):
            twists = self._inside.names | self._outside.names
            rod = str(element.get("name") or "")
            others += sorted(each for each in twists if each[0] == "joint" and rod and twisted_by(each[1]) == rod)
        for namespace, name in (*references(element, section), *others):
            side = self._of_name(namespace, name)
            within = within or side.inside
            without = without or side.outside
            lacks = lacks or side.lacks
        # Another body becomes the world of the subtree, which an equality with the world does not follow.
        if not self._in_world and section == "equality" and side_of_world(element) is not None:
            without = True
            lacks = lacks or "the world"
        side = self._sides[element] = ReferenceSide(within, without, lacks)
        return side

    def needed_by(self, elements: Iterable[tuple[Node, str]]) -> set[Node]:
        """Return elements of no side that the given elements refer to, such as the numbers in a tuple."""
        needed: set[Node] = set()
        waiting = list(elements)
        while waiting:
            for name in references(*waiting.pop()):
                other = self._others.get(name)
                if other is not None and other[0] not in needed and self.of(*other)[:2] == (False, False):
                    needed.add(other[0])
                    waiting.append(other)
        return needed

    def leave(self, element: Node) -> None:
        declared = declaration(element, "worldbody")
        if declared is not None:
            self._inside.names.discard(declared)
            self._outside.names.add(declared)

    def _of_name(self, namespace: str, name: str) -> ReferenceSide:
        if namespace in SUPPORTING or (namespace == "body" and name == WORLD):
            return ReferenceSide()
        key = namespace, name
        if key in self._inside.names:
            return ReferenceSide(inside=True)
        if key in self._outside.names or key in self._known:
            side = ReferenceSide(outside=True)
        elif (other := self._others.get(key)) is not None:
            side = self.of(*other)
        else:
            inside = self._inside.makes(name)
            outside = self._outside.makes(name)
            side = ReferenceSide(0 < inside >= outside, outside > inside)
        return side._replace(lacks=f"the {word(namespace)} `{name}`") if side.outside else side


class _Names:
    """The names on one side of the body tree, and the prefixes of the names that MuJoCo generates there."""

    def __init__(self, elements: Iterable[Node]) -> None:
        self.names: set[tuple[str, str]] = set()
        self._numbered: set[str] = set()
        self._begun: set[str] = set()
        for element in elements:
            declared = declaration(element, "worldbody")
            if declared is not None:
                self.names.add(declared)
                if next(element.iterancestors("replicate"), None) is not None:
                    self._numbered.add(declared[1])
            if element.tag in GENERATORS and element.tag != "replicate":
                self._begun.add(str(element.get("name") or element.get("prefix") or ""))

    def makes(self, name: str) -> int:
        """Return the length of the start of the name that names an element that MuJoCo multiplies, or 0."""
        starts = [start for start in self._begun if name.startswith(start)]
        starts += [start for start in self._numbered if name.startswith(start) and name[len(start) :][-1:].isdigit()]
        return max((len(start) + 1 for start in starts), default=0)


# Settings of a whole model and not of a body. `option` and `size` determine how to read the body.
_OF_THE_WHOLE = ("statistic", "visual")


class DroppedElement(Struct):
    """A dropped element: its kind, its name and, if it refers into the subtree, the element that it lacks."""

    what: str
    name: str
    lacks: str | None = None
    span: Span | None = None

    @property
    def called(self) -> str:
        return f"{self.what} `{self.name}`" if self.name else f"{self.what} without a name"


class Subtree(Struct):
    """One body of a model by its name, or None for the whole unit, and the elements that were dropped.

    `cut` are those that refer into the subtree and out of it. `list_dropped` returns all.
    """

    body: str | None
    cut: tuple[DroppedElement, ...]
    list_dropped: Callable[[], tuple[DroppedElement, ...]]

    @classmethod
    def of(cls, body: str | None, dropped: tuple[DroppedElement, ...]) -> Subtree:
        return cls(body, _cut(dropped), lambda: dropped)

    @property
    def dropped(self) -> tuple[DroppedElement, ...]:
        return self.list_dropped()

    def with_dropped(self, more: tuple[DroppedElement, ...]) -> Subtree:
        """Return the same with elements that were dropped afterwards."""
        return Subtree(self.body, (*self.cut, *_cut(more)), lambda: (*self.dropped, *more))


def _cut(dropped: Iterable[DroppedElement]) -> tuple[DroppedElement, ...]:
    return tuple(each for each in dropped if each.lacks is not None)


def take_from_excerpt(
    excerpt: Excerpt,
    sink: Sink,
    *,
    span: Span | None = None,
    keyframes: KeyPolicy = "merge",
    measure: ModelMeasure | None = None,
) -> Subtree | None:
    """Do as `take_subtree` in an excerpt of its source. The list of all dropped elements is made on request."""

    def list_dropped() -> tuple[DroppedElement, ...]:
        unit = excerpt.whole.copied()
        subtree = take_subtree(unit, excerpt.body, Sink(), span=span, keyframes=keyframes, measure=measure)
        return () if subtree is None else subtree.dropped

    subtree = take_subtree(
        excerpt.unit, excerpt.body, sink, span=span, keyframes=keyframes, measure=measure, known=excerpt.names
    )
    return None if subtree is None else replace(subtree, list_dropped=list_dropped)


def take_subtree(
    unit: Unit,
    name: str,
    sink: Sink,
    *,
    span: Span | None = None,
    keyframes: KeyPolicy = "merge",
    measure: ModelMeasure | None = None,
    known: Container[Name] = (),
) -> Subtree | None:
    """Keep the body `name` of `unit` and the elements that it needs. Return None after errors, which are reported.

    The body keeps its pose relative to its parent, which becomes the world. Elements that also refer outside the body
    are dropped. `measure` gets the values of the whole unit that only MuJoCo knows. `known` are names in the world of
    the source of which the unit is an excerpt.
    """
    before = sink.error_count
    body = _find(unit, name, sink, span=span)
    if body is None:
        return None
    linking = Linking(unit, [], sink, measure=measure)
    _settle_mass(linking)
    rows = _rows(linking, keyframes)
    if sink.error_count > before:
        return None
    inside = list(body.iter("*"))
    kept = set(inside)
    outside = [each for top in unit.root.iterchildren("worldbody") for each in top.iter("*") if each not in kept]
    in_world = next(body.iterancestors("body"), None) is None
    sides = SideFinder(unit, inside, outside, in_world=in_world, known=known)
    dropped = [*_named(outside), *_cut_in_the_tree(sides, unit, inside)]
    _make_root(unit, body)
    dropped += _drop_from_sections(unit, sides)
    dropped += _drop_from_keys(unit, rows)
    dropped += (DroppedElement(word(namespace), each) for namespace, each in drop_unneeded(unit))
    unit.forget_classes()
    return Subtree.of(name, tuple(dropped))


def _find(unit: Unit, name: str, sink: Sink, span: Span | None) -> Node | None:
    bodies = unit.root.findall("worldbody//body")
    body = next((each for each in bodies if each.get("name") == name), None)
    if body is None:
        names = [str(each.get("name")) for each in bodies if each.get("name")]
        message = f"`{unit.label}` has no body `{name}` to take"
        notes = attached_notes(unit, name)
        sink.add(unknown_name("body", name, names, span=span, message=message, written="subtree: {}", notes=notes))
        return None
    copies = next(body.iterancestors("replicate"), None)
    if copies is not None:
        message = f"the body `{name}` cannot be taken alone: it is in a `<replicate>`, which copies it"
        notes = [Note("the `<replicate>`", unit.origins.span(copies, unit.file))]
        help = "take a body around the `<replicate>`"
        sink.error("not-supported", message, span, notes=notes, help=help, subjects=(name,))
        return None
    return body


def _settle_mass(linking: Linking) -> None:
    """Write out the masses that `settotalmass` gives the bodies of the whole unit, before bodies are dropped."""
    unit = linking.base
    if numbers.first(unit.settings.settotalmass) <= 0:
        return
    # MuJoCo 4.0 makes 1 and 1 of two equal bodies under `settotalmass="2"`; one of them alone would become 2.
    write_inertias(linking, unit)
    for compiler in unit.root.iterchildren("compiler"):
        for setting in (*MEASURED, "inertiafromgeom", "inertiagrouprange"):
            journal.drop(compiler, setting)
    unit.forget_settings()


def _named(elements: Iterable[Node]) -> Iterator[DroppedElement]:
    """Yield dropped elements of the body tree, without frames and elements that only shape others."""
    for element in elements:
        if element.tag in ("worldbody", "frame", "replicate"):
            continue
        declared = declaration(element, "worldbody")
        if declared is not None or element.tag in ("body", "geom", "joint", "freejoint", "site", "light", "camera"):
            tag = str(element.tag)
            yield DroppedElement("joint" if tag == "freejoint" else tag, declared[1] if declared else "")


def _cut_in_the_tree(sides: SideFinder, unit: Unit, inside: list[Node]) -> Iterator[DroppedElement]:
    """Remove and yield the cameras and lights of the subtree that look at a body outside it."""
    for element in inside:
        if element.tag in ("camera", "light"):
            side = sides.of(element, "worldbody")
            if side.outside and not side.inside:
                yield _dropped(unit, element, "worldbody", lacks=side.lacks)
                sides.leave(element)
                journal.remove(element)


def _dropped(unit: Unit, element: Node, section: str, lacks: str | None) -> DroppedElement:
    """Return the record of an element. Its kind is its namespace if its tag is ambiguous (`joint` of an equality)."""
    declared = declaration(element, section)
    kind = str(element.tag)
    if section in ("tendon", "equality", "actuator", "sensor"):
        kind = section
    elif declared and section not in ("contact", "worldbody"):
        kind = word(declared[0])
    span = None if lacks is None else unit.origins.span(element, unit.file)
    return DroppedElement(kind, declared[1] if declared else "", lacks, span=span)


def _make_root(unit: Unit, body: Node) -> None:
    """Make the body the only one in the world, inside the frames between it and its parent."""
    # With the bodies and frames around it, the class in force goes.
    inherited = childclass_of(body)
    if inherited and not body.get("childclass"):
        journal.write(body, "childclass", inherited)
    owner = unit.origins.owner(body, unit.file)
    top = body
    while (frame := top.getparent()) is not None and frame.tag == "frame":
        for other in list(frame):
            if other is not top:
                journal.remove(other)
        top = frame
    worldbodies = list(unit.root.iterchildren("worldbody"))
    world = next(top.iterancestors("worldbody"))
    for other in worldbodies:
        if other is not world:
            journal.remove(other)
    journal.remove(top)
    for other in list(world):
        journal.remove(other)
    journal.place(world, top)
    unit.origins.own(top, owner)


def _drop_from_sections(unit: Unit, sides: SideFinder) -> Iterator[DroppedElement]:
    """Remove and yield every element of the other sections that does not belong only to the subtree."""
    going: list[tuple[Node, DroppedElement]] = []
    staying: list[tuple[Node, str]] = []
    for section in list(unit.root.iterchildren("*")):
        tag = str(section.tag)
        if tag in _OF_THE_WHOLE:
            yield from _strip_section(section, looks=unit.root.find("worldbody//camera") is not None)
            continue
        if tag in SECTIONS:
            for element in section.iterchildren("*"):
                if tag == "asset" and element.tag != "skin":
                    continue
                side = sides.of(element, tag)
                if side.inside and not side.outside:
                    staying.append((element, tag))
                else:
                    going.append((element, _dropped(unit, element, tag, lacks=side.lacks if side.inside else None)))
    needed = sides.needed_by(staying)
    for element, dropped in going:  # only now: the side of an element may depend on others
        if element not in needed:
            journal.remove(element)
            yield dropped
    _remove_empty_sections(unit, SECTIONS)


def _strip_section(section: Node, looks: bool) -> Iterator[DroppedElement]:
    """Remove a section of the whole model, except `znear` for a camera, which needs it for its intrinsics."""
    root = section.getparent()
    tag = str(section.tag)
    assert root is not None
    if section.attrib:
        journal.drop_all(section)
        yield DroppedElement("setting", tag)
    for child in list(section):
        near = child.get("znear") if looks and child.tag == "map" else None
        if near is not None:  # the element itself, which knows its line
            journal.drop_all(child)
            journal.write(child, "znear", near)
            continue
        journal.remove(child)
        if isinstance(child.tag, str):
            yield DroppedElement("setting", f"{tag}/{child.tag}")
    if not len(section):
        journal.remove(section)


_Rows = Mapping[Node, Mapping[str, Mapping[Holder, list[Number]]]]


def _rows(linking: Linking, policy: KeyPolicy) -> _Rows:
    unit = linking.base
    for size in list(unit.root.iterchildren("size")):
        journal.drop(size, "nkey")  # keys that say nothing
        if not size.attrib:
            journal.remove(size)
    if policy == "none":
        remove_keys(unit.root)
    keys = keys_of(unit)
    layout = layout_of(linking, unit) if keys else None
    if layout is None:
        return {}
    return {
        key: {each: cut_row(linking, unit, layout, element=key, vector=each) or {} for each in VECTORS if key.get(each)}
        for key in keys
    }


def _drop_from_keys(unit: Unit, rows: _Rows) -> Iterator[DroppedElement]:
    """Keep the numbers of each key that belong to the subtree. Remove and yield the keys without such numbers."""
    staying = set(unit.root.iter("*"))
    for key, vectors in rows.items():
        record = KeyRecord()
        for vector, columns in vectors.items():
            row = [number for holder, numbers in columns.items() if element_of(holder) in staying for number in numbers]
            if row:
                journal.write(key, vector, " ".join(texts(row)))
                record.numbers[vector] = row
            else:
                journal.drop(key, vector)
        unit.origins.keys[key] = record
        if not record.numbers:
            journal.remove(key)
            yield DroppedElement("key", str(key.get("name") or ""))
    _remove_empty_sections(unit, ("keyframe",))

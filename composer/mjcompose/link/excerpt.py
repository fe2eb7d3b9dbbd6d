"""Excerpts of a source: one body with all elements that may belong to its subtree, without the rest of the source.

`take_subtree` decides in an excerpt as in a copy of the whole source. An index of the source serves all of its bodies,
and the cost of an excerpt grows with its own size alone.
"""

from __future__ import annotations

import copy
from collections.abc import Container, Iterable, Mapping
from dataclasses import field, replace
from itertools import chain

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.link import numbers
from mjcompose.link.unit_keys import keys_of
from mjcompose.tree.edit import is_rod
from mjcompose.tree.names import GENERATORS, declaration, own_references, references
from mjcompose.tree.unit import Unit, line_of, set_line

Name = tuple[str, str]

SUPPORTING = frozenset({"default", "mesh", "material", "texture", "hfield", "model", "instance", "key"})
"""The namespaces of elements that have no side: a subtree takes those that it needs."""
SECTIONS = ("contact", "deformable", "tendon", "equality", "actuator", "sensor", "custom", "asset")
"""The sections whose elements may belong to a body."""
_WORLD = "worldbody"


class Excerpt(Struct, eq=False):
    """A unit that is `body` of the unit `whole` and all that may belong to it; `names` has all names of the world."""

    unit: Unit
    body: str
    names: Container[Name]
    whole: Unit


class _Tops(Struct, frozen=False):
    """Elements of sections, and classes: by the names that they declare, and with the names that they refer to."""

    declared: dict[Name, Node] = field(default_factory=dict)
    users: dict[Name, list[Node]] = field(default_factory=dict)
    referred: dict[Node, list[Name]] = field(default_factory=dict)

    def note(self, top: Node, names: Iterable[Name]) -> None:
        self.referred[top] = list(dict.fromkeys(names))
        for name in self.referred[top]:
            self.users.setdefault(name, []).append(top)


class ExcerptSource:
    """A source from which excerpts are made. It must not change."""

    def __init__(self, unit: Unit) -> None:
        self._unit = unit
        self._tops = _Tops()
        self._bodies: dict[str, Node] = {}
        self._names: set[Name] = set()
        self._order: dict[Node, int] = {}
        self._fixed: dict[Node, list[Node]] = {}
        self._size = unit.origins.size
        for number, node in enumerate(unit.root.iter()):
            self._order[node] = number
        for section in unit.root.iterchildren("*"):
            if section.tag == _WORLD:
                self._note_world(section)
            elif section.tag == "default":
                for class_ in section.iter("default"):
                    self._note_class(class_, is_top=class_ is section)
            elif section.tag in SECTIONS:
                self._note_section(section)

    @staticmethod
    def of(unit: Unit) -> ExcerptSource | None:
        """Return the source, or None if the subtree of a body depends on more than the names in its file.

        Masses of the whole model, keys, bodies that MuJoCo makes, and bones in the file of a skin are such cases.
        """
        depends_on_all = (
            numbers.first(unit.settings.settotalmass) > 0
            or bool(unit.part_keys)
            or bool(keys_of(unit))
            or next(unit.root.iter("skin", *GENERATORS), None) is not None
            or any(is_rod(flex) for flex in unit.root.iter("flex"))
        )
        return None if depends_on_all else ExcerptSource(unit)

    def excerpt(self, name: str) -> Excerpt | None:
        """Return the excerpt with the body of that name, or None if there is no such body."""
        body = self._bodies.get(name)
        if body is None:
            return None
        copied = _Copy(self._order, self._fixed, self._kept(body))
        root = copied.root(self._unit.root, body)
        header = tuple(twin for node, twin in copied.pairs if node in self._unit.header)
        origins = self._unit.origins.carried_to(copied.pairs)
        origins.size = self._size
        self._size = 0  # the files were read once
        unit = replace(self._unit, root=root, origins=origins, header=header)
        return Excerpt(unit, name, self._names, self._unit)

    def _note_world(self, world: Node) -> None:
        for element in world.iter("*"):
            named = declaration(element, _WORLD)
            if named is not None:
                self._names.add(named)
                if element.tag == "body":
                    self._bodies.setdefault(named[1], element)

    def _note_class(self, class_: Node, is_top: bool) -> None:
        settings = [child for child in class_ if child.tag != "default"]
        self._fixed[class_] = settings
        names = (references(child, "default") for child in settings if isinstance(child.tag, str))
        self._tops.note(class_, chain.from_iterable(names))
        if not is_top:
            self._tops.declared.setdefault(("default", str(class_.get("class") or "")), class_)

    def _note_section(self, section: Node) -> None:
        tag = str(section.tag)
        self._fixed[section] = [child for child in section if not isinstance(child.tag, str)]
        for top in section.iterchildren("*"):
            self._tops.note(top, references(top, tag))
            named = declaration(top, tag)
            if named is not None:
                self._tops.declared.setdefault(named, top)

    def _kept(self, body: Node) -> set[Node]:
        """Return the elements of sections that may belong to a body, directly or through others, and their support."""
        kept: set[Node] = set()
        waiting = [named for element in body.iter("*") if (named := declaration(element, _WORLD)) is not None]
        while waiting:
            for user in self._tops.users.get(waiting.pop(), ()):
                section = user.getparent()
                if user in kept or section is None or user.tag == "default":
                    continue
                kept.add(user)
                named = declaration(user, str(section.tag))
                if named is not None and named[0] not in SUPPORTING:
                    waiting.append(named)
        self._add_support(kept, body)
        return kept

    def _add_support(self, kept: set[Node], body: Node) -> None:
        """Add the elements that the body and the kept elements refer to: classes, assets, and elements of sections."""
        tops = list(self._unit.root.iterchildren("default"))
        waiting = [*kept, *tops]
        kept.update(tops)
        names = list(references(body, _WORLD))
        for around in body.iterancestors():
            names += [(namespace, name) for _, namespace, name, _ in own_references(around, _WORLD)]
        while names or waiting:
            if waiting:
                names += self._tops.referred[waiting.pop()]
                continue
            node = self._tops.declared.get(names.pop())
            while node is not None and node not in kept:
                kept.add(node)
                waiting.append(node)
                # A class begins with the settings of its parent.
                node = node.getparent() if node.tag == "default" else None


class _Copy:
    """Copies parts of a tree in the order of the tree; `pairs` has each node with its copy.

    `fixed` has the children of sections and classes that each copy has, such as comments, and `kept` has the others.
    """

    def __init__(self, order: Mapping[Node, int], fixed: Mapping[Node, list[Node]], kept: Iterable[Node]) -> None:
        self._order = order
        self._fixed = fixed
        self._kept: dict[Node, list[Node]] = {}
        for node in kept:
            if (parent := node.getparent()) is not None:
                self._kept.setdefault(parent, []).append(node)
        self.pairs: list[tuple[Node, Node]] = []

    def root(self, root: Node, body: Node) -> Node:
        """Return a copy of the root: of its world, only the elements around `body`, and of other sections the kept."""
        around = set(body.iterancestors(_WORLD))
        twin = self._shell(root)
        for section in root:
            if section.tag == _WORLD:
                if section in around:
                    twin.append(self._path(section, body))
            elif section.tag == "default":
                twin.append(self._reduced(section))
            elif section.tag not in SECTIONS:
                twin.append(self._whole(section))
            elif section in self._kept:
                twin.append(self._reduced(section))
        return twin

    def _whole(self, node: Node) -> Node:
        twin = copy.deepcopy(node)
        self.pairs += zip(node.iter(), twin.iter(), strict=True)
        return twin

    def _shell(self, node: Node) -> Node:
        """Return a copy without children."""
        attributes = {str(name): str(value) for name, value in node.attrib.items()}
        twin = node.makeelement(str(node.tag), attributes, node.nsmap)  # type: ignore[arg-type]  # None stands for no prefix
        twin.text = node.text
        twin.tail = node.tail
        set_line(twin, line_of(node))
        self.pairs.append((node, twin))
        return twin

    def _reduced(self, node: Node) -> Node:
        """Return a copy of a section or a class with its fixed and its kept children."""
        twin = self._shell(node)
        children = [*self._fixed[node], *self._kept.get(node, ())]
        for child in sorted(children, key=self._order.__getitem__):
            twin.append(self._reduced(child) if child.tag == "default" else self._whole(child))
        return twin

    def _path(self, world: Node, body: Node) -> Node:
        """Return a copy of the world with nothing but the elements between it and the body, and the body."""
        twin = self._whole(body)
        for node in body.iterancestors():
            outer = self._shell(node)
            outer.append(twin)
            twin = outer
            if node is world:
                break
        return twin

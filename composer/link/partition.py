"""Decide, for a model that is split in two, to which side the elements outside the body tree belong."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.tree.editable import is_rod, twisted_by
from composer.tree.files import written_path
from composer.tree.names import GENERATORS, WORLD, declaration, references, word
from composer.tree.skin_file import bones
from composer.tree.unit import Unit

# Whoever needs one of these takes it along: they concern no side.
SUPPORTING = frozenset({"default", "mesh", "material", "texture", "hfield", "model", "instance", "key"})
_SECTIONS = ("contact", "deformable", "tendon", "equality", "actuator", "sensor", "custom", "asset")


class Side(Enum):
    """The side to which an element refers: the inside of the subtree, the outside, both, or neither."""

    INSIDE = "inside"
    OUTSIDE = "outside"
    BOTH = "both"
    NEITHER = "neither"


class Verdict(NamedTuple):
    """The side of an element, and the first thing outside that it refers to, as messages name it."""

    side: Side
    lacks: str = ""


def side_of_world(element: Node) -> str | None:
    """Return which body of a `connect` or a `weld` is the world: the second also if it is not named."""
    if element.tag not in ("connect", "weld") or not (first := element.get("body1")):
        return None  # it is about sites
    second = element.get("body2") or WORLD
    if first == second:
        return None
    return "body1" if first == WORLD else "body2" if second == WORLD else None


class Concern:
    """Finds the side of elements from the names they refer to, directly or through others.

    A sensor may, for example, refer to an actuator that refers to a joint.
    """

    def __init__(
        self, unit: Unit, inside: Iterable[Node], outside: Iterable[Node], *, in_world: bool = True
    ) -> None:
        self._unit, self._in_world = unit, in_world
        self._inside = _Names(inside)
        self._outside = _Names(outside)
        self._verdicts: dict[Node, Verdict] = {}
        self._others: dict[tuple[str, str], tuple[Node, str]] = {}
        for section in unit.root.iterchildren(*_SECTIONS):
            tag = str(section.tag)
            for element in section.iterchildren("*"):
                declared = declaration(element, tag)
                if declared is not None and declared[0] not in SUPPORTING:
                    self._others.setdefault(declared, (element, tag))

    def of(self, element: Node, section: str) -> Verdict:
        """Return the side that an element of that section belongs to."""
        known = self._verdicts.get(element)
        if known is not None:
            return known
        self._verdicts[element] = Verdict(Side.NEITHER)  # for elements that refer to one another in a ring
        within, without, lacks = False, False, ""
        bones: list[str] | None = []
        if element.tag == "skin" and element.get("file"):
            bones = self._bones(element)
            within = bones is None  # it is reported when its file is read
        others = [("body", bone) for bone in bones or ()]
        if is_rod(element):
            twists = self._inside.names | self._outside.names
            rod = str(element.get("name") or "")
            others += sorted(
                each for each in twists if each[0] == "joint" and rod and twisted_by(each[1]) == rod
            )
        for namespace, name in (*references(element, section), *others):
            verdict = self._of_name(namespace, name)
            within = within or verdict.side in (Side.INSIDE, Side.BOTH)
            without = without or verdict.side in (Side.OUTSIDE, Side.BOTH)
            lacks = lacks or verdict.lacks
        # Another body becomes the world of what is taken, which an equality with the world does not follow.
        if not self._in_world and section == "equality" and side_of_world(element) is not None:
            without, lacks = True, lacks or "the world"
        side = (
            (Side.BOTH if without else Side.INSIDE) if within else (Side.OUTSIDE if without else Side.NEITHER)
        )
        verdict = self._verdicts[element] = Verdict(side, lacks)
        return verdict

    def needed_by(self, elements: Iterable[tuple[Node, str]]) -> set[Node]:
        """Return elements of no side that the given elements refer to, such as the numbers in a tuple."""
        needed: set[Node] = set()
        waiting = list(elements)
        while waiting:
            for name in references(*waiting.pop()):
                other = self._others.get(name)
                if other is not None and other[0] not in needed and self.of(*other).side is Side.NEITHER:
                    needed.add(other[0])
                    waiting.append(other)
        return needed

    def leave(self, element: Node) -> None:
        """Mark an element of the tree as not taken."""
        declared = declaration(element, "worldbody")
        if declared is not None:
            self._inside.names.discard(declared)
            self._outside.names.add(declared)

    def _of_name(self, namespace: str, name: str) -> Verdict:
        if namespace in SUPPORTING or (namespace == "body" and name == WORLD):
            return Verdict(Side.NEITHER)
        key = namespace, name
        if key in self._inside.names:
            return Verdict(Side.INSIDE)
        if key in self._outside.names:
            return Verdict(Side.OUTSIDE, f"the {word(namespace)} `{name}`")
        other = self._others.get(key)
        if other is not None:
            verdict = self.of(*other)
            if verdict.side in (Side.OUTSIDE, Side.BOTH):
                return verdict._replace(lacks=f"the {word(namespace)} `{name}`")
            return verdict
        inside, outside = self._inside.makes(name), self._outside.makes(name)
        if outside > inside:
            return Verdict(Side.OUTSIDE, f"the {word(namespace)} `{name}`")
        return Verdict(Side.INSIDE if inside else Side.NEITHER)

    def _bones(self, skin: Node) -> list[str] | None:
        """Return the bodies that a skin file names, or None if it cannot be read."""
        unit = self._unit
        path = written_path(unit.settings, skin, str(skin.get("file")))
        return bones(unit.source_of(path))


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
        """Return the length of the name's beginning that is the name of something that MuJoCo multiplies, or 0."""
        starts = [start for start in self._begun if name.startswith(start)]
        starts += [
            start for start in self._numbered if name.startswith(start) and name[len(start) :][-1:].isdigit()
        ]
        return max((len(start) + 1 for start in starts), default=0)

"""Find the elements of a model that a selector matches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field
from functools import cache
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR
from composer.grammar.characters import NOT_XML
from composer.tree.classes import MAIN, Classes
from composer.tree.effective import chain
from composer.tree.files import NAMED_AFTER_FILE
from composer.tree.glob import matcher
from composer.tree.kinds import kind_of, naming_attribute, section_of
from composer.tree.name_index import own_name
from composer.tree.names import WORLD
from composer.tree.pattern import fitter, is_pattern
from composer.tree.selector import EVERYTHING, Selector, paths_of

# They do not count as parents, because MuJoCo resolves them.
_TRANSPARENT = ("frame", "replicate")
_WITH_NAME: Any = etree.XPath("descendant::*[@name=$name]")
BASE = "base"


@cache
def _is_written_as_name(paths: frozenset[str]) -> bool:
    """Return whether the name of these elements is always their attribute `name`."""
    kinds = [GRAMMAR.element(path) for path in paths]
    namings = [naming_attribute(kind) for kind in kinds]
    return all(each is not None and each.name == "name" for each in namings) and not any(
        kind.tag in NAMED_AFTER_FILE for kind in kinds
    )


def name_of(node: Node) -> str | None:
    """Return the name that a selector uses for an element; the top class is `main`."""
    naming = naming_attribute(kind_of(node))
    if node.tag == "default":
        parent = node.getparent()
        if parent is not None and parent.tag != "default":
            return str(node.get("class") or MAIN)
    return None if naming is None else own_name(node, naming.name)


def parent_of(node: Node) -> Node | None:
    """Return the parent as in MuJoCo, ignoring frames."""
    parent = node.getparent()
    while parent is not None and parent.tag in _TRANSPARENT:
        parent = parent.getparent()
    return parent


def numbered(parent: Node, tag: str) -> dict[Node, int]:
    """Return the elements of a tag without a name in a parent, ignoring frames, each with its number from 0.

    >>> body = etree.fromstring('<body><geom name="a"/><frame><geom/></frame><body><geom/></body><geom/></body>')
    >>> list(numbered(body, "geom").values())
    [0, 1]
    """
    found: list[Node] = []
    ahead = list(parent)[::-1]
    while ahead:
        node = ahead.pop()
        if node.tag in _TRANSPARENT:
            ahead += list(node)[::-1]
        if node.tag == tag and not name_of(node):
            found.append(node)
    return {node: number for number, node in enumerate(found)}


@dataclass
class Selection:
    """Finds elements in one model.

    `parts` has the part of each element, with `/` for nested ones; other elements belong to the base. `holds`
    evaluates `where`. `base_class` is the name of the base's top class here, if it is not `main`.
    """

    root: Node
    classes: Classes
    separator: str = "/"
    parts: Mapping[Node, str] = field(default_factory=dict)
    base_class: str | None = None
    holds: Callable[[Node, Selector], bool] = lambda node, selector: True
    _fits: dict[str, Callable[[str], bool]] = field(default_factory=dict)
    _known: dict[int, dict[Node, bool]] = field(default_factory=dict)
    _numbers: dict[tuple[Node, str], dict[Node, int]] = field(default_factory=dict)

    def of(self, selector: Selector) -> list[Node]:
        """Return every matching element, in the order of the tree. Raises `BadPattern`."""
        self._known.clear()  # the model may have changed
        self._numbers.clear()
        return self._of(selector)

    def _of(self, selector: Selector) -> list[Node]:
        found = self._called(selector)
        if found is None:
            found = [node for node in self.of_kind(selector) if self._named(node, selector.pattern)]
        return [node for node in found if self._narrowed(node, selector)]

    def of_kind(self, selector: Selector) -> Iterator[Node]:
        """Yield the elements of that tag, whatever their names."""
        paths = paths_of(selector.tag)
        tags = {path.rpartition("/")[2] for path in paths}
        in_classes = any(path.startswith("default") for path in paths)
        for section in self.root.iterchildren("*"):
            if (section.tag == "default") != in_classes:
                continue
            if section.tag == "worldbody" and "body" in paths and selector.pattern == WORLD:
                yield section
            for node in section.iter(*tags):
                if kind_of(node).path in paths:
                    yield node

    def _called(self, selector: Selector) -> list[Node] | None:
        """Find elements by a single name without visiting all others; return None if that is not possible."""
        name, paths = selector.pattern, paths_of(selector.tag)
        if name == WORLD or is_pattern(name) or not _is_written_as_name(paths):
            return None
        if NOT_XML.search(name):
            return []  # libxml2 refuses such text, and no element has such a name
        return [
            node
            for section in self.root.iterchildren("*")
            if section.tag != "default"
            for node in _WITH_NAME(section, name=name)
            if kind_of(node).path in paths
        ]

    def names(self, selector: Selector) -> list[str]:
        """Return the names of elements with that tag."""
        return [name for node in self.of_kind(selector) if (name := self.name(node))]

    def name(self, node: Node) -> str | None:
        """Return a selector's name for an element."""
        if node.tag == "worldbody":
            return WORLD
        name = name_of(node)
        return MAIN if node.tag == "default" and name == self.base_class else name

    def number(self, node: Node) -> int:
        """Return the number of an element among those of its tag without a name in its parent; -1 if it has a name."""
        parent = parent_of(node)
        if parent is None:
            return -1
        place = parent, str(node.tag)
        if place not in self._numbers:
            self._numbers[place] = numbered(*place)
        return self._numbers[place].get(node, -1)

    def _meant(self, node: Node, selector: Selector) -> bool:
        """Return whether a selector matches this element, cached because all elements below ask for their ancestors."""
        known = self._known.setdefault(id(selector), {})
        if node not in known:
            known[node] = self._is_meant(node, selector)
        return known[node]

    def _is_meant(self, node: Node, selector: Selector) -> bool:
        path = "body" if node.tag == "worldbody" else kind_of(node).path
        if path not in paths_of(selector.tag) or (node.tag == "worldbody" and selector.pattern != WORLD):
            return False
        return self._named(node, selector.pattern) and self._narrowed(node, selector)

    def _named(self, node: Node, pattern: str) -> bool:
        if pattern == EVERYTHING:
            return True
        name = self.name(node)
        return bool(name) and self.fits(pattern)(str(name))

    def fits(self, pattern: str) -> Callable[[str], bool]:
        """Return a function that says whether a name matches a pattern. Raises `BadPattern`."""
        known = self._fits.get(pattern)
        if known is None:
            known = self._fits[pattern] = fitter(pattern, self._all_names, self.separator)
        return known

    def _all_names(self) -> set[str]:
        nodes = (node for section in self.root.iterchildren("*") for node in section.iter("*"))
        return {name for node in nodes if (name := self.name(node))}

    def _narrowed(self, node: Node, selector: Selector) -> bool:
        if selector.parent is not None and not self._is_child(node, selector.parent):
            return False
        if selector.inside is not None and not any(
            self._meant(each, selector.inside) for each in node.iterancestors() if each is not self.root
        ):
            return False
        if selector.part is not None and not self._is_of(node, selector.part):
            return False
        if selector.dclass is not None and not self._has_class(node, selector.dclass):
            return False
        return selector.where is None or self.holds(node, selector)

    def _is_child(self, node: Node, wanted: Selector) -> bool:
        direct = wanted.tag in _TRANSPARENT
        parent = node.getparent() if direct else parent_of(node)
        return parent is not None and parent is not self.root and self._meant(parent, wanted)

    def _is_of(self, node: Node, pattern: str) -> bool:
        part = self.parts.get(node)
        if part is None:
            return pattern == BASE
        levels = part.split("/")
        return any(
            matcher(pattern, between)(between.join(levels[:depth]))
            for between in {"/", self.separator}
            for depth in range(1, len(levels) + 1)
        )

    def _has_class(self, node: Node, pattern: str) -> bool:
        kind = kind_of(node)
        if node.tag == "default":
            above = [name_of(each) or MAIN for each in node.iterancestors("default")]
        elif kind.takes_class and section_of(node) != "default":
            above = [each.name for each in chain(node, self.classes)]
        else:
            return False
        fits = self.fits(pattern)
        return any(fits(MAIN if name == self.base_class else name) for name in above)

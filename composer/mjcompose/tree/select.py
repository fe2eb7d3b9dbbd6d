"""The elements that a selector matches."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import field
from functools import cache
from keyword import iskeyword
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.tree.classes import MAIN, Classes, chain
from mjcompose.tree.cost import written
from mjcompose.tree.files import NAMED_AFTER_FILE
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.names import MAY_REPEAT, WORLD, NameIndex, own_name
from mjcompose.tree.pattern import EVERYTHING, Selector, fitter, is_pattern, literals_of, matcher, paths_of
from mjcompose.tree.values import NOT_XML

ROOT = "mujoco"
WORLD_SECTION = "worldbody"
# Elements whose children, one of each, are created on first access; empty ones are not written.
HOLDS_ONE_OF_EACH = frozenset({"mujoco", "option", "visual", "compiler", "default"})
# Python names for MJCF's: `class` is a keyword.
_SPELLED = {"dclass": "class"}
_SPOKEN = {"class": "dclass"}


def section_of(node: Node) -> str:
    """Return the top-level section of a node; the frame of an attachment belongs to the world."""
    above = node.getparent()
    while above is not None:
        over = above.getparent()
        if over is None:
            return str(node.tag) if above.tag == ROOT else WORLD_SECTION
        node = above
        above = over
    return WORLD_SECTION


def kind_of(node: Node) -> ElementType:
    """Return the element type of a node in a valid tree."""
    parent = node.getparent()
    if parent is None:
        return GRAMMAR.element(str(node.tag))
    if parent.tag == ROOT:
        return GRAMMAR.section(str(node.tag))
    return _only_kind(parent.tag, node.tag) or child_kind(section_of(node), str(parent.tag), str(node.tag))


@cache
def _only_kind(parent: str, tag: str) -> ElementType | None:
    """Return the element type of a tag below another tag, if it is the same in every section."""
    outer = [GRAMMAR.section(parent)] if parent in _sections() else []
    outer += [GRAMMAR.within(section)[parent] for section in _sections() if parent in GRAMMAR.within(section)]
    found = {kind.children[tag].path for kind in outer if tag in kind.children}
    return GRAMMAR.element(found.pop()) if len(found) == 1 else None


@cache
def child_kind(section: str, parent: str, tag: str) -> ElementType:
    """Return the element type of a tag below another tag in a section."""
    outer = GRAMMAR.section(section) if parent == section else GRAMMAR.within(section)[parent]
    return outer.children[tag]


def attribute_of(kind: ElementType, name: str) -> Attribute | None:
    """Return the attribute for a Python name: `dclass` is `class`, and a final underscore is ignored."""
    return kind.attributes.get(name) or kind.attributes.get(_SPELLED.get(name, name.rstrip("_")))


def spoken(name: str) -> str:
    """Return the Python name of an attribute or a child: `dclass`, `global_`."""
    return _SPOKEN.get(name, f"{name}_" if iskeyword(name) else name)


@cache
def naming_attribute(kind: ElementType) -> Attribute | None:
    """Return the attribute that declares an element's own name: `name`, or `class` for a default class."""
    return next((each for each in kind.attributes.values() if each.declares), None)


class Query(Struct, eq=False):
    """The elements that a tag selects: their paths in the grammar, tags, sections and namespaces."""

    tag: str
    paths: frozenset[str]
    tags: tuple[str, ...]
    sections: frozenset[str]
    namespaces: tuple[str, ...]

    def takes(self, section: str, parent: str, tag: str) -> bool:
        """Return whether it selects an element of `tag` below an element of `parent`; `tag` must be one of `tags`."""
        if parent == ROOT:
            return tag in self.paths
        return child_kind(section, parent, tag).path in self.paths


@cache
def query(tag: str, section: str | None) -> Query:
    """Return the elements that `find(tag)` selects, from the root (`section` None) or inside a section.

    A family selects all of its tags, any other tag selects itself. From the root, elements of default classes are not
    selected, because they are not part of the model. Inside a section, only the section's own elements of that tag are
    selected (`joint` in `tendon` is the joint of a fixed tendon).
    """
    sections = _sections() if section is None else (section,)
    reached = {each: _reachable(each) for each in sections}
    if section is None:
        reached["default"] = frozenset({"default"})
    family = frozenset(GRAMMAR.families.get(tag, ()))
    paths = family & frozenset[str]().union(*reached.values())
    if not paths:
        paths = frozenset(path for known in reached.values() for path in known if path.rpartition("/")[2] == tag)
    namespaces = {GRAMMAR.element(path).family for path in paths}
    return Query(
        tag,
        paths,
        tuple(sorted({path.rpartition("/")[2] for path in paths})),
        sections=frozenset(each for each, known in reached.items() if known & paths),
        namespaces=tuple(sorted(name for name in namespaces if name)),
    )


@cache
def _sections() -> tuple[str, ...]:
    return tuple(GRAMMAR.root.children)


@cache
def _reachable(section: str) -> frozenset[str]:
    found: set[str] = set()
    waiting = [GRAMMAR.section(section)]
    while waiting:
        kind = waiting.pop()
        waiting += kind.children.values() if kind.path not in found else ()
        found.add(kind.path)
    return frozenset(found)


def tags_of() -> list[str]:
    """Return every tag and family that `find` knows, for suggestions."""
    tags = {path.rpartition("/")[2] for section in _sections() for path in _reachable(section)}
    return sorted(tags | GRAMMAR.families.keys())


# They do not count as parents, because MuJoCo resolves them.
_TRANSPARENT = ("frame", "replicate")
_WITH_NAME: Any = etree.XPath("descendant::*[@name=$name]")
BASE = "base"


@cache
def _is_written_as_name(paths: frozenset[str]) -> bool:
    """Return whether the name of these elements is always their attribute `name`."""
    kinds = [GRAMMAR.element(path) for path in paths]
    namings = [(naming_attribute(kind), kind.tag in NAMED_AFTER_FILE) for kind in kinds]
    return all(each is not None and each.name == "name" and not by_file for each, by_file in namings)


@cache
def _unique_in(paths: frozenset[str]) -> frozenset[str]:
    """Return the namespaces in which the names of these elements are unique; none if names may repeat."""
    namings = [naming_attribute(GRAMMAR.element(path)) for path in paths]
    namespaces = frozenset(naming.declares for naming in namings if naming is not None and naming.declares)
    return frozenset() if namespaces & MAY_REPEAT else namespaces


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
    found: dict[Node, int] = {}
    ahead = list(parent)[::-1]
    while ahead:
        node = ahead.pop()
        ahead += list(node)[::-1] if node.tag in _TRANSPARENT else ()
        if node.tag == tag and not name_of(node):
            found[node] = len(found)
    return found


_WALKED = 4
"""If at least one of this many elements is selected, a walk over all is quicker than a search for their places."""


def _in_order(nodes: Iterable[Node]) -> list[Node]:
    """Return elements of one tree in the order of the tree, without a look at the others.

    >>> root = etree.fromstring("<a><b><c/></b><d/></a>")
    >>> [node.tag for node in _in_order([root[1], root[0][0], root[0]])]
    ['b', 'c', 'd']
    """
    places: dict[Node, tuple[int, ...]] = {}

    def place(node: Node) -> tuple[int, ...]:
        """Return the number of each element around an element in its parent, from the root, and then its own."""
        waiting = []
        around: Node | None = node
        while around is not None and around not in places:
            waiting.append(around)
            around = around.getparent()
        for each in reversed(waiting):
            above = each.getparent()
            places[each] = () if above is None else (*places[above], above.index(each))
        return places[node]

    return sorted(nodes, key=place)


def _is_below(node: Node, root: Node) -> bool:
    return node.getroottree().getroot() is root


@dataclass
class Selection:
    """Finds elements in one model.

    `parts` has the part of each element, with `/` for nested parts. Other elements belong to the base. `holds`
    evaluates `where`. `base_class` is the name of the base's top class here, if it is not `main`. `index` has the names
    of the whole model, and `in_part` returns the elements of a part; without them, the model is searched.
    """

    root: Node
    classes: Classes
    separator: str = "/"
    parts: Mapping[Node, str] = field(default_factory=dict)
    base_class: str | None = None
    holds: Callable[[Node, Selector], bool] = lambda node, selector: True
    index: NameIndex | None = None
    in_part: Callable[[str], Iterable[Node]] | None = None
    _fits: dict[str, Callable[[str], bool]] = field(default_factory=dict)
    _known: dict[int, dict[Node, bool]] = field(default_factory=dict)
    _numbers: dict[tuple[Node, str], dict[Node, int]] = field(default_factory=dict)
    _repeated: dict[str, dict[Node, int]] = field(default_factory=dict)

    def of(self, selector: Selector) -> list[Node]:
        """Return every matching element, in the order of the tree. Raises `BadPattern`."""
        self._numbers.clear()  # the model may have changed
        self._repeated.clear()
        try:
            return [node for node in self._candidates(selector) if self._narrowed(node, selector)]
        finally:
            self._known.clear()

    def looks(self, selector: Selector) -> int:
        """Return the number of elements that a search looks at to find the matching ones, for one selector."""
        if self._called(selector) is not None:
            return 0
        around = self._around(selector)
        if around is not None:
            return sum(written(outer) for outer in around)
        names = self._names_for(selector)
        if names is not None:
            return len(names)
        elements = self._of_part(selector)
        return written(self.root) if elements is None else len(elements)

    def _candidates(self, selector: Selector) -> Iterable[Node]:
        """Return the elements of that tag and name, in the order of the tree, perhaps without those elsewhere.

        Elements inside an element with a single name are found there, without a look at the rest of the model.
        """
        called = self._called(selector)
        if called is not None:
            return called
        around = self._around(selector)
        if around is None:
            indexed = self._matching(selector)
            if indexed is not None:
                return indexed
            of_part = self._of_part(selector)
            elements = self.of_kind(selector) if of_part is None else _in_order(of_part)
            return (node for node in elements if self._named(node, selector.pattern))
        paths = paths_of(selector.tag)
        tags = {path.rpartition("/")[2] for path in paths}
        inside = dict.fromkeys(node for outer in around for node in outer.iterdescendants(*tags))
        return (node for node in inside if kind_of(node).path in paths and self._named(node, selector.pattern))

    def _around(self, selector: Selector) -> list[Node] | None:
        """Return the elements that the matching ones are inside of, if they are found by a single name."""
        outer_selectors = [outer for outer in (selector.parent, selector.inside) if outer is not None]
        return next((found for outer in outer_selectors if (found := self._called(outer)) is not None), None)

    def _matching(self, selector: Selector) -> list[Node] | None:
        """Find elements by a pattern in the index of names; return None if that is not possible."""
        names = self._names_for(selector)
        if names is None:
            return None
        assert self.index is not None
        fits = fitter(selector.pattern, lambda: names, self.separator)
        paths = paths_of(selector.tag)
        fitting = [name for name in names if fits(name)]
        nodes = [self.index.find(namespace, name) for namespace in _unique_in(paths) for name in fitting]
        found = {node for node in nodes if node is not None and kind_of(node).path in paths}
        if _WALKED * len(found) > sum(len(self.index.order(namespace)) for namespace in _unique_in(paths)):
            return [node for node in self.of_kind(selector) if node in found]
        return _in_order(found)

    def _names_for(self, selector: Selector) -> list[str] | None:
        """Return the names that may match a pattern, from the index; None if it does not have all."""
        paths = paths_of(selector.tag)
        namespaces = _unique_in(paths)
        is_narrow = is_pattern(selector.pattern) and selector.pattern != EVERYTHING
        if self.index is None or not is_narrow or not namespaces or not _is_written_as_name(paths):
            return None
        literals = literals_of(selector.pattern, self.separator)
        orders = (self.index.order(namespace) for namespace in namespaces)
        return list(dict.fromkeys(name for order in orders for name in order.narrowed(literals.starts, literals.part)))

    def _of_part(self, selector: Selector) -> list[Node] | None:
        """Return the elements of the selector's kind in one part; None if its part is a pattern or the base."""
        part = selector.part
        if self.in_part is None or part is None or part == BASE or is_pattern(part):
            return None
        paths = paths_of(selector.tag)
        return [node for node in self.in_part(part) if _is_below(node, self.root) and kind_of(node).path in paths]

    def of_kind(self, selector: Selector) -> Iterator[Node]:
        """Yield all elements of that tag, regardless of their names."""
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
        name = selector.pattern
        paths = paths_of(selector.tag)
        if name == WORLD or is_pattern(name) or not _is_written_as_name(paths):
            return None
        if NOT_XML.search(name):
            return []  # libxml2 refuses such text, and no element has such a name
        namespaces = _unique_in(paths)
        if self.index is not None and namespaces:
            if any((namespace, name) in self.index.repeated for namespace in namespaces):
                return None  # the index has only the first of them
            named = (self.index.find(namespace, name) for namespace in namespaces)
            return [node for node in named if node is not None and kind_of(node).path in paths]
        sections = (section for section in self.root.iterchildren("*") if section.tag != "default")
        return [node for each in sections for node in _WITH_NAME(each, name=name) if kind_of(node).path in paths]

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
        """Return the number of an element among the unnamed elements of its tag in its parent.

        If it has a name, it is the number among the elements of its tag with the same name; -1 if no other has it.
        """
        name = self.name(node)
        if name:
            return self._number_of_repeated(node, name)
        parent = parent_of(node)
        if parent is None:
            return -1
        place = parent, str(node.tag)
        if place not in self._numbers:
            self._numbers[place] = numbered(*place)
        return self._numbers[place].get(node, -1)

    def _number_of_repeated(self, node: Node, name: str) -> int:
        kind = kind_of(node)
        if kind.path not in self._repeated:
            named: dict[str, list[Node]] = {}
            for each in self.of_kind(Selector(kind.path, EVERYTHING)):
                named.setdefault(self.name(each) or "", []).append(each)
            several = [nodes for own, nodes in named.items() if own and len(nodes) > 1]
            self._repeated[kind.path] = {each: number for nodes in several for number, each in enumerate(nodes)}
        return self._repeated[kind.path].get(node, -1)

    def _meant(self, node: Node, selector: Selector) -> bool:
        """Return whether a selector matches this element, cached because all elements below check their ancestors."""
        known = self._known.setdefault(id(selector), {})
        if node not in known:
            path = "body" if node.tag == "worldbody" else kind_of(node).path
            is_kind = path in paths_of(selector.tag) and (node.tag != "worldbody" or selector.pattern == WORLD)
            known[node] = is_kind and self._named(node, selector.pattern) and self._narrowed(node, selector)
        return known[node]

    def _named(self, node: Node, pattern: str) -> bool:
        if pattern == EVERYTHING:
            return True
        name = self.name(node)
        return bool(name) and self.fits(pattern)(str(name))

    def fits(self, pattern: str) -> Callable[[str], bool]:
        """Return a function that says whether a name matches a pattern. Raises `BadPattern`."""
        if pattern not in self._fits:
            names = map(self.name, self.root.iterdescendants("*"))
            self._fits[pattern] = fitter(pattern, lambda: set(filter(None, names)), self.separator)
        return self._fits[pattern]

    def _narrowed(self, node: Node, selector: Selector) -> bool:
        return (
            (selector.parent is None or self._is_child(node, selector.parent))
            and (selector.inside is None or self._is_inside(node, selector.inside))
            and (selector.part is None or self._is_of(node, selector.part))
            and (selector.dclass is None or self._has_class(node, selector.dclass))
            and (selector.where is None or self.holds(node, selector))
        )

    def _is_inside(self, node: Node, wanted: Selector) -> bool:
        return any(self._meant(each, wanted) for each in node.iterancestors() if each is not self.root)

    def _is_child(self, node: Node, wanted: Selector) -> bool:
        direct = wanted.tag in _TRANSPARENT
        parent = node.getparent() if direct else parent_of(node)
        return parent is not None and parent is not self.root and self._meant(parent, wanted)

    def _is_of(self, node: Node, pattern: str) -> bool:
        part = self.parts.get(node)
        if part is None:
            return pattern == BASE
        levels = part.split("/")
        paths = [levels[:depth] for depth in range(1, len(levels) + 1)]
        return any(matcher(pattern, mark)(mark.join(path)) for mark in {"/", self.separator} for path in paths)

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

"""The element type of a node by its place in the grammar, and the nodes that a tag selects."""

from __future__ import annotations

from functools import cache
from keyword import iskeyword

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR, ElementType
from composer.grammar.attribute import Attribute

ROOT = "mujoco"
WORLD_SECTION = "worldbody"
# Elements whose children, one of each, are created on first access; empty ones are not written.
HOLDS_ONE_OF_EACH = frozenset({"mujoco", "option", "visual", "compiler", "default"})
# Python names for MJCF's: `class` is a keyword.
_SPELLED = {"dclass": "class"}
_SPOKEN = {name: word for word, name in _SPELLED.items()}


def section_of(node: Node) -> str:
    """Return the top-level section of a node; the frame of an attachment belongs to the world."""
    above = node.getparent()
    while above is not None:
        over = above.getparent()
        if over is None:
            return str(node.tag) if above.tag == ROOT else WORLD_SECTION
        node, above = above, over
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
    """Return the element type of a tag below another one, if it is the same in every section."""
    outer = [GRAMMAR.section(parent)] if parent in _sections() else []
    outer += [GRAMMAR.within(section)[parent] for section in _sections() if parent in GRAMMAR.within(section)]
    found = {kind.children[tag].path for kind in outer if tag in kind.children}
    return GRAMMAR.element(found.pop()) if len(found) == 1 else None


@cache
def child_kind(section: str, parent: str, tag: str) -> ElementType:
    """Return the element type of a tag below another one in a section."""
    outer = GRAMMAR.section(section) if parent == section else GRAMMAR.within(section)[parent]
    return outer.children[tag]


def attribute_of(kind: ElementType, name: str) -> Attribute | None:
    """Return the attribute for a Python name: `dclass` is `class`, and a final underscore is ignored."""
    attributes = kind.attributes
    found = attributes.get(name)
    if found is None:
        found = attributes.get(_SPELLED.get(name, name.rstrip("_")))
    return found


def spoken(name: str) -> str:
    """Return the Python name of an attribute or a child: `dclass`, `global_`."""
    return _SPOKEN.get(name, f"{name}_" if iskeyword(name) else name)


@cache
def naming_attribute(kind: ElementType) -> Attribute | None:
    """Return the attribute that declares an element's own name: `name`, or `class` for a default class."""
    return next((each for each in kind.attributes.values() if each.declares), None)


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """The elements that a tag selects: their paths in the grammar, tags, sections and namespaces."""

    tag: str
    paths: frozenset[str]
    tags: tuple[str, ...]
    sections: frozenset[str]
    namespaces: tuple[str, ...]

    def takes(self, section: str, parent: str, tag: str) -> bool:
        """Return whether it selects an element of `tag` below one of `parent`; `tag` must be one of `tags`."""
        if parent == ROOT:
            return tag in self.paths
        return child_kind(section, parent, tag).path in self.paths


@cache
def query(tag: str, section: str | None) -> Query:
    """Return what `find(tag)` selects, from the root (`section` None) or inside a section.

    A family selects all of its tags; any other tag selects itself. From the root, elements of default classes are
    not selected, because they are not part of the model; inside a section, only the section's own elements of that
    tag are (`joint` in `tendon` is the joint of a fixed tendon).
    """
    sections = _sections() if section is None else (section,)
    reached = {each: _reachable(each) for each in sections}
    if section is None:
        reached["default"] = frozenset({"default"})
    family = frozenset(GRAMMAR.families.get(tag, ()))
    paths = family & frozenset[str]().union(*reached.values())
    if not paths:
        same_tag = {path for known in reached.values() for path in known if path.rpartition("/")[2] == tag}
        paths = frozenset(same_tag)
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
    """Return the paths of all elements of a section, including the section."""
    found: dict[str, None] = {}
    waiting = [GRAMMAR.section(section)]
    while waiting:
        kind = waiting.pop()
        if kind.path not in found:
            found[kind.path] = None
            waiting.extend(kind.children.values())
    return frozenset(found)


def tags_of() -> list[str]:
    """Return every tag and family that `find` knows, for suggestions."""
    tags = {path.rpartition("/")[2] for section in _sections() for path in _reachable(section)}
    return sorted(tags | GRAMMAR.families.keys())

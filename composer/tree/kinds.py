"""What the grammar says of a node, by where it stands, and which nodes a tag asks for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from keyword import iskeyword

from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR, ElementType
from composer.grammar.attribute import Attribute

ROOT = "mujoco"
WORLD_SECTION = "worldbody"
# Elements whose children, one of each, are made when first asked for; empty ones are not written.
HOLDS_ONE_OF_EACH = frozenset({"mujoco", "option", "visual", "compiler", "default"})
# Python's words for MJCF's: `class` cannot be an argument.
_SPELLED = {"dclass": "class"}
_SPOKEN = {name: word for word, name in _SPELLED.items()}


def section_of(node: Node) -> str:
    """The top-level section a node stands in; the frame of an attachment stands in the world."""
    above = node.getparent()
    while above is not None:
        over = above.getparent()
        if over is None:
            return str(node.tag) if above.tag == ROOT else WORLD_SECTION
        node, above = above, over
    return WORLD_SECTION


def kind_of(node: Node) -> ElementType:
    """The element type of a node that stands in a valid tree."""
    parent = node.getparent()
    if parent is None:
        return GRAMMAR.element(str(node.tag))
    if parent.tag == ROOT:
        return GRAMMAR.section(str(node.tag))
    return _only_kind(parent.tag, node.tag) or child_kind(section_of(node), str(parent.tag), str(node.tag))


@cache
def _only_kind(parent: str, tag: str) -> ElementType | None:
    """The element type of a tag below another one, where that is the same in every section."""
    outer = [GRAMMAR.section(parent)] if parent in _sections() else []
    outer += [GRAMMAR.within(section)[parent] for section in _sections() if parent in GRAMMAR.within(section)]
    found = {kind.children[tag].path for kind in outer if tag in kind.children}
    return GRAMMAR.element(found.pop()) if len(found) == 1 else None


@cache
def child_kind(section: str, parent: str, tag: str) -> ElementType:
    """The element type of a tag below another one in a section."""
    outer = GRAMMAR.section(section) if parent == section else GRAMMAR.within(section)[parent]
    return outer.children[tag]


def attribute_of(kind: ElementType, name: str) -> Attribute | None:
    """The attribute that a Python name means: `dclass` is `class`, and a last underscore does not count."""
    attributes = kind.attributes
    found = attributes.get(name)
    if found is None:
        found = attributes.get(_SPELLED.get(name, name.rstrip("_")))
    return found


def spoken(name: str) -> str:
    """How Python code names an attribute or a child: `dclass`, `global_`."""
    return _SPOKEN.get(name, f"{name}_" if iskeyword(name) else name)


@cache
def naming_attribute(kind: ElementType) -> Attribute | None:
    """The attribute that declares an element's own name: `name`, or `class` of a default class."""
    return next((each for each in kind.attributes.values() if each.declares), None)


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """Which elements a tag asks for: their paths in the grammar, tags, sections and namespaces."""

    tag: str
    paths: frozenset[str]
    tags: tuple[str, ...]
    sections: frozenset[str]
    namespaces: tuple[str, ...]

    def takes(self, section: str, parent: str, tag: str) -> bool:
        """Whether an element of `tag` below one of `parent` is asked for; `tag` must be one of `tags`."""
        if parent == ROOT:
            return tag in self.paths
        return child_kind(section, parent, tag).path in self.paths


@cache
def query(tag: str, section: str | None) -> Query:
    """What `find(tag)` looks for, from the root (`section` None) or from inside a section.

    A family takes all of its tags; any other tag takes itself. From the root what stands in default classes
    is not found, as it is not part of the model; inside a section the section's own elements of that tag are
    meant (`joint` in `tendon` is the joint of a fixed tendon).
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
        frozenset(each for each, known in reached.items() if known & paths),
        tuple(sorted(name for name in namespaces if name)),
    )


@cache
def _sections() -> tuple[str, ...]:
    return tuple(GRAMMAR.root.children)


@cache
def _reachable(section: str) -> frozenset[str]:
    """Paths of all elements of a section, itself included."""
    found: dict[str, None] = {}
    waiting = [GRAMMAR.section(section)]
    while waiting:
        kind = waiting.pop()
        if kind.path not in found:
            found[kind.path] = None
            waiting.extend(kind.children.values())
    return frozenset(found)


def tags_of() -> list[str]:
    """Every tag and family that `find` knows, for suggestions."""
    tags = {path.rpartition("/")[2] for section in _sections() for path in _reachable(section)}
    return sorted(tags | GRAMMAR.families.keys())

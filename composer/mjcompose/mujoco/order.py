"""The order in which MuJoCo compiles the elements of a flat model, and the compiled element for each of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

from mjcompose.mujoco.attributes import KINDS, ON_BODIES, NameTable
from mjcompose.mujoco.references import links
from mjcompose.tree.classes import through_frames
from mjcompose.tree.names import WORLD, own_name
from mjcompose.tree.select import WORLD_SECTION, kind_of, naming_attribute

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_STANDING = {**{kind: kind for kind in ON_BODIES}, "freejoint": "joint"}
_REFERRING = ("pair", "exclude", "equality", "tendon", "actuator", "sensor")
# Elements that MuJoCo expands to any number of elements, with the kinds of these.
_BLOCKS: Mapping[str, tuple[str, ...]] = {
    "attach": tuple(KINDS),
    "composite": ("body", "joint", "geom", "site", "exclude", "equality", "tendon", "skin", "plugin"),
    "flexcomp": ("body", "joint", "equality", "flex", "plugin"),
    "replicate": ("body", *ON_BODIES, *_REFERRING, "key"),
}
_SECTIONS = (
    "asset", "deformable", "contact", "equality", "tendon", "actuator", "sensor", "custom", "keyframe",
)  # fmt: skip
# MuJoCo sorts these by their two references: their kind and attributes.
_SORTED = {"pair": ("geom", "geom1", "geom2"), "exclude": ("body", "body1", "body2")}

Order: TypeAlias = "Mapping[str, Sequence[Node | None]]"
"""By kind, the elements in order; None stands for any number of others."""


def compiled_kind(node: Node) -> str | None:
    """Return the kind of object that an element becomes, such as `mesh` or `plugin`, or None if it becomes none."""
    if node.tag == WORLD_SECTION:
        return "body"
    family = kind_of(node).family
    kind = "plugin" if family == "instance" else family
    return kind if kind in KINDS else None


def compiled_name(node: Node) -> str:
    """Return the name that MuJoCo gives it, empty if it has none."""
    if node.tag == WORLD_SECTION:
        return WORLD
    attribute = naming_attribute(kind_of(node))
    return (attribute and own_name(node, attribute.name)) or ""


def compiled_order(root: Node) -> Order:
    """Return bodies depth first, elements on bodies body by body, and everything else in document order.

    >>> from lxml import etree
    >>> order = compiled_order(etree.fromstring(
    ...     '<mujoco><worldbody><body><body><geom name="b"/></body><geom name="a"/></body></worldbody></mujoco>'))
    >>> [geom.get('name') for geom in order['geom']]
    ['a', 'b']
    """
    found: dict[str, list[Node | None]] = {kind: [] for kind in KINDS}
    blocks = {str(block.tag) for block in root.iterdescendants(*_BLOCKS)}
    generated = {kind for block in blocks for kind in _BLOCKS[block]} - {"body", *ON_BODIES}
    for kind in generated:
        found[kind].append(None)
    waiting = list(root.iterchildren(WORLD_SECTION))
    while waiting:
        body = waiting.pop()
        if body.tag in _BLOCKS:
            for kind in _made(body)[1]:
                found[kind].append(None)
            continue
        found["body"].append(body)
        inner: list[Node] = []
        for child in through_frames(body):
            if child.tag == "body" or child.tag in _BLOCKS:
                inner.append(child)
                for made in _made(child)[0] if child.tag in _BLOCKS else ():
                    found[made].append(None)
            elif child.tag in _STANDING:
                found[_STANDING[str(child.tag)]].append(child)
        waiting.extend(reversed(inner))
    for node in _elsewhere(root):
        written = compiled_kind(node)
        if written is not None:
            found[written].append(node)
    for kind in generated:
        found[kind].append(None)
    return found


def rows(order: Order, roster: NameTable) -> dict[Node, int]:
    """Return the number of every element within its kind, as far as that is certain.

    A stretch of elements counts if all names match; if they do not, because MuJoCo has removed or added elements,
    only named ones are found.
    """
    found: dict[Node, int] = {}
    # If a body is missing, MuJoCo has moved its elements to others.
    whole = None in order["body"] or len(order["body"]) == roster.count("body")
    for kind, expected in order.items():
        names, ids = roster.names[kind], roster.ids[kind]
        if kind in _SORTED:
            found.update(_sorted(kind, expected, roster))
            continue
        stretches = _stretches(expected)
        if sum(map(len, stretches)) == len(names):  # nothing was added
            stretches = [[node for stretch in stretches for node in stretch]]
        for at, stretch in enumerate(stretches):
            start = None
            if whole or kind not in ON_BODIES:
                start = _start(stretch, at == 0, at == len(stretches) - 1, names=names, ids=ids)
            for place, node in enumerate(stretch):
                row = ids.get(compiled_name(node)) if start is None else start + place
                if row is not None:
                    found[node] = row
    return found


def _sorted(kind: str, expected: Sequence[Node | None], roster: NameTable) -> Iterator[tuple[Node, int]]:
    """Yield pairs and excludes, matched by name or by their two references."""
    referred, *attributes = _SORTED[kind]
    places: dict[frozenset[int], list[int]] = {}
    for row in range(roster.count(kind)):
        two = frozenset(link.index for link in links(roster.model, kind, row))
        places.setdefault(two, []).append(row)
    for node in expected:
        if node is None:
            continue
        mine = frozenset(roster.ids[referred].get(str(node.get(attribute)), -1) for attribute in attributes)
        alike = places.get(mine, [])
        found = roster.ids[kind].get(compiled_name(node), alike[0] if alike else None)
        if found is not None:
            yield node, found
        if found in alike:
            alike.remove(found)


def _start(
    stretch: Sequence[Node], first: bool, last: bool, names: Sequence[str], ids: Mapping[str, int]
) -> int | None:
    own = [compiled_name(node) for node in stretch]
    known = next((ids[name] - at for at, name in enumerate(own) if name in ids), None)
    if first and last and len(own) != len(names):
        return None
    start = 0 if first else len(names) - len(own) if last else known
    return start if start is not None and start >= 0 and names[start : start + len(own)] == own else None


def _stretches(expected: Sequence[Node | None]) -> list[list[Node]]:
    stretches: list[list[Node]] = [[]]
    for node in expected:
        if node is None:
            stretches.append([])
        else:
            stretches[-1].append(node)
    return stretches


def _made(block: Node) -> tuple[set[str], set[str]]:
    """Return the kinds of elements that a block makes on its own body, and below that body."""
    if block.tag != "replicate":
        kinds = {kind for kind in _BLOCKS[str(block.tag)] if kind == "body" or kind in ON_BODIES}
        return (set() if block.tag == "flexcomp" else kinds - {"body"}), kinds
    here: set[str] = set()
    below: set[str] = set()
    for child in through_frames(block):
        if child.tag in _BLOCKS:
            inner = _made(child)
            here |= inner[0]
            below |= inner[1]
        elif child.tag == "body":
            below |= {"body", *ON_BODIES}
        elif child.tag in _STANDING:
            here.add(_STANDING[str(child.tag)])
    return here, below


def _elsewhere(root: Node) -> Iterator[Node]:
    for section in root.iterchildren("extension"):
        yield from section.iterdescendants("instance")
    for section in root.iterchildren(*_SECTIONS):
        yield from section.iterchildren("*")

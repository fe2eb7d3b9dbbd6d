"""The elements of one side's tree, looked up by MuJoCo's name for them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.compiled.kinds import KINDS
from composer.explain import query
from composer.explain.traced import Traced
from composer.link.inertia import has_mass
from composer.tree.effective import levels, value
from composer.tree.kinds import kind_of
from composer.tree.kinds import query as paths_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.link.part import Part

_HOLDERS = ("body", "worldbody")
_KINDS = {path: kind for kind in KINDS if kind != "plugin" for path in paths_of(kind, None).paths}


class Elements:
    """The elements of one model.

    `counts` has MuJoCo's number of elements of each kind; if the tree has as many, order identifies unnamed
    elements.
    """

    def __init__(self, traced: Traced, counts: dict[str, int]) -> None:
        self.traced, self.counts = traced, counts
        self.root = traced.model.root
        self.found: dict[str, list[Node]] = defaultdict(list)
        self.named: dict[tuple[str, str], Node] = {}
        for node in query.ordered(self.root):
            kind = "body" if node.tag == "worldbody" else _KINDS.get(kind_of(node).path)
            if kind is None or (node.tag == "worldbody" and self.found["body"]):
                continue
            self.found[kind].append(node)
            if (name := query.name_of(node)) is not None and node.tag != "worldbody":
                self.named.setdefault((kind, name), node)
        self._bodies = {query.name_of(node): number for number, node in enumerate(self.found["body"])}
        for kind in ("exclude", "pair"):
            self.found[kind].sort(key=self._signature)

    def _signature(self, node: Node) -> tuple[int, int]:
        """Return what MuJoCo 4.0 sorts pairs and excludes by: the numbers of the two bodies."""
        bodies = []
        for end in "12":
            name = node.get(f"body{end}")
            geom = self.named.get(("geom", str(node.get(f"geom{end}"))))
            if name is None and geom is not None:
                holder = next(geom.iterancestors(*_HOLDERS), None)
                name = None if holder is None else query.name_of(holder)
            bodies.append(self._bodies.get(None if name == "world" else name, 0))
        return min(bodies), max(bodies)

    def node(self, kind: str, name: str, index: int) -> Node | None:
        """Return the element in the tree, or None if it is one of many unnamed ones or made by MuJoCo."""
        found = self.named.get((kind, name))
        if found is not None or index < 0 or len(self.found[kind]) != self.counts.get(kind):
            return found
        return self.found[kind][index]

    def setting(self, *path: str) -> Node | None:
        """Return the element that holds a setting; if there are several sections, the last one."""
        node: Node | None = self.root
        for tag in path:
            node = None if node is None else next(iter(list(node.iterchildren(tag))[::-1]), None)
        return node

    def inside(self, node: Node, *tags: str) -> list[Node]:
        """Return the children of a body with these tags, including those in frames."""
        return list(_inside(node, tags))

    def weighs(self, body: Node) -> bool:
        """Return whether a body has an inertial, or a geom with mass."""
        return any(
            each.tag == "inertial" or has_mass(each, self.traced.classes)
            for each in self.inside(body, "inertial", "geom")
        )

    def frames(self, node: Node) -> list[Node]:
        """Return the frames between an element and its body, the innermost first."""
        found = []
        for above in node.iterancestors():
            if above.tag in _HOLDERS:
                break
            found.append(above)
        return found

    def carried(self, frame: Node) -> Part | None:
        """Return the part for which the linker created a frame."""
        made = self.traced.watch.life(frame).made_by
        return made.part if made is not None and made.is_pass else None

    def place(self, frame: Node) -> Node | None:
        """Return the site, body or frame of the model that a part is attached to."""
        part = self.carried(frame)
        if part is None or part.place.name is None:
            return None
        return self.named.get((part.place.kind, part.place.name))

    def value(self, node: Node, attribute: str) -> tuple[str | None, Node | None]:
        """Return the effective value of an attribute, and the element that writes it: this one or a default class."""
        kind = kind_of(node)
        known = kind.attributes.get(attribute)
        if known is None:
            return None, None
        steps = levels(node, kind, known, classes=self.traced.classes)
        return value(steps), next((step.writer for step in steps if step.taken), None)


def _inside(node: Node, tags: tuple[str, ...]) -> Iterator[Node]:
    for child in node.iterchildren("*"):
        if child.tag in tags:
            yield child
        elif child.tag in ("frame", "replicate"):
            yield from _inside(child, tags)

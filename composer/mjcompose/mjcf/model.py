"""One model of a composition, and its display in a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field
from functools import cached_property
from html import escape
from threading import Lock
from typing import Any, ClassVar, NamedTuple

from lxml import etree
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct, dataclass
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.tree.classes import MAIN
from mjcompose.tree.edit import names_in
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.names import LEADING_OUT, SEPARATOR, UP, WORLD, NameIndex, may_be_generated, own_name
from mjcompose.tree.select import ROOT, WORLD_SECTION, kind_of, naming_attribute, section_of
from mjcompose.tree.unit import Unit

UNNAMED = "unnamed_model"


class ReferencedNode(NamedTuple):
    """A node and the model that it belongs to."""

    model: ModelState
    node: Node


class AttachedModel(Struct, frozen=False, eq=False):
    """A model attached to another: to `host`, a site, body, frame or the worldbody of `parent`.

    `frame` is a separate body, not in the parent's tree: its pose is the offset, and its joints are the joints between
    the two models. Their names get the child's prefix; a joint without a name has just the prefix as its name.
    """

    made: ClassVar[int] = 0
    """The number of these in this process so far."""

    parent: ModelState
    child: ModelState
    host: Node
    frame: Node

    def __post_init__(self) -> None:
        AttachedModel.made += 1
        for model in (self.parent, self.child):
            model.names  # noqa: B018  # whether they lead out is known only then

    @property
    def is_body(self) -> bool:
        """Whether the frame becomes a body in the output: it has a joint or is a mocap body."""
        return len(self.frame) > 0 or self.frame.get("mocap") == "true"

    @property
    def container(self) -> Node:
        """The element that contains the child in the output."""
        if self.host.tag != "site":
            return self.host
        holder = self.host.getparent()
        assert holder is not None
        return holder

    def find(self, namespace: str, name: str) -> Node | None:
        """Return the frame or one of its joints by its name without the prefix, or None."""
        if namespace == "body":
            return self.frame if not name and self.is_body else None
        if namespace == "joint":
            return next((joint for joint in self.frame if (joint.get("name") or "") == name), None)
        return None

    def names(self) -> Iterator[tuple[str, str]]:
        """Yield the namespace and the name of everything in the child, as the parent names it."""
        child = self.child
        prefix = self.child.prefix
        yield "body", prefix
        yield "default", prefix
        yield from (("joint", prefix + str(joint.get("name") or "")) for joint in self.frame)
        for namespace, names in child.names.declared.items():
            yield from ((namespace, prefix + name) for name in names)
        for inner in child.attachments.values():
            yield from ((namespace, prefix + name) for namespace, name in inner.names())


@dataclass(eq=False)
class ModelState:
    """The state shared by a `RootElement` and all Elements of one model.

    Accessing a section that does not exist creates it, under a lock, so several threads can read at once. `views`
    has the Element of every node accessed so far, so each node has only one (see `attributed.py`). `attachments` are
    by prefix, in the order in which they were made. `awaited` are the references to elements of models that are not in
    this composition yet, with their provisional texts (see `settle`).
    """

    unit: Unit
    views: dict[Node, Any] = field(default_factory=dict)
    attachments: dict[str, AttachedModel] = field(default_factory=dict)
    hung: AttachedModel | None = None
    leading: tuple[tuple[int, int], list[ModelState]] | None = None
    awaited: dict[tuple[Node, str], tuple[ReferencedNode, str]] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)
    written: tuple[list[object], str, list[Diagnostic]] | None = None
    """The text of the composition, the state that it describes, and the warnings about it."""

    @cached_property
    def names(self) -> NameIndex:
        return NameIndex.of(self.unit.root)

    @property
    def name(self) -> str:
        return self.unit.model or self.unit.label or UNNAMED

    @property
    def prefix(self) -> str:
        """The prefix of this model's names in the model it is attached to, such as `gripper/`."""
        return self.name + SEPARATOR

    @property
    def full_prefix(self) -> str:
        """The prefix of this model's names in the output; empty for the top model."""
        return "" if self.hung is None else self.hung.parent.full_prefix + self.prefix

    @property
    def top(self) -> ModelState:
        return [self, *self.ancestors()][-1]

    def ancestors(self) -> Iterator[ModelState]:
        """Yield the models above this one, the nearest first."""
        model = self
        while model.hung is not None:
            model = model.hung.parent
            yield model

    def ways_up(self) -> Iterator[tuple[ModelState, str]]:
        """Yield this model and the models above it, each with the prefix that this model's names have there."""
        model = self
        prefix = ""
        yield model, prefix
        while model.hung is not None:
            prefix = model.prefix + prefix
            model = model.hung.parent
            yield model, prefix

    def levels(self) -> Iterator[tuple[ModelState, str]]:
        """Yield this model and the models that may refer to it, each with the prefix of this model's names there.

        These are the models above it, and other models of the composition that refer to something outside.
        """
        yield from self.ways_up()
        model = self.top
        if not LEADING_OUT or not model.attachments:
            return
        # Models of this composition that refer to something outside of themselves, cached while nothing changes.
        state = len(LEADING_OUT), AttachedModel.made
        if model.leading is None or model.leading[0] != state:
            model.leading = state, [each for each in model.composition() if each.names.leads_out]
        for other in model.leading[1]:
            if other is not self and (way := other.prefix_of(self) or "").startswith(UP):
                yield other, way

    def section(self, tag: str) -> Node:
        """Return the node of a top-level section. If there is none, create it at its usual place in MJCF."""
        root = self.unit.root
        found = next(root.iterchildren(tag), None)
        if found is None:
            with self.lock:
                found = next(root.iterchildren(tag), None)
                if found is None:
                    order = list(GRAMMAR.root.children)
                    later = order[order.index(tag) + 1 :]
                    before = next(root.iterchildren(*later), None) if later else None
                    found = root.makeelement(tag)
                    root.insert(len(root) if before is None else root.index(before), found)
        return found

    def only_child(self, node: Node, tag: str) -> Node:
        """Return the only child with this tag. If there is none, create it."""
        with self.lock:
            found = next(node.iterchildren(tag), None)
            return etree.SubElement(node, tag) if found is None else found

    def attachment_of(self, frame: Node) -> AttachedModel:
        """Return the attachment that a frame belongs to."""
        return next(each for each in self.attachments.values() if each.frame is frame)

    def frame_above(self, node: Node) -> Node | None:
        """Return the attachment frame that is or contains a node, or None for a node of the model's own tree."""
        top = [node, *node.iterancestors()][-1] if self.attachments else self.unit.root
        return None if top is self.unit.root else top

    def has(self, node: Node) -> bool:
        """Return whether a node is in the model's tree or in one of its attachment frames."""
        top = [node, *node.iterancestors()][-1]
        return top is self.unit.root or any(each.frame is top for each in self.attachments.values())

    def span(self, node: Node, attribute: str | None = None) -> Span:
        """Return where a node or its attribute came from: a place in a file, or the line of the program that set it."""
        return self.unit.origins.span(node, self.unit.file, attribute)

    def split(self, name: str) -> Iterator[tuple[AttachedModel, str]]:
        """Yield each attachment whose prefix the name begins with, and the rest of the name."""
        at = name.find(SEPARATOR) if self.attachments else -1
        while at >= 0:
            attachment = self.attachments.get(name[: at + 1])
            if attachment is not None:
                yield attachment, name[at + 1 :]
            at = name.find(SEPARATOR, at + 1)

    def lookup(self, namespace: str, name: str) -> ReferencedNode | None:
        """Return the element with this name in this model or, by its prefix, in an attached model, or None."""
        node = self.names.find(namespace, name)
        if node is not None:
            return ReferencedNode(self, node)
        if namespace == "body" and name == WORLD:
            return ReferencedNode(self, self.section(WORLD_SECTION))
        if namespace == "default" and name == MAIN:
            return ReferencedNode(self, self.section("default"))
        if self.hung is not None and name.startswith(UP):
            return self.hung.parent.lookup(namespace, name[len(UP) :])
        for attachment, rest in self.split(name):
            found = attachment.child.lookup_attached(namespace, rest)
            if found is not None:
                return found
            frame = attachment.find(namespace, rest)
            if frame is not None:
                return ReferencedNode(self, frame)
        return None

    def find_node(self, namespace: str, name: str) -> Node | None:
        """Return the node with this name, in this model or an attached one, or None."""
        found = self.lookup(namespace, name)
        return None if found is None else found.node

    def known_names(self, namespace: str) -> Iterator[str]:
        yield from self.names.declared.get(namespace, ())
        for prefix, attachment in self.attachments.items():
            if namespace == "body" and attachment.is_body:
                yield prefix
            if namespace == "joint":
                yield from (prefix + str(joint.get("name") or "") for joint in attachment.frame)
            yield from (prefix + name for name in attachment.child.known_names(namespace))

    def kinds_of(self, name: str) -> Iterator[str]:
        """Yield the namespaces in which the name exists."""
        namespaces = dict.fromkeys(each for model in self.composition() for each in model.names.declared)
        yield from (each for each in namespaces if self.lookup(each, name) is not None)

    def may_generate(self, name: str) -> bool:
        """Return whether MuJoCo may generate the name itself."""
        if may_be_generated(name, self.unit.root):
            return True
        if self.hung is not None and name.startswith(UP):
            return self.hung.parent.may_generate(name[len(UP) :])
        return any(attachment.child.may_generate(rest) for attachment, rest in self.split(name))

    def composition(self) -> Iterator[ModelState]:
        """Yield the model and all models attached to it, at any depth."""
        yield self
        for attachment in self.attachments.values():
            yield from attachment.child.composition()

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        """Return the namespace and name of everything in a node's subtree, including the models attached there."""
        if not self.attachments:
            return names_in(node)
        inside = dict.fromkeys(node.iter("*"))
        if self.frame_above(node) is not None:
            return [name for each in inside if (name := self.declared(each)) is not None]
        hanging = [each for each in self.attachments.values() if each.host in inside]
        return [*names_in(node), *(name for attachment in hanging for name in attachment.names())]

    def lookup_attached(self, namespace: str, name: str) -> ReferencedNode | None:
        """Return the element with this name as the parent of an attached model sees it. See `lookup`.

        From the parent, the child's world is not a body, and the name of its top class is empty after the prefix.
        """
        if namespace == "default" and not name:
            return ReferencedNode(self, self.section("default"))
        if (namespace, name) in (("body", WORLD), ("default", MAIN)):
            return None
        return self.lookup(namespace, name)

    def declared(self, node: Node) -> tuple[str, str] | None:
        """Return the namespace and name of a node in this model, or None if it has no name."""
        if node.tag == WORLD_SECTION:
            return "body", WORLD
        if node.getparent() is self.unit.root and node.tag == "default":
            return "default", MAIN
        attribute = naming_attribute(kind_of(node))
        frame = self.frame_above(node)
        if frame is not None:
            prefix = self.attachment_of(frame).child.prefix
            if node is frame:
                return "body", prefix
            return ("joint", prefix + str(node.get("name") or "")) if attribute else None
        name = None if attribute is None else own_name(node, attribute.name)
        return None if attribute is None or attribute.declares is None or name is None else (attribute.declares, name)

    def seen_from(self, other: ModelState, node: Node) -> str | None:
        """Return the name of a node in `other`, a model of the same composition, or None if it has no name there."""
        declared = self.declared(node)
        prefix = None if declared is None else other.prefix_of(self)
        if declared is None or prefix is None:
            return None
        is_attached_world = self is not other and self.hung is not None and declared == ("body", WORLD)
        # A class is looked up in its own model alone.
        if is_attached_world or (declared[0] == "default" and prefix.startswith(UP)):
            return None
        return prefix if self is not other and declared == ("default", MAIN) else prefix + declared[1]

    def prefix_of(self, other: ModelState) -> str | None:
        """Return the prefix of `other`'s names here, or None outside the composition; `../` is the model above."""
        down = dict(other.ways_up())
        ways = (UP * depth + down[each] for depth, each in enumerate((self, *self.ancestors())) if each in down)
        return next(ways, None)

    def note(self, node: Node) -> None:
        """Add the names of a new or changed node to the index."""
        self.names.note(node, section_of(node), declares=self.frame_above(node) is None)

    def forget(self, node: Node) -> None:
        """Remove the names of a node from the index, before the node is removed or changed."""
        self.names.forget(node, section_of(node))


SHOWN = 1000
"""The number of elements of a tree that are shown; a page of a hundred thousand helps nobody."""
_DEEPEST = 100
_STYLE = "font-family: monospace; white-space: pre; line-height: 1.4"
_INSIDE = "margin-left: 1.5em"


def page(model: ModelState, node: Node) -> str:
    """Return HTML of an element and everything below, with attached models at their hosts; two levels are open."""
    lines: list[str] = []
    left = _tree(model, node, lines, left=SHOWN, depth=0)
    more = f"<div>… and {-left} more elements</div>" if left < 0 else ""
    return f'<div style="{_STYLE}">{"".join(lines)}{more}</div>'


def _start_tag(node: Node, is_empty: bool) -> str:
    written = ((escape(str(name)), escape(str(value))) for name, value in node.items())
    attributes = "".join(f' {name}=<span style="color: #067d17">"{value}"</span>' for name, value in written)
    weight = "font-weight: bold; " if node.tag in (ROOT, "body") else ""
    name = f'<span style="{weight}color: #0033b3">{escape(str(node.tag))}</span>'
    return f"&lt;{name}{attributes}{'/' if is_empty else ''}&gt;"


def _tree(model: ModelState, node: Node, lines: list[str], left: int, depth: int) -> int:
    """Append a node and everything below it to `lines`, up to `left` elements. Return the rest, negative if cut."""
    if left <= 0:
        return left - _count(model, node)
    if depth > _DEEPEST:
        lines.append(f"<div>… {_count(model, node)} elements</div>")
        return left - 1
    left -= 1
    children = list(node.iterchildren("*"))
    attached = [attachment for attachment in model.attachments.values() if attachment.host is node]
    tag = _start_tag(node, is_empty=not children and not attached)
    if not children and not attached:
        lines.append(f"<div>{tag}</div>")
        return left
    is_open = " open" if depth < 2 or (node.tag == WORLD_SECTION and depth < 3) else ""
    lines.append(f'<details{is_open}><summary>{tag}</summary><div style="{_INSIDE}">')
    for child in children:
        left = _tree(model, child, lines, left=left, depth=depth + 1)
    for attachment in attached:
        if left > 0:
            lines.append(f"<div>{escape(attachment.child.prefix)} is attached here:</div>")
        for joint in attachment.frame:
            left = _tree(model, joint, lines, left=left, depth=depth + 1)
        left = _tree(attachment.child, attachment.child.unit.root, lines, left=left, depth=max(depth + 1, 2))
    lines.append("</div></details>")
    return left


def _count(model: ModelState, node: Node) -> int:
    """Return the number of elements in a node's subtree, including the models attached there."""
    hanging = (each for each in model.attachments.values() if node in (each.host, *each.host.iterancestors()))
    inner = sum(len(each.frame) + _count(each.child, each.child.unit.root) for each in hanging)
    return inner + sum(1 for _ in node.iter("*"))

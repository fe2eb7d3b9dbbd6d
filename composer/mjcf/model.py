"""One model of a composition: its unit, its names, and its attachments. Works on nodes, not on Elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from threading import Lock
from typing import Any, NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.grammar import GRAMMAR
from composer.tree.classes import MAIN
from composer.tree.kinds import WORLD_SECTION, kind_of, naming_attribute, section_of
from composer.tree.name_index import SEPARATOR, NameIndex, own_name
from composer.tree.names import WORLD, may_be_generated
from composer.tree.removal import names_in
from composer.tree.unit import Unit

UNNAMED = "unnamed_model"


class Target(NamedTuple):
    """A node and the model that it belongs to."""

    model: Model
    node: Node


@dataclass(eq=False, slots=True)
class Attachment:
    """A model attached to another: to `host`, a site, body, frame or the worldbody of `parent`.

    `frame` is a separate body, not in the parent's tree: its pose is the offset, and its joints are those between
    the two models. Their names get the child's prefix; a joint without a name has just the prefix as its name.
    """

    parent: Model
    child: Model
    host: Node
    frame: Node

    @property
    def is_body(self) -> bool:
        """Whether the frame becomes a body of the output; a weld without a joint adds none."""
        return len(self.frame) > 0 or self.frame.get("mocap") == "true"

    @property
    def container(self) -> Node:
        """The element below which the child stands in the output."""
        if self.host.tag != "site":
            return self.host
        holder = self.host.getparent()
        assert holder is not None
        return holder

    def find(self, namespace: str, name: str) -> Node | None:
        """The frame or one of its joints; `name` is without the prefix."""
        if namespace == "body":
            return self.frame if not name and self.is_body else None
        if namespace == "joint":
            return next((joint for joint in self.frame if (joint.get("name") or "") == name), None)
        return None

    def names(self) -> Iterator[tuple[str, str]]:
        """Namespace and name of all that the parent knows of what hangs on it."""
        child, prefix = self.child, self.child.prefix
        yield "body", prefix
        yield "default", prefix
        yield from (("joint", prefix + str(joint.get("name") or "")) for joint in self.frame)
        for namespace, names in child.names.declared.items():
            yield from ((namespace, prefix + name) for name in names)
        for inner in child.attachments.values():
            yield from ((namespace, prefix + name) for namespace, name in inner.names())


@dataclass(eq=False)
class Model:
    """The state shared by a `RootElement` and all Elements of one model.

    Accessing a section that does not exist creates it, under a lock, so several threads can read at once. `views`
    has the Element of every node accessed so far, so that each node has only one; see `views.py`. `attachments` are
    by prefix, in the order in which they were made.
    """

    unit: Unit
    views: dict[Node, Any] = field(default_factory=dict)
    attachments: dict[str, Attachment] = field(default_factory=dict)
    hung: Attachment | None = None
    lock: Lock = field(default_factory=Lock)

    @cached_property
    def names(self) -> NameIndex:
        return NameIndex.of(self.unit.root)

    @property
    def name(self) -> str:
        return self.unit.model or self.unit.label or UNNAMED

    @property
    def prefix(self) -> str:
        """What stands before this model's names in the model it is attached to."""
        return self.name + SEPARATOR

    @property
    def full_prefix(self) -> str:
        """What stands before this model's names in the output; empty at the top."""
        return "" if self.hung is None else self.hung.parent.full_prefix + self.prefix

    @property
    def top(self) -> Model:
        model = self
        while model.hung is not None:
            model = model.hung.parent
        return model

    def ancestors(self) -> Iterator[Model]:
        """The models this one hangs on, the nearest first."""
        model = self
        while model.hung is not None:
            model = model.hung.parent
            yield model

    def levels(self) -> Iterator[tuple[Model, str]]:
        """This model and those it hangs on, each with what stands before this model's names there."""
        model, prefix = self, ""
        yield model, prefix
        while model.hung is not None:
            model, prefix = model.hung.parent, model.prefix + prefix
            yield model, prefix

    def section(self, tag: str) -> Node:
        """The node of a top-level section; made where there is none, in MJCF's usual order."""
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
        """The one child of that tag; made where there is none."""
        with self.lock:
            found = next(node.iterchildren(tag), None)
            if found is None:
                found = node.makeelement(tag)
                node.append(found)
        return found

    def attachment_of(self, frame: Node) -> Attachment:
        """The attachment that a frame belongs to."""
        return next(each for each in self.attachments.values() if each.frame is frame)

    def frame_above(self, node: Node) -> Node | None:
        """The attachment frame that a node is or hangs on; None for nodes of the model's own tree."""
        if not self.attachments:
            return None
        while (parent := node.getparent()) is not None:
            node = parent
        return None if node is self.unit.root else node

    def has(self, node: Node) -> bool:
        """Whether a node is in the tree or in an attachment frame."""
        while (parent := node.getparent()) is not None:
            node = parent
        return node is self.unit.root or any(each.frame is node for each in self.attachments.values())

    def span(self, node: Node) -> Span:
        """Where a node came from: a place in a file, or the line that added it."""
        return self.unit.origins.span(node, self.unit.file)

    def split(self, name: str) -> Iterator[tuple[Attachment, str]]:
        """The attached models whose prefix a name begins with, each with the rest of the name."""
        at = name.find(SEPARATOR) if self.attachments else -1
        while at >= 0:
            attachment = self.attachments.get(name[: at + 1])
            if attachment is not None:
                yield attachment, name[at + 1 :]
            at = name.find(SEPARATOR, at + 1)

    def lookup(self, namespace: str, name: str) -> Target | None:
        """What a name means in this model: an element of its own, or by prefix one of what is attached."""
        node = self.names.find(namespace, name)
        if node is not None:
            return Target(self, node)
        if namespace == "body" and name == WORLD:
            return Target(self, self.section(WORLD_SECTION))
        if namespace == "default" and name == MAIN:
            return Target(self, self.section("default"))
        for attachment, rest in self.split(name):
            found = attachment.child.lookup_attached(namespace, rest)
            if found is not None:
                return found
            frame = attachment.find(namespace, rest)
            if frame is not None:
                return Target(self, frame)
        return None

    def find_node(self, namespace: str, name: str) -> Node | None:
        """The element that a name means, of this model or of what is attached."""
        found = self.lookup(namespace, name)
        return None if found is None else found.node

    def known_names(self, namespace: str) -> Iterator[str]:
        """Every name of a namespace that the model can refer to."""
        yield from self.names.declared.get(namespace, ())
        for prefix, attachment in self.attachments.items():
            if namespace == "body" and attachment.is_body:
                yield prefix
            if namespace == "joint":
                yield from (prefix + str(joint.get("name") or "") for joint in attachment.frame)
            yield from (prefix + name for name in attachment.child.known_names(namespace))

    def kinds_of(self, name: str) -> Iterator[str]:
        """The namespaces in which something has a name."""
        namespaces = dict.fromkeys(each for model in self.composition() for each in model.names.declared)
        yield from (each for each in namespaces if self.lookup(each, name) is not None)

    def may_generate(self, name: str) -> bool:
        """Whether MuJoCo may make the name itself."""
        if may_be_generated(name, self.unit.root):
            return True
        return any(attachment.child.may_generate(rest) for attachment, rest in self.split(name))

    def composition(self) -> Iterator[Model]:
        """The model and all that hang on it, at any depth."""
        yield self
        for attachment in self.attachments.values():
            yield from attachment.child.composition()

    def names_of(self, node: Node) -> list[tuple[str, str]]:
        """Namespace and name of everything that goes with a node, what is attached there included."""
        if not self.attachments:
            return names_in(node)
        inside = dict.fromkeys(node.iter("*"))
        if self.frame_above(node) is not None:
            return [name for each in inside if (name := self.declared(each)) is not None]
        hanging = [each for each in self.attachments.values() if each.host in inside]
        return [*names_in(node), *(name for attachment in hanging for name in attachment.names())]

    def lookup_attached(self, namespace: str, name: str) -> Target | None:
        """The same for a model that hangs: its world is not a body, its top class has the bare prefix."""
        if namespace == "default" and not name:
            return Target(self, self.section("default"))
        if (namespace, name) in (("body", WORLD), ("default", MAIN)):
            return None
        return self.lookup(namespace, name)

    def declared(self, node: Node) -> tuple[str, str] | None:
        """Namespace and name of a node as this model sees it; None where it has no name."""
        if node.tag == WORLD_SECTION:
            return "body", WORLD
        kind = kind_of(node)
        attribute = naming_attribute(kind)
        if node.getparent() is self.unit.root and kind.tag == "default":
            return "default", MAIN
        frame = self.frame_above(node)
        if frame is not None:
            prefix = self.attachment_of(frame).child.prefix
            if node is frame:
                return "body", prefix
            return ("joint", prefix + str(node.get("name") or "")) if attribute else None
        if attribute is None or attribute.declares is None:
            return None
        name = own_name(node, attribute.name)
        return None if name is None else (attribute.declares, name)

    def seen_from(self, other: Model, node: Node) -> str | None:
        """The name under which `other`, this model or one it hangs on, knows a node; None without a name."""
        declared = self.declared(node)
        if declared is None:
            return None
        namespace, name = declared
        model = self
        while model is not other:
            if model.hung is None:
                return None
            if (namespace, name) == ("default", MAIN):
                name = ""
            elif (namespace, name) == ("body", WORLD):
                return None
            name = model.prefix + name
            model = model.hung.parent
        return name

    def prefix_in(self, other: Model) -> str | None:
        """What stands before this model's names in `other`; None where it does not hang on that."""
        prefix, model = "", self
        while model is not other:
            if model.hung is None:
                return None
            prefix, model = model.prefix + prefix, model.hung.parent
        return prefix

    def note(self, node: Node) -> None:
        """Take up the names of a node that has come or changed."""
        self.names.note(node, section_of(node), declares=self.frame_above(node) is None)

    def forget(self, node: Node) -> None:
        """Drop the names of a node that goes or changes."""
        self.names.forget(node, section_of(node))

"""A composition in document order, and elements by tag and name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.mjcf.asset import as_name
from mjcompose.mjcf.errors import unknown_tag
from mjcompose.mjcf.model import AttachedModel, ModelState, ReferencedNode
from mjcompose.tree.edit import is_section
from mjcompose.tree.names import WORLD
from mjcompose.tree.select import WORLD_SECTION, Query, kind_of, query, section_of, tags_of


def from_root(model: ModelState, query: Query) -> Iterator[ReferencedNode]:
    """Yield all matches in a model, section by section. In each section, attached models come last."""
    for tag in _section_tags(model):
        if tag in query.sections:
            yield from _in_section(model, tag, query)


def matches_below(model: ModelState, node: Node, query: Query) -> Iterator[ReferencedNode]:
    """Yield all matches below a node, without the node itself."""
    frame = model.frame_above(node)
    if frame is not None:
        yield from _frame_content(model.attachment_of(frame), query) if node is frame else ()
        return
    section = section_of(node)
    if section == WORLD_SECTION:
        yield from _World(model, query).below(node)
    else:
        yield from _flat(model, node, section, query=query)
        if is_section(node):
            for attachment in model.attachments.values():
                yield from _in_section(attachment.child, section, query, itself=False)


def children(model: ModelState, node: Node, query: Query) -> Iterator[ReferencedNode]:
    """Yield all matches among the children of a node. The top level of a model attached without a body counts too."""
    frame = model.frame_above(node)
    if frame is not None:
        yield from _frame_content(model.attachment_of(frame), query, immediate=True)
        return
    section = section_of(node)
    if query.tags:
        for child in node.iterchildren(*query.tags):
            if query.takes(section, str(node.tag), str(child.tag)):
                yield ReferencedNode(model, child)
    for attachment in model.attachments.values():
        if attachment.container is node:
            if not attachment.is_body:
                yield from _top_level(attachment.child, query)
            elif "body" in query.paths:
                yield ReferencedNode(model, attachment.frame)
        elif is_section(node) and section != WORLD_SECTION:
            for other in attachment.child.unit.root.iterchildren(section):
                yield from children(attachment.child, other, query)


def is_below(outer: ReferencedNode, inner: ReferencedNode) -> bool:
    """Return whether `inner` is anywhere below `outer` in the output."""
    model, node = inner
    while model is not outer.model:
        if model.hung is None:
            return False
        attachment = model.hung
        if outer == (attachment.parent, attachment.frame):
            return True
        section = section_of(node)
        model = attachment.parent
        if section == WORLD_SECTION:
            node = attachment.container
            if node is outer.node:
                return True
        else:
            return outer.node is model.unit.root or (is_section(outer.node) and outer.node.tag == section)
    frame = model.frame_above(node)
    if frame is not None and outer.node is not frame:
        node = model.attachment_of(frame).container
        if node is outer.node:
            return True
    return outer.node in node.iterancestors()


def _top_level(model: ModelState, query: Query) -> Iterator[ReferencedNode]:
    for worldbody in model.unit.root.iterchildren(WORLD_SECTION):
        yield from children(model, worldbody, query)


def _in_section(model: ModelState, tag: str, query: Query, *, itself: bool = True) -> Iterator[ReferencedNode]:
    for section in model.unit.root.iterchildren(tag):
        if itself and tag in query.paths:
            yield ReferencedNode(model, section)
        if tag == WORLD_SECTION:
            yield from _World(model, query).below(section)
        else:
            yield from _flat(model, section, tag, query=query)
    if tag != WORLD_SECTION:
        for attachment in model.attachments.values():
            yield from _in_section(attachment.child, tag, query, itself=itself)


def _flat(model: ModelState, node: Node, section: str, query: Query) -> Iterator[ReferencedNode]:
    """Yield the matches below a node, without those in attached models. This takes one pass in lxml."""
    if query.tags:
        for each in node.iterdescendants(*query.tags):
            parent = each.getparent()
            if parent is not None and query.takes(section, str(parent.tag), str(each.tag)):
                yield ReferencedNode(model, each)


class _World:
    """Matches in the body tree of one model, with attached models at their places."""

    def __init__(self, model: ModelState, query: Query) -> None:
        self.model = model
        self.query = query
        self.hanging: dict[Node, list[AttachedModel]] = {}
        self.leads_there: set[Node] = set()
        for attachment in model.attachments.values():
            container = attachment.container
            self.hanging.setdefault(container, []).append(attachment)
            self.leads_there.update([container, *container.iterancestors()])

    def below(self, node: Node) -> Iterator[ReferencedNode]:
        if node not in self.leads_there:
            yield from _flat(self.model, node, WORLD_SECTION, query=self.query)
            return
        for child in node.iterchildren("*"):
            tag = str(child.tag)
            if tag in self.query.tags and self.query.takes(WORLD_SECTION, str(node.tag), tag):
                yield ReferencedNode(self.model, child)
            yield from self.below(child)
        for attachment in self.hanging.get(node, ()):
            if attachment.is_body and "body" in self.query.paths:
                yield ReferencedNode(self.model, attachment.frame)
            yield from _frame_content(attachment, self.query)


def _frame_content(attachment: AttachedModel, query: Query, *, immediate: bool = False) -> Iterator[ReferencedNode]:
    """Yield the matches among the joints of a frame, then those in the worldbody of the child, or at its top level."""
    if query.tags:
        for joint in attachment.frame.iterchildren(*query.tags):
            if query.takes(WORLD_SECTION, "body", str(joint.tag)):
                yield ReferencedNode(attachment.parent, joint)
    child = attachment.child
    yield from _top_level(child, query) if immediate else _in_section(child, WORLD_SECTION, query, itself=False)


def _section_tags(model: ModelState) -> list[str]:
    """Return the tags of the sections in a model and the models attached to it, the model's own first."""
    tags = dict.fromkeys(str(section.tag) for section in model.unit.root.iterchildren("*"))
    for attachment in model.attachments.values():
        tags.update(dict.fromkeys(_section_tags(attachment.child)))
    return list(tags)


def find_first(here: ReferencedNode, tag: str, name: str | None) -> ReferencedNode | None:
    """Return the first match below `here`, or the match with that name. See `Element.find`."""
    from_root = here.node is here.model.unit.root
    wanted = _query(here, tag)
    if name is None:
        return next(_matches(here, wanted), None)
    name = as_name("name", name)
    for namespace in wanted.namespaces:
        found = here.model.lookup(namespace, name)
        if found is not None:
            fits = kind_of(found.node).path in wanted.paths or (name == WORLD and namespace == "body")
            if fits and (from_root or is_below(here, found)):
                return found
    return None


def cached_element(model: ModelState, tag: str, name: str) -> Any:
    """Return the Element with that name if it is the model's own and was accessed before, which is the common case."""
    wanted = query(tag, None)
    for namespace in wanted.namespaces:
        names = model.names.declared.get(namespace)
        node = None if names is None else names.get(name)
        found = None if node is None else model.views.get(node)
        if found is not None and found._kind.path in wanted.paths:
            return found
    return None


def find_every(here: ReferencedNode, tag: str, immediate_children_only: bool) -> Iterator[ReferencedNode]:
    """Yield all matches below `here`. See `Element.find_all`."""
    wanted = _query(here, tag)
    return children(*here, wanted) if immediate_children_only else _matches(here, wanted)


def find_attached(model: ModelState, prefix: str) -> ModelState | None:
    """Return the model attached under `prefix`, which ends in the separator, or None. See `Element.enter_scope`."""
    for attachment, rest in model.split(prefix):
        found = find_attached(attachment.child, rest) if rest else attachment.child
        if found is not None:
            return found
    return None


def _matches(here: ReferencedNode, wanted: Query) -> Iterator[ReferencedNode]:
    return from_root(here.model, wanted) if here.node is here.model.unit.root else matches_below(*here, wanted)


def _query(here: ReferencedNode, tag: str) -> Query:
    from_root = here.node is here.model.unit.root
    wanted = query(tag, None if from_root else section_of(here.node)) if isinstance(tag, str) else None
    if wanted is None or not (wanted.paths or query(tag, None).paths):
        raise unknown_tag(tag, f"MJCF has no element `{tag}`", tags_of())
    return wanted

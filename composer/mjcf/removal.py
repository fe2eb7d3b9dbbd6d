"""Taking elements out, alone or with everything that refers to them."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.mjcf.call_site import call_site
from composer.mjcf.errors import failure
from composer.mjcf.kinds import ROOT, WORLD_SECTION, section_of
from composer.mjcf.model import Attachment, Model, Target

# An element is still one without its class or its material; without anything else that it names it is not.
_DROPPED = frozenset({"default", "material"})


def remove(model: Model, node: Node, cascade: bool) -> None:
    """Take a node out of its model; a top-level section is emptied and stays."""
    if node is model.unit.root:
        raise failure(
            "not-supported",
            "the root of a model cannot be removed",
            call_site(),
            help="`detach()` takes an attached model out of the one it hangs on",
        )
    waiting = [Target(model, node)]
    while waiting:
        target = waiting.pop()
        if not target.model.has(target.node):
            continue
        names = _names(target) if cascade else []
        _take_out(target)
        for namespace, name in names:
            waiting.extend(_let_go(target.model, namespace, name))


def discard(model: Model, node: Node) -> None:
    """Forget all that is known of a node and what is below it, which is about to leave the tree."""
    for each in node.iter("*"):
        model.forget(each)
        view = model.views.pop(each, None)
        if view is not None:
            view._take_out()
        model.unit.origins.owners.pop(each, None)
        model.unit.origins.settings.pop(each, None)


def _names(target: Target) -> list[tuple[str, str]]:
    """Namespace and name of everything that goes."""
    model, node = target
    inside = list(node.iter("*"))
    declared = [model.declared(each) for each in inside if not _is_section(each)]
    hanging = [each for each in model.attachments.values() if each.host in inside]
    return [
        *(each for each in declared if each is not None),
        *(each for attachment in hanging for each in _attached_names(attachment)),
    ]


def _attached_names(attachment: Attachment) -> Iterator[tuple[str, str]]:
    """Every name under which the parent knows something of what hangs on it."""
    child, prefix = attachment.child, attachment.child.prefix
    yield "body", prefix
    yield "default", prefix
    yield from (("joint", prefix + str(joint.get("name") or "")) for joint in attachment.frame)
    for namespace, names in child.names.declared.items():
        yield from ((namespace, prefix + name) for name in names)
    for inner in child.attachments.values():
        yield from ((namespace, prefix + name) for namespace, name in _attached_names(inner))


def _take_out(target: Target) -> None:
    model, node = target
    inside = set(node.iter("*"))
    for prefix, attachment in list(model.attachments.items()):
        if attachment.host in inside:
            release(model, prefix)
    if _is_section(node):
        model.forget(node)
        node.attrib.clear()
        for child in list(node):
            if isinstance(child.tag, str):
                discard(model, child)
            node.remove(child)
        return
    parent = node.getparent()
    assert parent is not None
    discard(model, node)
    parent.remove(node)


def release(model: Model, prefix: str) -> None:
    """Undo an attachment; the child is a model of its own again."""
    attachment = model.attachments[prefix]
    discard(model, attachment.frame)
    del model.attachments[prefix]
    attachment.child.hung = None


def _let_go(model: Model, namespace: str, name: str) -> list[Target]:
    """Drop the references to a name that an element can do without; gives the elements that must go."""
    going: list[Target] = []
    here: Model | None = model
    while here is not None:
        for node, attribute in here.names.users(namespace, name):
            if namespace in _DROPPED or section_of(node) == "default":
                here.forget(node)
                del node.attrib[attribute]
                here.note(node)
            else:
                going.append(Target(here, _whole(node)))
        if here.hung is None:
            break
        name = here.prefix + name
        here = here.hung.parent
    return going


def _whole(node: Node) -> Node:
    """What makes sense only as a whole: a section's direct child, in the body tree the element itself."""
    if section_of(node) == WORLD_SECTION:
        return node
    while (parent := node.getparent()) is not None and not _is_section(parent):
        node = parent
    return node


def _is_section(node: Node) -> bool:
    parent = node.getparent()
    return parent is not None and parent.tag == ROOT

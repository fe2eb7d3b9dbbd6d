"""Remove elements, alone or with everything that refers to them."""

from __future__ import annotations

from lxml.etree import _Element as Node

from composer.diagnostics.call_site import call_site
from composer.mjcf.errors import failure
from composer.mjcf.model import Model
from composer.tree.removal import Removal, is_section


def remove(model: Model, node: Node, cascade: bool) -> None:
    """Remove a node from its model. A top-level section stays and is emptied."""
    if node is model.unit.root:
        raise failure(
            "not-supported",
            "the root of a model cannot be removed",
            call_site(),
            help="`detach()` takes an attached model out of the one it is attached to",
        )
    removal = Removal.of([(model, node)]).with_referrers() if cascade else None
    if removal is not None:
        removal.drop_references()
    for here, going in removal.going if removal is not None else ((model, node),):
        _take_out(here, going)


def discard(model: Model, node: Node) -> None:
    """Remove a node and everything below it from the model's indexes, before it is removed from the tree."""
    for each in node.iter("*"):
        model.forget(each)
        view = model.views.pop(each, None)
        if view is not None:
            view._take_out()
        model.unit.origins.owners.pop(each, None)
        model.unit.origins.settings.pop(each, None)


def _take_out(model: Model, node: Node) -> None:
    inside = set(node.iter("*"))
    for prefix, attachment in list(model.attachments.items()):
        if attachment.host in inside:
            release(model, prefix)
    if is_section(node):
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
    """Remove an attachment. The child becomes an independent model again."""
    attachment = model.attachments[prefix]
    discard(model, attachment.frame)
    del model.attachments[prefix]
    attachment.child.hung = None

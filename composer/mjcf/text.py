"""Show an element as text, for people: the tree of its own model, not the text that MuJoCo gets."""

from __future__ import annotations

import copy

from lxml import etree
from lxml.etree import _Element as Node

from composer.mjcf.model import Model
from composer.tree.counterpart import counterpart


def text(model: Model, node: Node) -> str:
    """Return a node and everything below it as MJCF without a final newline. Comments mark attached models."""
    copied = copy.deepcopy(node)
    for attachment in model.attachments.values():
        if attachment.host is node or node in attachment.host.iterancestors():
            note = etree.Comment(f" {attachment.child.prefix} is attached here ")
            counterpart(attachment.host, node, copied).append(note)
    copied.tail = None
    for each in copied.iter():
        if isinstance(each.tag, str) and not (each.text or "").strip():
            each.text = None
        if not (each.tail or "").strip():
            each.tail = None
    return etree.tostring(copied, encoding="unicode", pretty_print=True).rstrip()

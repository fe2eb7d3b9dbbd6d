"""Elements as notebooks show them: MJCF as a tree that opens and closes, a whole model with its picture."""

from __future__ import annotations

import base64
import warnings
from html import escape
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.engine.png import png
from composer.mjcf.errors import MjcfError, MjcfWarning
from composer.mjcf.model import Model
from composer.tree.kinds import ROOT, WORLD_SECTION

if TYPE_CHECKING:
    from composer.mjcf.element import Element
    from composer.mjcf.root import RootElement

SHOWN = 1000
"""Elements of a tree; what is more is counted only, as a page of a hundred thousand helps nobody."""
_DEEPEST = 100
_SIZE = 240, 320
_STYLE = "font-family: monospace; white-space: pre; line-height: 1.4"
_INSIDE = "margin-left: 1.5em"


def page(element: Element) -> str:
    """The element and all below it, attached models where they hang; the first two levels are open."""
    lines: list[str] = []
    left = _tree(element._model, element._node, lines, SHOWN, 0)
    if left < 0:
        lines.append(f"<div>… and {-left} more elements</div>")
    return f'<div style="{_STYLE}">{"".join(lines)}</div>'


def page_with_picture(root: RootElement) -> str:
    """The same of a whole model, with a picture of it where there is OpenGL and MuJoCo takes the model."""
    image = picture(root)
    if image is None:
        return page(root)
    data = base64.b64encode(image).decode()
    return (
        '<div style="display: flex; gap: 1em; align-items: flex-start">'
        f'<img alt="{escape(root.model)}" src="data:image/png;base64,{data}"/>{page(root)}</div>'
    )


def picture(root: RootElement) -> bytes | None:
    """The whole composition in its reference configuration, as a PNG; None where that cannot be had."""
    if not len(root.root_model._model.section(WORLD_SECTION)):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MjcfWarning)
        try:
            return png(root.root_model.compile_model(conflict="warning").render(*_SIZE))
        except MjcfError:
            return None


def _tree(model: Model, node: Node, lines: list[str], left: int, depth: int) -> int:
    """Write a node with all below it while there is room; gives how much room is left."""
    if left <= 0:
        return left - _count(model, node)
    if depth > _DEEPEST:
        lines.append(f"<div>… {_count(model, node)} elements</div>")
        return left - 1
    left -= 1
    children = list(node.iterchildren("*"))
    attached = [each for each in model.attachments.values() if each.host is node]
    tag = _start_tag(node, not children and not attached)
    if not children and not attached:
        lines.append(f"<div>{tag}</div>")
        return left
    is_open = " open" if depth < 2 or (node.tag == WORLD_SECTION and depth < 3) else ""
    lines.append(f'<details{is_open}><summary>{tag}</summary><div style="{_INSIDE}">')
    for child in children:
        left = _tree(model, child, lines, left, depth + 1)
    for attachment in attached:
        if left > 0:
            lines.append(f"<div>{escape(attachment.child.prefix)} is attached here:</div>")
        for joint in attachment.frame:
            left = _tree(model, joint, lines, left, depth + 1)
        left = _tree(attachment.child, attachment.child.unit.root, lines, left, max(depth + 1, 2))
    lines.append("</div></details>")
    return left


def _count(model: Model, node: Node) -> int:
    """A node and all below it, what is attached there included."""
    hanging = (each for each in model.attachments.values() if node in (each.host, *each.host.iterancestors()))
    return sum(1 for _ in node.iter("*")) + sum(
        len(each.frame) + _count(each.child, each.child.unit.root) for each in hanging
    )


def _start_tag(node: Node, is_empty: bool) -> str:
    attributes = "".join(
        f' {escape(str(name))}=<span style="color: #067d17">"{escape(str(value))}"</span>'
        for name, value in node.items()
    )
    weight = "font-weight: bold; " if node.tag in (ROOT, "body") else ""
    tag = f'<span style="{weight}color: #0033b3">{escape(str(node.tag))}</span>'
    return f"&lt;{tag}{attributes}{'/' if is_empty else ''}&gt;"

"""Show elements in notebooks: MJCF as a collapsible tree."""

from __future__ import annotations

from html import escape

from lxml.etree import _Element as Node

from composer.mjcf.model import Model
from composer.tree.kinds import ROOT, WORLD_SECTION

SHOWN = 1000
"""Elements of a tree; what is more is counted only, as a page of a hundred thousand helps nobody."""
_DEEPEST = 100
_STYLE = "font-family: monospace; white-space: pre; line-height: 1.4"
_INSIDE = "margin-left: 1.5em"


def page(model: Model, node: Node) -> str:
    """Return HTML of an element and everything below it, with attached models at their hosts.

    The first two levels are open.
    """
    lines: list[str] = []
    left = _tree(model, node, lines, SHOWN, 0)
    if left < 0:
        lines.append(f"<div>… and {-left} more elements</div>")
    return f'<div style="{_STYLE}">{"".join(lines)}</div>'


def _tree(model: Model, node: Node, lines: list[str], left: int, depth: int) -> int:
    """Append a node and everything below it to `lines`, up to `left` elements. Return how many are left.

    The result is negative if elements were left out.
    """
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
    """Return the number of elements in a node's subtree, including the models attached there."""
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

"""How many elements a model has once MuJoCo has expanded it: counted before anything is expanded."""

from __future__ import annotations

import math
from collections.abc import Callable

from lxml.etree import XPath
from lxml.etree import _Element as Node

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.limits import advice, in_force
from composer.tree.file_points import file_points
from composer.tree.reserved import check_reserved
from composer.tree.unit import Unit

CODE = "limit-exceeded"
_FLEX_COUNT, _COMPOSITE_COUNT = "10 10 10", "1 1 1"
_COUNTED = ("grid", "box", "cylinder", "ellipsoid", "square", "disc", "circle")
"""The types of `<flexcomp>` that make `count` points; others have them from a file or an attribute."""
_COUNT = XPath("count(descendant-or-self::*)")  # compiled once: that takes as long as to count 100 elements
_EXPANDING = ("replicate", "flexcomp", "composite", "attach")


def written(root: Node) -> int:
    """How many elements stand in a tree.

    >>> from lxml import etree
    >>> written(etree.fromstring("<mujoco><worldbody><!-- none --><geom/></worldbody></mujoco>"))
    3
    """
    return int(_COUNT(root))  # type: ignore[arg-type]


def check_size(unit: Unit, sink: Sink, attached: Callable[[Node], int] = lambda _: 0) -> None:
    """Report a model that is larger than the limits allow, at the element that makes it so. Nothing is expanded.

    `attached` says how many elements an `<attach>` brings.
    """
    limits = in_force()
    elements = written(unit.root)
    if elements > limits.elements:
        sink.error(
            CODE,
            f"the model has {elements} elements; {limits.elements} are allowed",
            unit.origins.span(unit.root, unit.file),
            help=advice("elements", elements),
        )
        return
    # MuJoCo 4.0 takes 110 s to read 49,000 bodies that stand side by side, and four times as long for twice as many.
    few = elements <= limits.bodies
    bodies = elements if few else int(unit.root.xpath("count(descendant::body)"))  # type: ignore[arg-type]
    if bodies > limits.bodies:
        message = f"the model has {bodies} bodies; {limits.bodies} are allowed"
        span = unit.origins.span(unit.root, unit.file)
        sink.error(CODE, message, span, help=advice("bodies", bodies))
        return
    if next(unit.root.iter(*_EXPANDING), None) is None:
        check_reserved(unit, elements, sink)
        return
    made, total = _made(unit.root, attached, lambda flexcomp: file_points(flexcomp, unit))
    # An inner one is reported before the one around it, which it may make too large.
    for node in reversed(made):
        if made[node] > limits.expansion:
            said = f"`<{node.tag}>` makes {_number(made[node])} elements"
            _report(unit, node, f"{said}; {limits.expansion} are allowed", made[node], sink)
            return
    if total > limits.expansion:
        largest = max(made, key=lambda node: made[node])
        said = f"the model makes {_number(total)} elements of what is written"
        note = Note(f"most of them, {made[largest]}, here", unit.origins.span(largest, unit.file))
        _report(unit, largest, f"{said}; {limits.expansion} are allowed", total, sink, note)
        return
    check_reserved(unit, elements + total, sink)


def expanded(root: Node, attached: Callable[[Node], int] = lambda _: 0) -> int:
    """How many elements a tree has once it is expanded.

    >>> from lxml import etree
    >>> expanded(etree.fromstring('<body><replicate count="1000"><geom/><site/></replicate></body>'))
    2002
    """
    return written(root) + _made(root, attached)[1]


def _made(
    root: Node, attached: Callable[[Node], int], in_file: Callable[[Node], int] = lambda _: 0
) -> tuple[dict[Node, int], int]:
    """By how many elements each that is expanded grows, in the order of the tree, and by how many the tree does.

    Only what is inside of one that is expanded is looked at; without recursion, however deep a model is.
    """
    made: dict[Node, int] = {}
    total = 0
    for outer in root.iter(*_EXPANDING):
        if outer in made:  # inside of one before
            continue
        inside = list(outer.iter("*"))
        made |= dict.fromkeys((node for node in inside if node.tag in _EXPANDING), 0)
        below: dict[Node, tuple[int, int]] = {}
        for node in reversed(inside):  # what is inside comes before what it is in
            count, size = below.pop(node, (0, 0))
            size = 1 + _expanded(node, size, attached, in_file)
            if node in made:
                made[node] = size - 1 - count
            above = node.getparent()
            if above is not None:
                known = below.get(above, (0, 0))
                below[above] = known[0] + 1 + count, known[1] + size
        total += made[outer]
    return made, total


def _expanded(
    node: Node, inside: int, attached: Callable[[Node], int], in_file: Callable[[Node], int]
) -> int:
    """How many elements there are inside an element that itself counts as one."""
    if node.tag == "replicate":
        return _product(str(node.get("count") or "1"), 1) * inside
    if node.tag == "composite":
        return _product(str(node.get("count") or _COMPOSITE_COUNT), 3) * (1 + inside)
    if node.tag == "flexcomp":
        return inside + _points(node, in_file)
    if node.tag == "attach":
        return inside + attached(node)
    return inside


def _points(flexcomp: Node, in_file: Callable[[Node], int]) -> int:
    if (flexcomp.get("type") or "grid") in _COUNTED:
        return _product(str(flexcomp.get("count") or _FLEX_COUNT), 3)
    return in_file(flexcomp) if flexcomp.get("file") else len(str(flexcomp.get("point") or "").split()) // 3


def _product(text: str, most: int) -> int:
    """The product of the first numbers in a text; what is not a number is reported elsewhere and counts as one.

    >>> _product("10 20 1", 3), _product("many", 1)
    (200, 1)
    """
    return math.prod(_count(word) for word in text.split()[:most])


def _count(word: str) -> int:
    try:
        return max(1, int(float(word)))
    except (ValueError, OverflowError):
        return 1


def _number(count: int) -> str:
    return str(count) if count < 10**18 else f"more than {10**18}"


def _report(unit: Unit, node: Node, message: str, needed: int, sink: Sink, *notes: Note) -> None:
    attribute = "model" if node.tag == "attach" else "file" if node.get("file") else "count"
    span = unit.origins.span(node, unit.file, attribute)
    sink.error(CODE, message, span, notes=notes, help=advice("expansion", needed))

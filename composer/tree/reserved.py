"""Count the memory that a model reserves by a few attributes, before MuJoCo allocates it."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.diagnostics.sink import Sink
from composer.limits import advice, in_force
from composer.tree.files import CUBE
from composer.tree.pixels import pixels
from composer.tree.unit import Unit

_CODE = "limit-exceeded"
_CHANNELS = 3
_OF_A_STEP = 10
"""The weight of a simulated step: it takes at least 1 microsecond."""
_OF_A_KEY = 2000
"""The least weight of a keyframe: MuJoCo 4.0 takes 3 s to make 50,000, and four times that for twice as many."""


def check_reserved(unit: Unit, elements: int, sink: Sink) -> bool:
    """Return whether a model with so many elements, once expanded, reserves no more than the limits allow.

    If not, report the attribute that reserves too much.
    """
    most, total = in_force().reserved, 0
    for node, attribute, count in _reserving(unit, elements):
        total += count
        if total > most:
            span = unit.origins.span(node, unit.file, attribute)
            message = f"`<{node.tag}>` reserves {count} numbers; a model may reserve {most}"
            sink.error(_CODE, message, span, help=advice("reserved", total))
            return False
    return True


def _reserving(unit: Unit, elements: int) -> Iterator[tuple[Node, str, int]]:
    root = unit.root
    for node in root.iter("texture", "hfield", "size", "lengthrange"):
        for attribute in ("file", *CUBE) if node.tag in ("texture", "hfield") else ():
            if node.get(attribute):
                yield node, attribute, pixels(node, attribute, unit)
        if node.tag == "texture" and node.get("file") is None:
            width = _number(node, "width")
            is_cube = (node.get("type") or "cube") != "2d"
            yield node, "width", _CHANNELS * width * (6 * width if is_cube else _number(node, "height"))
        elif node.tag == "hfield" and node.get("file") is None:
            yield node, "nrow", _number(node, "nrow") * _number(node, "ncol")
        elif node.tag == "lengthrange":
            actuators = int(root.xpath("count(actuator/*)"))  # type: ignore[arg-type]
            yield node, "inttotal", _OF_A_STEP * actuators * _steps(node)
        elif node.tag == "size":
            for name in map(str, node.keys()):
                yield node, name, _number(node, name) * _weight(name, elements)


def _weight(name: str, elements: int) -> int:
    """Return the weight of a number in `<size>`; memory and contacts have limits of their own."""
    if name == "nkey":
        return _OF_A_KEY + elements
    return elements if name.startswith("nuser_") else 1 if name == "nuserdata" else 0


def _steps(lengthrange: Node) -> int:
    """Return how many steps MuJoCo simulates for each actuator whose length range it computes."""
    try:
        seconds = float(lengthrange.get("inttotal") or 10)
        return int(seconds / float(lengthrange.get("timestep") or 0.01))
    except (ValueError, OverflowError, ZeroDivisionError):
        return 0


def _number(node: Node, name: str) -> int:
    """Return a number, or 0 if it is not a number, which is reported elsewhere."""
    try:
        return max(0, int(float(node.get(name) or 0)))
    except (ValueError, OverflowError):
        return 0

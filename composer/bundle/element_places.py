"""Where the elements of a compiled model are written: tag and place by kind and number."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.tree.classes import through_frames
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from composer.engine import Index

_OF_BODIES = {"joint": ("joint", "freejoint"), "camera": ("camera",)}
_SECTIONS = {"actuator": "actuator", "sensor": "sensor", "key": "keyframe"}


def written_in(
    model: Unit, index: Index, place: Callable[[Span], str]
) -> dict[tuple[str, int], tuple[str, str]]:
    """Return tag and place by kind and number, without copies that MuJoCo made and the unnamed elements among them."""
    names = {
        "joint": [each.name for each in index.joints],
        "actuator": [each.name for each in index.actuators],
        "sensor": [each.name for each in index.sensors],
        "camera": [each.name for each in index.cameras],
        "key": [each.name for each in index.keyframes],
    }
    found: dict[tuple[str, int], tuple[str, str]] = {}
    for kind, compiled in names.items():
        for number, node in _matched(list(_elements(model.root, kind)), compiled):
            found[kind, number] = (str(node.tag), place(model.origins.span(node, model.file)))
    return found


def _matched(elements: Sequence[Node], names: Sequence[str]) -> Iterator[tuple[int, Node]]:
    """Yield elements by number: in order if each became one element, by name if some became several."""
    if [str(each.get("name") or "") for each in elements] == list(names):
        yield from enumerate(elements)
        return
    by_name = {str(each.get("name")): each for each in elements if each.get("name")}
    yield from ((number, by_name[name]) for number, name in enumerate(names) if name in by_name)


def _elements(root: Node, kind: str) -> Iterator[Node]:
    if kind in _SECTIONS:
        for section in root.iterchildren(_SECTIONS[kind]):
            yield from section.iterchildren("*")
        return
    for world in root.iterchildren("worldbody"):
        yield from _of_body(world, _OF_BODIES[kind])


def _of_body(body: Node, tags: tuple[str, ...]) -> Iterator[Node]:
    """Yield the elements of a body, including those in frames, before those of child bodies: MuJoCo's order."""
    inner = list(through_frames(body))
    yield from (each for each in inner if each.tag in tags)
    for each in inner:
        if each.tag == "body":
            yield from _of_body(each, tags)

"""The one Element of each node. `composer.mjcf` registers the view classes, so other modules need not import them."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.grammar import GRAMMAR, ElementType
from composer.mjcf.members import class_name, members
from composer.mjcf.model import Model
from composer.tree.kinds import kind_of


@dataclass(frozen=True, slots=True)
class ViewClasses:
    """The classes for views of elements, of roots, of attachment frames, and of lists of elements."""

    element: type[Any]
    root: type[Any]
    frame: type[Any]
    several: type[Any]


_CLASSES: list[ViewClasses] = []


def register(classes: ViewClasses) -> None:
    """Set the classes of views. It is called once, when `composer.mjcf` is imported."""
    _CLASSES[:] = [classes]


def view(model: Model, node: Node) -> Any:
    """Return the only Element of a node, and create it on first access."""
    found = model.views.get(node)
    return model.views.setdefault(node, _class_for(model, node)._of(model, node)) if found is None else found


def views(model: Model, tag: str, nodes: Iterable[Node]) -> Any:
    """Return the Elements of nodes with the same tag as an `ElementList`."""
    return _CLASSES[0].several(tag, (view(model, node) for node in nodes))


def _class_for(model: Model, node: Node) -> Any:
    if node.getparent() is not None:
        return class_of(kind_of(node))
    return _CLASSES[0].root if node is model.unit.root else _CLASSES[0].frame


@cache
def class_of(kind: ElementType) -> type[Any]:
    """Return the class for elements of a kind: an `Element` with a documented property for each attribute and child."""
    base = _CLASSES[0].element
    inside = {
        **members(kind, taken=dir(base)),
        "__slots__": (),
        "__module__": base.__module__,
        "_kind": kind,
    }
    return type(class_name(kind), (base,), inside)


@cache
def kinds() -> dict[str, ElementType]:
    """Return every kind of element that a model has below its root, by the name of its class."""
    reached: dict[str, ElementType] = {}
    waiting = [*GRAMMAR.root.children.values()]
    while waiting:
        kind = waiting.pop(0)
        if reached.setdefault(class_name(kind), kind) is kind and kind not in waiting:
            waiting += [each for each in kind.children.values() if class_name(each) not in reached]
    return reached

"""The one Element of each node. `composer.mjcf` registers the view classes, so other modules need not import them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from lxml.etree import _Element as Node

from composer.grammar import ElementType
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
    """The classes that are made from now on; called once, when `composer.mjcf` is imported."""
    _CLASSES[:] = [classes]


def view(model: Model, node: Node) -> Any:
    """The one Element of a node."""
    found = model.views.get(node)
    return model.views.setdefault(node, _class_for(model, node)._of(model, node)) if found is None else found


def views(model: Model, tag: str, nodes: Iterable[Node]) -> Any:
    """The Elements of nodes that have one tag, as an `ElementList`."""
    return _CLASSES[0].several(tag, (view(model, node) for node in nodes))


def _class_for(model: Model, node: Node) -> Any:
    if node.getparent() is not None:
        return class_of(kind_of(node))
    return _CLASSES[0].root if node is model.unit.root else _CLASSES[0].frame


@cache
def class_of(kind: ElementType) -> type[Any]:
    """The class of the elements of a kind: `Element` with a property for each attribute and child, documented."""
    base = _CLASSES[0].element
    inside = {
        **members(kind, taken=dir(base)),
        "__slots__": (),
        "__module__": base.__module__,
        "_kind": kind,
    }
    return type(class_name(kind), (base,), inside)

"""The one Element of each node. Classes of Elements register here, so that what makes views need not import them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, Literal, TypeVar

from lxml.etree import _Element as Node

from composer.grammar import ElementType
from composer.mjcf.members import class_name, members
from composer.mjcf.model import Model
from composer.tree.kinds import kind_of

T = TypeVar("T", bound=type)
Role = Literal["element", "root", "frame"]
_CLASSES: dict[Role, Any] = {}


def views_of(role: Role) -> Callable[[T], T]:
    """Registers the class of the views of all elements, of roots, or of attachment frames."""

    def register(view_class: T) -> T:
        _CLASSES[role] = view_class
        return view_class

    return register


def view(model: Model, node: Node) -> Any:
    """The one Element of a node."""
    found = model.views.get(node)
    return model.views.setdefault(node, _class_for(model, node)._of(model, node)) if found is None else found


def _class_for(model: Model, node: Node) -> Any:
    if node.getparent() is not None:
        return class_of(kind_of(node))
    return _CLASSES["root" if node is model.unit.root else "frame"]


@cache
def class_of(kind: ElementType) -> type[Any]:
    """The class of the elements of a kind: `Element` with a property for each attribute and child, documented."""
    base = _CLASSES["element"]
    inside = {
        **members(kind, taken=dir(base)),
        "__slots__": (),
        "__module__": base.__module__,
        "_kind": kind,
    }
    return type(class_name(kind), (base,), inside)

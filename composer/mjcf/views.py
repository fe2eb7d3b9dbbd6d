"""The one Element of each node, of a class for each kind of element."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from composer.grammar import ElementType
from composer.mjcf.members import class_name, members
from composer.mjcf.model import Model
from composer.tree.kinds import kind_of

if TYPE_CHECKING:
    from composer.mjcf.element import Element


def view(model: Model, node: Node) -> Element:
    """The one Element of a node."""
    found = model.views.get(node)
    return model.views.setdefault(node, class_of(kind_of(node))(model, node)) if found is None else found


@cache
def class_of(kind: ElementType) -> type[Element]:
    """The class of the elements of a kind: `Element` with a property for each attribute and child, documented."""
    from composer.mjcf.element import Element

    inside = {
        **members(kind, taken=dir(Element)),
        "__slots__": (),
        "__module__": Element.__module__,
        "_kind": kind,
    }
    return type(class_name(kind), (Element,), inside)

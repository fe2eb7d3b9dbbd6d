"""The one view of each node, and the members of its class."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from typing import Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.mjcf.model import Model
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text
from mjcompose.tree.select import HOLDS_ONE_OF_EACH, ROOT, kind_of, spoken
from mjcompose.tree.values import SHOWN_KEYWORDS, expected


@dataclass(frozen=True, slots=True)
class ViewClasses:
    """The classes for views of elements, of roots, of attachment frames, and of lists of elements."""

    element: type[Any]
    root: type[Any]
    frame: type[Any]
    several: type[Any]


_CLASSES: list[ViewClasses] = []


def register(classes: ViewClasses) -> None:
    """Set the classes of views. It is called once, when `mjcompose.mjcf` is imported."""
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
    inside = {**members(kind, taken=dir(base)), "__slots__": (), "__module__": base.__module__, "_kind": kind}
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


def always_there(kind: ElementType, child: ElementType) -> bool:
    """Return whether a child is created on first access: a section, or a child that a setting has only once."""
    return kind.tag == ROOT or (child.max_count == 1 and kind.tag in HOLDS_ONE_OF_EACH)


def class_name(kind: ElementType) -> str:
    """Return the name of the class, for example `Geom` or `EqualityJoint`."""
    return "".join(word.capitalize() for word in re.split(r"[/_]", kind.path))


def members(kind: ElementType, taken: Iterable[str]) -> dict[str, Any]:
    """Return a property for each attribute and child whose name is not in `taken`, and the class docstring."""
    found: dict[str, Any] = {}
    for tag, child in kind.children.items():
        found[spoken(tag)] = _child_property(tag, _of_child(kind, child))
    for attribute in kind.attributes.values():
        found[spoken(attribute.name)] = _attribute_property(attribute)
    for name in taken:
        found.pop(name, None)
    return {**found, "__doc__": of_element(kind)}


def of_element(kind: ElementType) -> str:
    """Return the class docstring of an element: its meaning, and its attributes and children by name."""
    named_first = sorted(kind.attributes.values(), key=lambda each: (not each.declares, each.name != "class"))
    attributes = {spoken(each.name): each for each in named_first}
    lines = [f"`<{kind.tag}>`: {kind.doc}." if kind.doc else f"`<{kind.tag}>`."]
    if attributes:
        rows = (f"    {name}: {each.doc or each.name} [{_takes(each)}]" for name, each in attributes.items())
        lines += ["", "Attributes:", *rows]
    if kind.children:
        lines += ["", f"Children: {', '.join(map(spoken, kind.children))}."]
    return "\n".join(lines)


def of_attribute(attribute: Attribute) -> str:
    """Return the docstring of an attribute: its meaning, its values, its default, and the versions that have it.

    >>> from mjcompose.tree.grammar import GRAMMAR
    >>> print(of_attribute(GRAMMAR.element('geom').attributes['friction']))
    sliding, spinning (m) and rolling (m) friction
    <BLANKLINE>
    1 to 3 numbers; 1 0.005 0.0001 if it is not set anywhere.
    """
    remarks = [_takes(attribute)]
    if attribute.required:
        remarks.append("it must be set")
    elif attribute.default is not None:
        remarks.append(f"{to_text(attribute, attribute.default)} if it is not set anywhere")
    return f"{attribute.doc}\n\n{'; '.join([*remarks, *attribute.versions()])}.".strip()


def _takes(attribute: Attribute) -> str:
    if attribute.refers_by is not None:
        return f"an element of the kind in `{attribute.refers_by}`, or its name"
    if attribute.refers is not None:
        what = {"default": "default class"}.get(attribute.refers, attribute.refers.removeprefix("attached:"))
        several = attribute.type == "references"
        return f"elements of the kind {what}, or their names" if several else f"a {what}, or its name"
    if attribute.type == "file":
        return "a file name, or an `Asset`"
    if attribute.type in ("keyword", "keywords"):
        shown = attribute.keywords[:SHOWN_KEYWORDS]
        words = ", ".join(f"'{word}'" for word in shown) + (", …" if len(shown) < len(attribute.keywords) else "")
        return words if attribute.type == "keyword" else f"some of {words}"
    if attribute.type == "bool":
        return "True or False"
    return expected(attribute)


def _of_child(kind: ElementType, child: ElementType) -> str:
    what = f"{child.doc}\n\n" if child.doc else ""
    if always_there(kind, child):
        return f"{what}An element that is always there."
    if child.max_count == 1:
        return f"{what}An element, or None if there is none: `add('{child.tag}', …)` makes it."
    return f"{what}The elements of this tag, in their order: `add('{child.tag}', …)` makes more."


def _attribute_property(attribute: Attribute) -> property:
    def write(element: Any, value: object = None) -> None:
        element._write({attribute.name: value})

    return property(lambda element: element._read(attribute), write, write, of_attribute(attribute))


def _child_property(tag: str, doc: str) -> property:
    def refuse(element: Any, value: object = None) -> None:
        element._refuse_child(tag)

    return property(lambda element: element._children(tag), refuse, refuse, doc)

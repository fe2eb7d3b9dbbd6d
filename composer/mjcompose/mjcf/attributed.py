"""Access to a node through Python attributes: MJCF attributes can be read and set, children are found by tag."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.report import short_traceback
from mjcompose.mjcf import edit
from mjcompose.mjcf.asset import LiveArray, as_name, asset_of
from mjcompose.mjcf.errors import MjcfAttributeError, failure, no_attribute
from mjcompose.mjcf.model import ModelState, ReferencedNode
from mjcompose.mjcf.value import BadValue, decode, describe, is_reference, resolved
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text
from mjcompose.tree.names import own_name
from mjcompose.tree.select import HOLDS_ONE_OF_EACH, ROOT, attribute_of, kind_of, naming_attribute, spoken
from mjcompose.tree.values import SHOWN_KEYWORDS, expected


class ViewClasses(Struct):
    """The classes for views of elements, of roots, of attachment frames, and of lists of elements."""

    element: type[Any]
    root: type[Any]
    frame: type[Any]
    several: type[Any]


_CLASSES: list[ViewClasses] = []


def register(classes: ViewClasses) -> None:
    """Set the classes of views. It is called once, when `mjcompose.mjcf` is imported."""
    _CLASSES[:] = [classes]


def view(model: ModelState, node: Node) -> Any:
    """Return the only Element of a node, and create it on first access."""
    found = model.views.get(node)
    return model.views.setdefault(node, _class_for(model, node)._of(model, node)) if found is None else found


def views(model: ModelState, tag: str, nodes: Iterable[Node]) -> Any:
    """Return the Elements of nodes with the same tag as an `ElementList`."""
    return _CLASSES[0].several(tag, model, nodes)


def _class_for(model: ModelState, node: Node) -> Any:
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
    children = {spoken(tag): _child_property(tag, _of_child(kind, child)) for tag, child in kind.children.items()}
    attributes = {spoken(name): _attribute_property(each) for name, each in kind.attributes.items()}
    own = {name: each for name, each in (children | attributes).items() if name not in taken}
    return {**own, "__doc__": of_element(kind)}


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


class Attributed:
    """A view of one node of a model; see `Element`."""

    __slots__ = ("_model", "_node", "_removed")
    _model: ModelState
    _node: Node
    _removed: bool

    def __init__(self, model: ModelState, node: Node) -> None:
        """For internal use. To get an Element, call `add`, `find` or a similar method."""
        _set_model(self, model)
        _set_node(self, node)
        _set_removed(self, False)

    @classmethod
    def _of(cls, model: ModelState, node: Node) -> Self:
        made = cls.__new__(cls)
        Attributed.__init__(made, model, node)
        return made

    @property
    def tag(self) -> str:
        """The MJCF tag, for example `geom`."""
        return str(self._node.tag)

    def get(self, attribute: str, default: Any = None) -> Any:
        """Return the value of an attribute, or `default` if it is not set or does not exist for this tag.

        >>> from mjcompose import mjcf
        >>> arm = mjcf.RootElement().worldbody.add('body', name='arm', pos=[0, 0, 1])
        >>> arm.get('pos'), arm.get('quat'), arm.get('mass', 'bodies have none')
        (array([0., 0., 1.]), None, 'bodies have none')
        """
        known = attribute_of(self._kind, as_name("attribute", attribute))
        value = None if known is None else self._read(known)
        return default if value is None else value

    def get_attributes(self) -> dict[str, Any]:
        """Return the values of all attributes that are set, by their Python names.

        >>> from mjcompose import mjcf
        >>> mjcf.RootElement().worldbody.add('geom', name='ball', size=[1]).get_attributes()
        {'name': 'ball', 'size': array([1.])}
        """
        known = self._kind.attributes
        return {spoken(str(name)): self._read(known[str(name)]) for name in self._node.keys()}  # noqa: SIM118

    @short_traceback
    def set_attributes(self, **attributes: object) -> None:
        """Set several attributes at once. If one value is invalid, raise `MjcfError` and change nothing.

        >>> from mjcompose import mjcf
        >>> ball = mjcf.RootElement().worldbody.add('geom', size=[1])
        >>> ball.set_attributes(name='ball', size=[2], rgba=[1, 0, 0, 1])
        >>> ball
        <geom size="2" name="ball" rgba="1 0 0 1"/>
        """
        self._write(attributes)

    def origin_of(self, attribute: str) -> Span:
        """Return where an attribute was set: its place in a file, or the line of the program that set it.

        Raises `MjcfError` if the attribute does not exist for this tag, or is not set.

        >>> from mjcompose import mjcf
        >>> ball = mjcf.from_xml_string('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>').find('geom')
        >>> ball.origin_of('size').column
        32
        """
        known = attribute_of(self._kind, as_name("attribute", attribute))
        if known is None:
            raise no_attribute(self._kind, attribute)
        if self._alive()._node.get(known.name) is None:
            raise failure("unknown-attribute", f"`{attribute}` of {self._described()} is not set")
        return self._model.span(self._node, known.name)

    def _read(self, attribute: Attribute) -> Any:
        if attribute.declares:
            return own_name(self._node, attribute.name)
        text = self._alive()._node.get(attribute.name)
        if text is None or (not text.strip() and attribute.type != "string"):
            return None
        if is_reference(attribute):
            targets = resolved(self._model, attribute, self._node, text=str(text))
            found = [each if isinstance(each, str) else view(*each) for each in targets]
            return found if attribute.type == "references" else found[0]
        if attribute.type == "file":
            return asset_of(self._model, self.tag, str(text))
        try:
            value = decode(attribute, str(text))
        except BadValue as fault:
            span = self._model.span(self._node, attribute.name)
            raise failure("wrong-type", f"`{attribute.name}` of {self._described()} {fault}", span) from None
        return LiveArray.of(value, self, attribute.name) if type(value) is np.ndarray else value

    def _write(self, attributes: Mapping[str, object]) -> None:
        self._alive()
        checked = edit.check(self._model, self._kind, targets(attributes), self._node)
        edit.write(self._model, self._node, checked)

    def _member(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        attribute = attribute_of(self._kind, name)
        if attribute is not None:
            return self._read(attribute)
        tag = name.rstrip("_")
        if tag not in self._kind.children:
            raise no_attribute(self._kind, name, [each for each in dir(type(self)) if each[0] != "_"])
        return self._children(tag)

    def _children(self, tag: str) -> Any:
        child = self._kind.children[tag]
        self._alive()
        if always_there(self._kind, child):
            at_top = self._kind.tag == "mujoco"
            node = self._model.section(tag) if at_top else self._model.only_child(self._node, tag)
            return view(self._model, node)
        if child.max_count != 1:
            return views(self._model, tag, self._node.iterchildren(tag))
        found = next(self._node.iterchildren(tag), None)
        return None if found is None else view(self._model, found)

    def _set_member(self, name: str, value: object) -> None:
        member = getattr(type(self), name, None)
        if isinstance(member, property):
            if member.fset is None:
                help = f"`set_attributes({name}=…)` sets the attribute of that name, `get('{name}')` reads it"
                hidden = attribute_of(self._kind, name) is not None
                message = f"`{name}` of {self._described()} cannot be set"
                raise failure("wrong-type", message, help=help if hidden else None, kind=MjcfAttributeError)
            object.__setattr__(self, name, value)
        elif name.rstrip("_") in self._kind.children and attribute_of(self._kind, name) is None:
            self._refuse_child(name)
        else:
            self._write({name: value})

    def _refuse_child(self, name: str) -> None:
        message = f"`{name}` of {self._described()} is an element and cannot be set"
        raise failure("wrong-type", message, help=f"set its attributes, or add one: `add('{name.rstrip('_')}', …)`")

    if not TYPE_CHECKING:  # a checker knows the names of each kind of element: see `elements.pyi`
        __getattr__ = _member
        __setattr__ = _set_member

    def __delattr__(self, name: str) -> None:
        setattr(self, name, None)

    def _own_name(self) -> str | None:
        attribute = naming_attribute(self._kind)
        return None if attribute is None else own_name(self._node, attribute.name)

    @property
    def _kind(self) -> ElementType:
        return kind_of(self._node)

    def _take_out(self) -> None:
        object.__setattr__(self, "_removed", True)

    def _described(self) -> str:
        return describe(self._model, self._node)

    def _alive(self) -> Self:
        if self._removed:
            raise failure("unknown-element", f"`<{self.tag}>` was removed from its model")
        return self


# Setting an attribute of an Element writes MJCF; these write its own slots.
_set_model, _set_node, _set_removed = (vars(Attributed)[slot].__set__ for slot in Attributed.__slots__)


def targets(attributes: Mapping[str, object]) -> dict[str, object]:
    """Return the attributes with each Element replaced by its model and node."""
    return {name: _target(value) for name, value in attributes.items()}


def _target(value: object) -> object:
    if isinstance(value, Attributed):
        return ReferencedNode(value._model, value._node)
    if isinstance(value, list | tuple) and any(isinstance(each, Attributed) for each in value):
        return [_target(each) for each in value]
    return value

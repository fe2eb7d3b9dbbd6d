"""What default classes give, written onto the elements themselves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.mjcf.element import Element, checked
from composer.mjcf.model import Model
from composer.mjcf.mounting import childclass_at
from composer.tree.classes import ORIENTATIONS, Classes, DefaultClass, childclass_of, default_tag
from composer.tree.kinds import ROOT, kind_of

_ACTUATORS = frozenset(GRAMMAR.section("actuator").children)
# What actuators of every tag have, and MuJoCo keeps in one place for all: it comes from classes for any of them.
_OF_ALL_ACTUATORS = frozenset(
    name
    for name in GRAMMAR.element("actuator/motor").attributes
    if name != "class"
    and all(name in GRAMMAR.element(f"actuator/{tag}").attributes for tag in ("general", "position"))
)
_SECTIONS_OF_NO_ELEMENTS = ("default", "extension")


def commit_defaults(root_or_element: Element) -> None:
    """Write onto an element and all below it, attached models included, what their default classes give.

    The classes stay, and so does the compiled model. A list that is written shorter than its class has it
    is completed, as MuJoCo does; an orientation is left as it is where there is one. The gains of an actuator
    whose class speaks of those of another tag are left to the class: what MuJoCo makes of both together cannot
    be written.

    >>> from composer import mjcf
    >>> model = mjcf.from_xml_string('<mujoco><default><geom rgba="1 0 0 1" friction="1 0.1"/></default>'
    ...                              '<worldbody><geom name="g" size="1" friction="0.5"/></worldbody></mujoco>')
    >>> mjcf.commit_defaults(model)
    >>> model.find('geom', 'g')
    <geom name="g" size="1" friction="0.5 0.1" rgba="1 0 0 1"/>
    """
    element = checked(root_or_element)
    model, node = element._model, element._node
    above = model.frame_above(node)
    if above is None:
        _commit_below(model, node)
    else:
        _commit_joints(model, node)
    for attachment in model.attachments.values():
        inside = attachment.frame is above or node in (attachment.host, *attachment.host.iterancestors())
        if inside:
            from composer.mjcf.root import _root_of

            if above is None:
                _commit_joints(model, attachment.frame)
            if above is None or above is node:
                commit_defaults(_root_of(attachment.child))


def _commit_below(model: Model, top: Node) -> None:
    classes = Classes(model.unit.root)
    for node in _elements(top):
        found = str(node.get("class") or "") or (childclass_of(node) if _in_tree(node) else None)
        _commit(model, node, classes.get(found))


def _commit_joints(model: Model, top: Node) -> None:
    """The joints of an attachment frame have the class in force where it hangs."""
    classes = Classes(model.unit.root)
    for node in top.iter("joint"):
        frame = model.frame_above(node)
        assert frame is not None
        found = str(node.get("class") or "") or childclass_at(model.attachment_of(frame).host)
        _commit(model, node, classes.get(found))


def _elements(top: Node) -> Iterator[Node]:
    """Everything that default classes can say something of."""
    tags = frozenset(GRAMMAR.section("default").children) | {"fixed", "spatial"}
    sections = top.iterchildren("*") if top.tag == ROOT else [top]
    for section in sections:
        if section.tag in _SECTIONS_OF_NO_ELEMENTS or _is_in(section, _SECTIONS_OF_NO_ELEMENTS):
            continue
        for node in section.iter("*"):
            parent = node.getparent()
            written = kind_of(node) if parent is not None else None
            if written is not None and "class" in written.attributes and default_tag(node) in tags:
                yield node


def _commit(model: Model, node: Node, found: DefaultClass) -> None:
    tag = default_tag(node)
    attributes = kind_of(node).attributes
    actuator = tag in _ACTUATORS
    given = (_given_to_actuator if actuator else _given)(found, tag, attributes)
    turned = any(node.get(name) for name in ORIENTATIONS)
    orientation = None if turned else found.orientation(tag)
    changes: dict[str, str] = {}
    for name, value in given.items():
        if name in ORIENTATIONS and (orientation is None or name != orientation[0]):
            continue
        own = str(node.get(name) or "")
        whole = _completed(attributes[name], own, value)
        if whole != own:
            changes[name] = whole
    if changes:
        model.forget(node)
        for name, value in changes.items():
            node.set(name, value)
        model.note(node)


def _given(
    found: DefaultClass, tag: str, attributes: Mapping[str, Attribute], *others: str
) -> dict[str, str]:
    """Every attribute that a class and those above it give by elements of these tags; the nearest counts."""
    inherited = {} if found.parent is None else _given(found.parent, tag, attributes, *others)
    for element in _written(found, (tag, *others)):
        for key, value in element.items():
            name = str(key)
            if name in attributes and name != "class" and str(value).strip():
                inherited[name] = _completed(attributes[name], str(value), inherited.get(name, ""))
    return inherited


def _given_to_actuator(found: DefaultClass, tag: str, attributes: Mapping[str, Attribute]) -> dict[str, str]:
    """The same for an actuator: what a class says of its gains counts where nothing is said of another tag's."""
    of_all = {name: each for name, each in attributes.items() if name in _OF_ALL_ACTUATORS}
    given = _given(found, tag, of_all, *sorted(_ACTUATORS - {tag}))
    if not any(_shapes(found, other) for other in _ACTUATORS - {tag}):
        given = {**_given(found, tag, attributes), **given}
    return given


def _shapes(found: DefaultClass, tag: str) -> bool:
    """Whether a class says what an actuator does; every tag but `general` says it by itself."""
    here: DefaultClass | None = found
    while here is not None:
        for element in here.elements.get(tag, ()):
            if tag != "general" or any(str(name) not in _OF_ALL_ACTUATORS for name in element.keys()):  # noqa: SIM118
                return True
        here = here.parent
    return False


def _written(found: DefaultClass, tags: tuple[str, ...]) -> list[Node]:
    """The elements of one class that are of these tags, as they stand."""
    elements = [element for tag in tags for element in found.elements.get(tag, ())]
    if len(tags) > 1 and len(elements) > 1:
        elements.sort(key=_place)
    return elements


def _place(node: Node) -> list[int]:
    """Where a node stands in its document, to be compared."""
    parent = node.getparent()
    return [] if parent is None else [*_place(parent), parent.index(node)]


def _completed(attribute: Attribute, own: str, inherited: str) -> str:
    """A value with the end of the inherited one where it is shorter and its length is bounded."""
    if not own.strip():
        return inherited
    if not attribute.is_number or attribute.max_length in (None, 1):
        return own
    items, more = own.split(), inherited.split()
    return own if len(items) >= len(more) else " ".join([*items, *more[len(items) :]])


def _in_tree(node: Node) -> bool:
    return _is_in(node, ("worldbody",))


def _is_in(node: Node, sections: tuple[str, ...]) -> bool:
    return any(above.tag in sections for above in node.iterancestors())

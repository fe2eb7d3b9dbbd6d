"""Write the values of default classes onto elements."""

from __future__ import annotations

import copy
from collections.abc import Collection, Iterator, Mapping

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import call_site, warn
from mjcompose.base.suggest import did_you_mean
from mjcompose.mjcf.asset import as_name, wrong_argument
from mjcompose.mjcf.attributed import class_of
from mjcompose.mjcf.compile import settings
from mjcompose.mjcf.element import Element
from mjcompose.mjcf.errors import MjcfWarning, failure
from mjcompose.mjcf.model import ModelState
from mjcompose.mjcf.mounting import childclass_at
from mjcompose.mjcf.node_view import checked
from mjcompose.mjcf.value import describe
from mjcompose.tree.classes import MAIN, ORIENTATIONS, Classes, DefaultClass, childclass_of, default_tag, position
from mjcompose.tree.edit import assign
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.select import ROOT, attribute_of, kind_of, spoken

ACTUATORS = frozenset(GRAMMAR.section("actuator").children)
_GENERAL = "general"
# Settings that actuators of every tag share, and that MuJoCo keeps in one place: classes for any of the tags set them.
OF_ALL = frozenset(
    name
    for name in GRAMMAR.element("actuator/motor").attributes
    if name != "class" and all(name in GRAMMAR.element(f"actuator/{tag}").attributes for tag in (_GENERAL, "position"))
)
# Tags of which MuJoCo takes every attribute that a class gives as if it were written on the element.
_PLAIN = frozenset({_GENERAL, "motor", "position", "velocity", "intvelocity", "adhesion"})


def is_plain(found: DefaultClass, node: Node) -> bool:
    """Return whether the attributes that a class sets for an actuator can be written onto it unchanged."""
    tag = str(node.tag)
    shared = OF_ALL & kind_of(node).attributes.keys()
    return all(
        tag in _PLAIN if each.tag == tag else each.tag == _GENERAL and shared.issuperset(map(str, each.keys()))
        for each in _written_elements(found)
    )


def commit(
    model: ModelState, node: Node, given: Mapping[str, str], found: DefaultClass, *, partly: bool = False
) -> None:
    """Write attributes onto an actuator so that MuJoCo reads the same actuator with and without its classes.

    `given` has the attributes from the classes that the actuator's own tag has. If these are not enough, the actuator
    becomes a `general`, which can express everything except a plugin, and an `MjcfWarning` is issued. If that is not
    enough either, the actuator still needs its class, and an `MjcfWarning` says so. With `partly`, only some of the
    attributes were requested: then the actuator keeps its tag and its class.
    """
    # The default sections of the class's model, or none if the class and those above set nothing.
    setting = next(_written_elements(found), None)
    root = None if setting is None else next(each for each in setting.iterancestors() if each.tag == ROOT)
    sections = [] if root is None else list(root.iterchildren("default"))
    spelled = copy.copy(node)
    spelled.attrib.pop("class", "")
    if found.name != MAIN:
        spelled.set("class", found.name)
    wanted = settings(sections, spelled)
    if wanted is None:  # MuJoCo says why when the model is compiled
        return
    as_good: Node | None = None
    name = str(spelled.get("class") or "")  # a `general` of the same class without any other attribute
    bare = settings(sections, spelled.makeelement(_GENERAL, {"class": name} if name else {})) or {}
    for candidate in _candidates(spelled, given, wanted, bare=bare, in_general=not partly):
        if settings(sections, candidate) != wanted:
            continue
        if partly:
            _replace_by(model, node, candidate)
            return
        as_good = candidate if as_good is None else as_good
        alone = copy.copy(candidate)
        alone.attrib.pop("class", "")
        if settings((), alone) == wanted:
            _replace_by(model, node, candidate)
            return
    if as_good is not None:
        _replace_by(model, node, as_good)
    message = f"{describe(model, node)} still needs its default class, which sets values that cannot be written"
    warn(message, MjcfWarning)


def _written_elements(found: DefaultClass) -> Iterator[Node]:
    return (each for here in found.line() for tag in ACTUATORS for each in here.elements.get(tag, ()))


def _candidates(
    node: Node, given: Mapping[str, str], wanted: Mapping[str, str], bare: Mapping[str, str], *, in_general: bool
) -> Iterator[Node]:
    """Yield the element with all attributes from its classes, with the attributes of all tags, and as a `general`."""
    for names in (given.keys(), given.keys() & OF_ALL):
        candidate = copy.copy(node)
        candidate.attrib.update({name: given[name] for name in sorted(names)})
        yield candidate
    if node.tag == "plugin" or not in_general:
        return
    general = copy.copy(node)
    general.tag = _GENERAL
    for name in set(general.keys()) - GRAMMAR.element(f"actuator/{_GENERAL}").attributes.keys():
        del general.attrib[name]
    plain = settings((), node.makeelement(_GENERAL)) or {}
    for name, text in wanted.items():
        if text and not text == bare.get(name) == plain.get(name):
            general.set(name, text)
        elif name in general.attrib:
            del general.attrib[name]
    yield general


def _replace_by(model: ModelState, node: Node, other: Node) -> None:
    """Give an element the tag and attributes of another one. Existing references to its Element stay valid."""
    model.forget(node)
    if node.tag != other.tag:
        why = f"its default class sets values that a `{node.tag}` cannot have"
        warn(f"{describe(model, node)} is written as a `{other.tag}`: {why}", MjcfWarning)
        node.tag = other.tag
        view = model.views.get(node)
        if view is not None:
            object.__setattr__(view, "__class__", class_of(kind_of(node)))
    for name in set(node.keys()) - set(other.keys()) - {"class"}:
        del node.attrib[name]
    node.attrib.update({name: value for name, value in other.items() if name != "class"})
    model.note(node)


_OF_ATTRIBUTE = "rgb"


def commit_textures(model: ModelState, node: Node, found: DefaultClass) -> None:
    """Write onto a material the textures of its class for the roles that the material itself does not set."""
    own = _by_role(node)
    given: dict[str, str] = {}
    for here in reversed(list(found.line())):
        for element in here.elements.get("material", ()):
            given |= _by_role(element)
    missing = {role: name for role, name in given.items() if role not in own and name}
    if not missing:
        return
    if not own and missing.keys() == {_OF_ATTRIBUTE}:
        assign(model, node, {"texture": missing[_OF_ATTRIBUTE]})
        return
    if node.get("texture") is not None:  # MuJoCo takes the attribute, or layers
        missing = {_OF_ATTRIBUTE: own[_OF_ATTRIBUTE], **missing}
        assign(model, node, {"texture": None})
    for role, name in missing.items():
        layer = node.makeelement("layer", {"role": role, "texture": name})
        node.append(layer)
        model.unit.origins.own(layer, call_site())
        model.note(layer)


def _by_role(node: Node) -> dict[str, str]:
    named = node.get("texture")  # an empty one takes back the class's texture
    attribute = {} if named is None else {_OF_ATTRIBUTE: str(named)}
    layers = {str(layer.get("role")): str(layer.get("texture")) for layer in node.iterchildren("layer")}
    return {**attribute, **layers}


_NEVER_GIVEN = frozenset({"class", "texture"})  # textures are a matter of several elements
# Attributes of which the nearest that is written counts alone.
_ONE_OF = (frozenset(ORIENTATIONS), frozenset({"type", "directional"}), frozenset({"kv", "dampratio"}))
_TEXTS = frozenset({"reference", "references", "file", "string"})
# A single number stands for both.
_NEVER_COMPLETED = frozenset({"springlength"})


def commit_defaults(root_or_element: Element, attributes: Collection[str] | None = None) -> None:
    """Write the values of default classes onto an element and everything below it, including attached models.

    With `attributes`, write only these, given by their Python names; elements without such an attribute are skipped.
    Raises `MjcfError` for an attribute that no element has.

    The classes stay in the model, and the compiled model stays the same. A list that is shorter than its class's list
    is completed, as MuJoCo does; an orientation that is set stays as it is. If the class of an actuator has settings
    for actuators with another tag, the actuator gets the combination that MuJoCo makes of both. If its tag cannot
    express this, it becomes a `general`, and an `MjcfWarning` is issued. MuJoCo is imported for such actuators.

    >>> from mjcompose import mjcf
    >>> model = mjcf.from_xml_string('<mujoco><default><geom rgba="1 0 0 1" friction="1 0.1"/></default>'
    ...                              '<worldbody><geom name="g" size="1" friction="0.5"/></worldbody></mujoco>')
    >>> mjcf.commit_defaults(model)
    >>> model.find('geom', 'g')
    <geom name="g" size="1" friction="0.5 0.1" rgba="1 0 0 1"/>
    """
    top = checked(root_or_element)
    _commit_all(top._model, top._node, None if attributes is None else _known(attributes))


def _known(attributes: Collection[str]) -> frozenset[str]:
    """Return the MJCF names of attributes. Raises `MjcfError` for a name that no default class can set."""
    if isinstance(attributes, str):
        raise wrong_argument("attributes", "a list of names", attributes)
    kinds = GRAMMAR.section("default").children.values()
    found = set()
    for name in attributes:
        known = next(filter(None, (attribute_of(kind, as_name("attributes", name)) for kind in kinds)), None)
        if known is None:
            every = sorted({spoken(each) for kind in kinds for each in kind.attributes})
            message = f"default classes give no element an attribute `{name}`"
            raise failure("unknown-attribute", message, help=did_you_mean(name, every))
        found.add(known.name)
    return frozenset(found)


def _commit_all(model: ModelState, node: Node, only: frozenset[str] | None) -> None:
    above = model.frame_above(node)
    if above is None:
        classes = Classes(model.unit.root)
        for each in _elements_below(node):
            name = str(each.get("class") or "") or (childclass_of(each) if _is_in(each, "worldbody") else None)
            _commit(model, each, _class(model, classes, name), only=only)
    else:
        _commit_joints(model, node, only)
    for attachment in model.attachments.values():
        if attachment.frame is above or node in (attachment.host, *attachment.host.iterancestors()):
            if above is None:
                _commit_joints(model, attachment.frame, only)
            if above is None or above is node:
                _commit_all(attachment.child, attachment.child.unit.root, only)


def _commit_joints(model: ModelState, top: Node, only: frozenset[str] | None) -> None:
    """Write the defaults onto the joints of an attachment frame, which take the class in force at its host."""
    classes = Classes(model.unit.root)
    for node in top.iter("joint"):
        frame = model.frame_above(node)
        assert frame is not None
        name = str(node.get("class") or "") or childclass_at(model.attachment_of(frame).host)
        _commit(model, node, _class(model, classes, name), only=only)


def _class(model: ModelState, classes: Classes, name: str | None) -> DefaultClass:
    """Return the class with this name, which may belong to an attached model."""
    if name is not None and name not in classes.by_name:
        found = model.lookup("default", name)
        if found is not None and found.model is not model:
            return Classes(found.model.unit.root).get(str(found.node.get("class") or "") or None)
    return classes.get(name)


def _elements_below(top: Node) -> Iterator[Node]:
    """Yield every element that default classes can set attributes of."""
    tags = frozenset(GRAMMAR.section("default").children) | {"fixed", "spatial"}
    sections = top.iterchildren("*") if top.tag == ROOT else [top]
    for section in sections:
        if section.tag in ("default", "extension") or _is_in(section, "default", "extension"):
            continue
        for node in section.iter("*"):
            if node.getparent() is not None and "class" in kind_of(node).attributes and default_tag(node) in tags:
                yield node


def _commit(model: ModelState, node: Node, found: DefaultClass, only: frozenset[str] | None) -> None:
    if node.tag == "material" and (only is None or "texture" in only):
        commit_textures(model, node, found)
    changes = _changes(node, found)
    if node.tag == "camera":
        _choose_field_of_view(node, changes)
    if only is not None:
        changes = {name: value for name, value in changes.items() if name in only}
    if default_tag(node) in ACTUATORS and not is_plain(found, node):
        given = {name: value for name, value in changes.items() if value is not None}
        commit(model, node, given, found=found, partly=only is not None)
    elif changes:
        assign(model, node, changes)


def _changes(node: Node, found: DefaultClass) -> dict[str, str | None]:
    """Return the attributes of an element that a class sets or completes."""
    attributes = kind_of(node).attributes
    changes: dict[str, str | None] = {}
    for name, value in _class_attributes(found, node, attributes).items():
        own = str(node.get(name) or "")
        if own:
            whole = _completed(attributes[name], own, value)
        elif _is_settled(node, attributes[name]):
            continue
        else:
            whole = value
        if whole != own:
            changes[name] = whole
    return changes


def _is_settled(node: Node, attribute: Attribute) -> bool:
    """Return whether an element takes no value of a class for an attribute, although it has no text for it."""
    if _counts_empty(attribute) and node.get(attribute.name) is not None:
        return True
    if attribute.name == "cranklength" and not node.get("cranksite"):
        return True
    # The element may set another attribute that has the same meaning.
    return any(attribute.name in group and any(node.get(name) for name in group) for group in _ONE_OF)


def _choose_field_of_view(node: Node, changes: dict[str, str | None]) -> None:
    """Remove the `fovy` of a camera with a `sensorsize`."""
    # MuJoCo takes one of the two, and looks at the other only where this does not exist.
    if changes.get("sensorsize") or node.get("sensorsize"):
        changes.pop("fovy", None)
        if node.get("fovy"):
            changes["fovy"] = None


def _class_attributes(found: DefaultClass, node: Node, attributes: Mapping[str, Attribute]) -> dict[str, str]:
    """Return the attributes that a class and the classes above it set for an element; the nearest class wins."""
    inherited = {} if found.parent is None else _class_attributes(found.parent, node, attributes)
    tag = default_tag(node)
    # MuJoCo (3.12 to 4.0) keeps one default for all actuators of a class: a `position` in it also changes a `motor`.
    tags = ACTUATORS if tag in ACTUATORS else (tag,)
    elements = [element for name in tags for element in found.elements.get(name, ())]
    in_order = sorted(elements, key=position) if len(elements) > 1 else elements
    for element in in_order:
        for name, value in _given_by(element, tag, attributes):
            for group in _ONE_OF:
                if name in group:
                    for other in group - {name}:
                        inherited.pop(other, None)
            inherited[name] = _completed(attributes[name], value, inherited.get(name, ""))
    return inherited


def _given_by(element: Node, tag: str, attributes: Mapping[str, Attribute]) -> Iterator[tuple[str, str]]:
    """Yield the attributes that an element of a class gives to the elements with a tag."""
    for key, text in element.items():
        name = str(key)
        value = str(text)
        if name not in attributes or name in _NEVER_GIVEN or (element.tag != tag and name not in OF_ALL):
            continue
        if value.strip() or _counts_empty(attributes[name]):
            yield name, value


def _counts_empty(attribute: Attribute) -> bool:
    """Return whether an empty text is a value of its own, which overrides the value of a class above."""
    return attribute.type in _TEXTS


def _completed(attribute: Attribute, own: str, inherited: str) -> str:
    """Return a value; if it is shorter than the inherited one and its length is bounded, append the missing items."""
    if not own.strip():
        return "" if _counts_empty(attribute) else inherited
    if not attribute.is_number or attribute.max_length in (None, 1) or attribute.name in _NEVER_COMPLETED:
        return own
    items = own.split()
    more = inherited.split()
    return own if len(items) >= len(more) else " ".join([*items, *more[len(items) :]])


def _is_in(node: Node, *sections: str) -> bool:
    return next(node.iterancestors(*sections), None) is not None

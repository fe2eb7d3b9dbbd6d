"""Checks of the recipe's own elements against the whole model."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note, Span
from mjcompose.base.sink import Sink
from mjcompose.base.words import element_text
from mjcompose.compose.elements import ElementBuilder, WrittenReference
from mjcompose.compose.lengths import why_a_length
from mjcompose.language.value import is_angular, no_angle
from mjcompose.link import numbers
from mjcompose.link.inertia import MEASURED, has_mass
from mjcompose.link.key_layout import joint_type
from mjcompose.link.linking import Linking, Part
from mjcompose.link.unit_keys import keys_of
from mjcompose.plan.plan import AttachPart
from mjcompose.text.node import locate
from mjcompose.tree import journal
from mjcompose.tree.classes import MAIN, NESTED, childclass_of, own, written
from mjcompose.tree.edit import resolves, unresolved
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.journal import because
from mjcompose.tree.names import DECLARES, naming_table, own_references, word
from mjcompose.tree.select import name_of

_TOP_CLASS = because("`main` is called that here: the top class of the base")


def check_class_angles(linking: Linking, making: ElementBuilder) -> None:
    """Report the first joint that reads an angle of a class as a length, or a length as an angle.

    MuJoCo 4.0 compiles `range="0 90"` of a class to 0 1.5708 for hinges, and to 0 90 for slides.
    """
    for giver, element, name, angular in making.of_classes:
        attribute = GRAMMAR.element("joint").attributes[name]
        for joint in _joints_affected_by(giver, name, linking):
            kind = joint_type(joint, linking.base.classes)
            if is_angular(attribute, kind) != angular:
                called = name_of(joint)
                which = element_text(kind, called, definite=True)
                own, other = ("an angle", "a length") if angular else ("a length", "an angle")
                message = f"`{name}` of a class is {own}, and {which} would take it for {other}"
                notes = (Note(f"{which} is written here", linking.span(linking.base, joint)),)
                help = f"write `{name}` on the joints, or use one class for each kind"
                span = making.span(element, name)
                making.sink.error("bare-angle", message, span, notes=notes, help=help, subjects=(called,))
                break
    making.of_classes.clear()


def check_angles_of_targets(linking: Linking, making: ElementBuilder) -> None:
    """Report angles of elements that have none: controls and readings of slides and spatial tendons are lengths."""
    for node, attribute, angle, span in making.of_targets:
        if (why := why_a_length(node, linking)) is not None:
            name = name_of(node)
            called = f"{node.tag} `{name}`" if name else f"a `{node.tag}`"
            fault = no_angle(f"`{attribute.name}` of {called}, {why},", angle, ())
            making.refuse_angle(fault, span)
    making.of_targets.clear()


def _joints_affected_by(giver: Node, name: str, linking: Linking) -> Iterator[Node]:
    """Yield the joints of bodies that take an attribute from the element of a class."""
    classes = linking.base.classes
    for worldbody in linking.base.root.iterchildren("worldbody"):
        for joint in worldbody.iter("joint"):
            parent = joint.getparent()
            if parent is None or parent.tag not in NESTED or written(joint, name) is not None:
                continue
            found = classes.get(str(joint.get("class") or childclass_of(joint) or "")).lookup("joint", name)
            if found is not None and found[1] is giver:
                yield joint


def check_intervals(making: ElementBuilder) -> None:
    """Report ranges of the recipe that end before they begin, after all edits. Two zeros mean no range."""
    for (node, attribute), span in making.intervals.items():
        ends = numbers.read(str(node.get(attribute) or ""))
        # MuJoCo 4.0 compiles `<joint range="1 0"/>` to a joint without limits, and refuses it with `limited="true"`.
        if len(ends) != 2 or ends[0] < ends[1] or not any(ends):
            continue
        name = name_of(node)
        message = "has its ends in the wrong order"
        help = "write the lower end first"
        if ends[0] == ends[1]:
            message = "has two equal ends"
            help = "write two different numbers, or `[0, 0]` for no range"
        message = f"`{attribute}` of {f'{node.tag} `{name}`' if name else f'a `{node.tag}`'} {message}"
        notes = (Note("MuJoCo ignores such a range, or rejects the model"),)
        making.sink.error("out-of-range", message, span, notes=notes, help=help, subjects=(name,))
    making.intervals.clear()


# Elements that MuJoCo expands may bring mass.
_OPAQUE = ("attach", "composite", "flexcomp")
_TOO_LITTLE = 1e-15  # mjMINVAL
_SHOWN = 3
_RULES = (*MEASURED, "inertiafromgeom", "inertiagrouprange")


def check_mass(step: AttachPart, part: Part, linking: Linking, making: ElementBuilder) -> None:
    """Report a joint whose body, and the bodies fixed to it, have no mass, unless only MuJoCo knows the mass."""
    settings = linking.base.settings
    default = SourceSettings()
    if not part.joints or any(getattr(settings, name) != getattr(default, name) for name in _RULES):
        return
    attachment = linking.attachments.get(part)
    body = None if attachment is None else attachment.content.getparent()
    if body is None or body.tag != "body":
        return
    fixed = list(_fixed(body))
    if any(_may_have_mass(each, linking) for each in fixed):
        return
    notes = list(_reasons(fixed, linking))[:_SHOWN]
    give = f"`add: [{{to: {part.prefix}, geom: {{type: sphere, size: [0.01], mass: 1}}}}]`"
    message = f"`joint` moves `{part.called}`, but nothing that is fixed to the joint has mass"
    span = locate(making.document, (*step.at, "joint"), key=True)
    help = f"give it mass, for example {give}, or leave `joint` out" if part.prefix else "give a body in it mass"
    making.sink.error("mujoco-rejects", message, span, notes=notes, help=help, subjects=(part.called,))


def _reasons(fixed: list[Node], linking: Linking) -> Iterator[Note]:
    """Yield notes on the bodies that lack mass, and on those with their own joint, whose mass does not count."""
    for body in fixed[1:]:
        inertial = next(iter(own(body, "inertial")), None)
        why = "has no mass" if inertial is None else "has no mass, or no inertia"
        yield Note(f"{_called(body)} {why}", linking.span(linking.base, body if inertial is None else inertial))
    for body in fixed:
        for child in own(body, "body"):
            for joint in own(child, "joint", "freejoint")[:1]:
                message = f"{_called(child)} moves by its own joint, so its mass does not count"
                yield Note(message, linking.span(linking.base, joint))


def _called(body: Node) -> str:
    return f"the body `{body.get('name')}`" if body.get("name") else "this body"


def _fixed(body: Node) -> Iterator[Node]:
    """Yield the body, and the bodies below it that no joint moves relative to it."""
    yield body
    for child in own(body, "body"):
        # In MuJoCo 4.0 the mass of a child counts for the joint above it, unless the child has its own joint: then
        # "mass and inertia of moving bodies must be larger than mjMINVAL".
        if not own(child, "joint", "freejoint"):
            yield from _fixed(child)


def _may_have_mass(body: Node, linking: Linking) -> bool:
    if own(body, *_OPAQUE):
        return True
    if not (inertials := own(body, "inertial")):
        return any(has_mass(geom, linking.base.classes) for geom in own(body, "geom"))
    values = [number for name in ("mass", "diaginertia") for number in numbers.read(str(inertials[0].get(name) or ""))]
    return inertials[0].get("fullinertia") is not None or all(number >= _TOO_LITTLE for number in values)


def check_names(linking: Linking, making: ElementBuilder) -> None:
    """Declare every new name, then look up every reference; those to keys wait for `check_names_of_keys`."""
    references: list[WrittenReference] = []
    seen: dict[str, set[Node]] = {}
    for top, section in making.registered:
        for node in _unseen(top, seen.setdefault(section, set())):
            written = making.written(node)
            for name, (kind, namespace) in naming_table(section).get(str(node.tag), {}).items():
                if kind == DECLARES and name in written and (value := node.get(name)):
                    _declare(linking, making, node, name=name, namespace=namespace, value=str(value))
            references += [
                WrittenReference(node, *each) for each in own_references(node, section) if each[0] in written
            ]
    for each in references:
        if each.namespace == "key":
            making.of_keys.append(each)
        else:
            _look_up(linking, making, each)


def _unseen(top: Node, seen: set[Node]) -> Iterator[Node]:
    """Yield an element and all below it. Elements that were added to an added element were seen with that one."""
    if top in seen:
        return
    for node in top.iter("*"):
        if node not in seen:
            seen.add(node)
            yield node


def check_names_of_keys(linking: Linking, making: ElementBuilder) -> None:
    if making.of_keys:
        linking.names.declared["key"] = {str(key.get("name") or ""): key for key in keys_of(linking.base)}
    for each in making.of_keys:
        _look_up(linking, making, each)


def check_class(linking: Linking, sink: Sink, name: str, span: Span) -> None:
    """Report a default class that the recipe names by its final name and that does not exist."""
    if name != MAIN and linking.find_node("default", name) is None:
        sink.add(unresolved(linking, "default", name, span=span, written="class: {}"))


def refer_to_top_class(linking: Linking, node: Node, attribute: str) -> bool:
    """If the attribute names the class `main`, write its name in the model. Return whether it does."""
    if node.get(attribute) != MAIN:
        return False
    if linking.base_class is not None:
        journal.write(node, attribute, linking.base_class, _TOP_CLASS)
    return True


def _declare(linking: Linking, making: ElementBuilder, node: Node, name: str, namespace: str, value: str) -> None:
    earlier = linking.names.declared.setdefault(namespace, {}).setdefault(value, node)
    if earlier is not node and namespace != "key":
        code = "class-clash" if namespace == "default" else "name-clash"
        span = making.span_of(node, name)
        first = linking.span(linking.base, earlier, "name")
        message = f"the name `{value}` is taken by another {word(namespace)}"
        help = "choose another name"
        notes = [Note("it is declared here", first)]
        if span == first and span.turn is not None:
            message = f"`for` gives each {word(namespace)} the name `{value}`"
            help = f"put a value of the `for` into the name: `{value}_${{…}}`"
            notes = []
        making.sink.error(code, message, span, notes=notes, help=help, subjects=(value,))


def _look_up(linking: Linking, making: ElementBuilder, reference: WrittenReference) -> None:
    node, attribute, namespace, name, typed_by = reference
    if namespace == "default" and refer_to_top_class(linking, node, attribute):
        return
    if not resolves(linking, namespace, name):
        span = making.span_of(node, attribute)
        written = f"{attribute}: {{}}"
        making.sink.add(unresolved(linking, namespace, name, span=span, written=written, typed_by=typed_by))

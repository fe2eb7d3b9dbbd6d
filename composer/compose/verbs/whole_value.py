"""Write a whole value: `set` of an attribute without an index."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.compose.class_angles import check_class_angles
from composer.compose.edit_values import Unusable, Values
from composer.compose.edited_files import take_files
from composer.compose.editing import is_angular
from composer.compose.elements import settle_joints, update
from composer.compose.reference_check import refer_to_top_class
from composer.compose.refuse import refuse
from composer.grammar.attribute import Attribute
from composer.link import numbers
from composer.link.layout import joint_type
from composer.recipe.angles import bare_angle
from composer.recipe.element import Element, Value
from composer.recipe.fault import Fault, Path
from composer.recipe.value import read_value
from composer.tree.attributes import changing, replace
from composer.tree.classes import MAIN, ORIENTATIONS
from composer.tree.kinds import kind_of, section_of
from composer.tree.names import own_references
from composer.tree.references import resolves, unresolved


def set_whole(values: Values, attribute: Attribute, written: Any, at: Path) -> None:
    """Write the value onto the element, with all that follows: units, files, and references that must exist."""
    editing, node = values.editing, values.node
    read = _read(values, attribute, written, at=at)
    check_without_ends(values, attribute, at)
    element = Element(str(node.tag), {attribute.name: read}, at=at[:-1])
    making = editing.making
    making.made[node] = element
    with editing.writing(node, attribute):
        if attribute.name in ORIENTATIONS or attribute.name == "fromto":
            # MuJoCo 4.0 takes one orientation ("multiple orientation specifiers are not allowed"), so that the one
            # before has to go.
            replace(node, dict.fromkeys(ORIENTATIONS))
        update(node, element, kind_of(node), making=making)
        settle_joints(making, lambda each: joint_type(each, editing.classes))
    check_class_angles(editing.linking, making)
    take_files(editing)
    if attribute.is_reference or attribute.refers_by is not None:
        _check_references(values, attribute, at)


def _read(values: Values, attribute: Attribute, written: Any, at: Path) -> Value:
    """Return the written value as the attribute takes it. Report its first fault."""
    editing, node = values.editing, values.node
    given = values.of(written, at, values.now(attribute))
    faults: list[Fault] = []
    read = read_value(attribute, given, at, owner=editing.called(node), faults=faults)
    if read is not None and attribute.angle is not None and editing.making.angle_context.at(at).angle is None:
        joint = joint_type(node, editing.classes) if attribute.angle == "joint" else None
        bare = bare_angle(attribute, read, joint, at=at, owner=editing.called(node))
        faults += [bare] if bare is not None else []
    if faults:
        refuse(editing, node, faults[0])
    assert read is not None
    return read


def check_units(values: Values, wanted: str, written: Mapping[str, Any], at: Path) -> None:
    """Report numbers of a joint that its new type, `wanted`, turns from lengths into angles or back.

    Only those: what is written beside the type is meant for it.
    """
    editing, joint = values.editing, values.node
    now = joint_type(joint, editing.classes)
    for attribute in kind_of(joint).attributes.values():
        turns = is_angular(attribute, now)
        if turns == is_angular(attribute, wanted) or attribute.name in written:
            continue
        text = editing.effective(joint, attribute.name)
        if not text or not any(numbers.read(text)):
            continue
        was, would = ("an angle", "a length") if turns else ("a length", "an angle")
        message = (
            f"`{attribute.name}` of {editing.called(joint)} is {was}, and would be {would} for a {wanted}"
        )
        refuse(
            editing,
            joint,
            Fault("bare-angle", message, at, help=f"write `{attribute.name}` beside `type`"),
        )


def check_without_ends(values: Values, attribute: Attribute, at: Path) -> None:
    """Report a part of the pose that has no effect because `fromto` determines the element's pose."""
    if attribute.name not in ("pos", *ORIENTATIONS):
        return
    editing, node = values.editing, values.node
    # MuJoCo 4.0 passes over an `euler` beside `fromto` without a word, and refuses a `pos`.
    ends = editing.effective(node, "fromto")
    if ends and "nan" not in ends.lower():
        message = f"`{attribute.name}` of {editing.called(node)} has no effect: `fromto` says where it is"
        refuse(editing, node, Fault("wrong-type", message, at, help="set `fromto` instead"))


def _check_references(values: Values, attribute: Attribute, at: Path) -> None:
    """Report a reference to a name that does not exist."""
    editing, node = values.editing, values.node
    if attribute.refers == "default" and node.get(attribute.name) == MAIN:
        with changing(editing, node):
            refer_to_top_class(editing.linking, node, attribute.name)
        return
    for name, namespace, value, typed_by in own_references(node, section_of(node)):
        if name == attribute.name and not resolves(editing, namespace, value):
            span, written = editing.span(at), f"{name}: {{}}"
            editing.sink.add(
                unresolved(editing, namespace, value, span=span, written=written, typed_by=typed_by)
            )
            raise Unusable

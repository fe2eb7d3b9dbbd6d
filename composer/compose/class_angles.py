"""Numbers that the recipe gives to joints through a class. A converted number cannot serve both hinges and slides."""

from __future__ import annotations

from collections.abc import Iterator

from lxml.etree import _Element as Node

from composer.compose.editing import is_angular
from composer.compose.elements import ElementBuilder
from composer.diagnostics.diagnostic import Note
from composer.grammar import GRAMMAR
from composer.link.layout import joint_type
from composer.link.linking import Linking
from composer.recipe.element import Element
from composer.tree.classes import NESTED, childclass_of, written
from composer.tree.select import name_of


def check_class_angles(linking: Linking, making: ElementBuilder) -> None:
    """Report the first joint for which such a number means another thing than in the class that gives it.

    MuJoCo 4.0 makes 0 1.5708 of `range="0 90"` for the hinges of a class, and leaves it as it is for its slides: in a
    model in radians no number is right for both.
    """
    for giver, element, name, angular in making.of_classes:
        attribute = GRAMMAR.element("joint").attributes[name]
        for joint in _taking(giver, name, linking):
            if is_angular(attribute, joint_type(joint, linking.base.classes)) != angular:
                _report(linking, making, element, name=name, joint=joint, angular=angular)
                break
    making.of_classes.clear()


def _taking(giver: Node, name: str, linking: Linking) -> Iterator[Node]:
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


def _report(
    linking: Linking, making: ElementBuilder, element: Element, name: str, joint: Node, angular: bool
) -> None:
    kind, called = joint_type(joint, linking.base.classes), name_of(joint)
    which = f"the {kind} `{called}`" if called else f"a {kind} without a name"
    meant, other = ("an angle", "a length") if angular else ("a length", "an angle")
    making.sink.error(
        "bare-angle",
        f"`{name}` of a class is {meant}, and {which} would take it for {other}",
        making.span(element, name),
        notes=(Note(f"{which} is written here", linking.span(linking.base, joint)),),
        help=f"write `{name}` on the joints, or give the class to joints of one kind",
        subjects=(called,),
    )

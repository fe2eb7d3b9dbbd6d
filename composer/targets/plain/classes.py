"""Pass: write the values of classes onto the elements, and remove the classes."""

from __future__ import annotations

import copy

from lxml.etree import _Element as Node

from composer.tree.classes import Classes
from composer.tree.effective import chain, given, text_in_effect
from composer.tree.kinds import kind_of


def without_classes(root: Node) -> None:
    """Write all values that elements get from their classes, then remove the classes.

    >>> from lxml import etree
    >>> classes = '<default><geom friction=".5"/></default>'
    >>> root = etree.fromstring(f'<mujoco>{classes}<worldbody><geom size="1"/></worldbody></mujoco>')
    >>> without_classes(root)
    >>> etree.tostring(root)
    b'<mujoco><worldbody><geom size="1" friction=".5 0.005 0.0001"/></worldbody></mujoco>'
    """
    classes = Classes(root)
    found = []
    for section in root.iterchildren("*"):
        if section.tag != "default":
            for element in section.iter("*"):
                kind = kind_of(element)
                names = [attribute.name for attribute, _ in given(element, kind, classes)]
                if element.tag == "material":
                    _layers(element, classes)
                found.append(
                    (element, {name: text_in_effect(element, kind, name, classes=classes) for name in names})
                )
    for element, texts in found:
        for name, text in texts.items():
            if text is not None:
                element.set(name, _trimmed(text) if name in _POLYNOMIALS else text)
    for element in root.iter("*"):
        for name in ("class", "childclass") if element.tag != "default" else ():
            element.attrib.pop(name, "")
    for section in list(root.iterchildren("default")):
        root.remove(section)


_POLYNOMIALS = ("damping", "stiffness")
"""What older versions of MJCF, and what reads those, have one number for."""


def _trimmed(text: str) -> str:
    words = text.split()
    while len(words) > 1 and float(words[-1]) == 0:
        words.pop()
    return " ".join(words)


def _layers(material: Node, classes: Classes) -> None:
    """Write the textures of a material by their roles. Those of the class count if the material has none of its own."""
    if next(material.iterchildren("layer"), None) is not None:
        return
    for each in chain(material, classes):
        for writer in reversed(each.elements.get("material", [])):
            layers = list(writer.iterchildren("layer"))
            if layers:
                material.extend(copy.deepcopy(layers))
                return

"""Makes a random model one that MuJoCo compiles: what it complains of is taken out."""

from __future__ import annotations

import re

import mujoco
from hypothesis import reject
from lxml import etree
from lxml.etree import _Element as Node
from properties.elements import Maker

_LINE = re.compile(r"line (\d+)")
_ROUNDS = 60


def mended(root: Node, make: Maker) -> tuple[str, mujoco.MjModel]:
    """The text and what it compiles to; rejects the example where no end is seen."""
    for _ in range(_ROUNDS):
        text = etree.tostring(root, pretty_print=True).decode()
        try:
            model = mujoco.MjModel.from_xml_string(text)
        except ValueError as error:
            if not _take_out(root, text, str(error), make):
                reject()
        else:
            return text, model
    return reject()


def _take_out(root: Node, text: str, error: str, make: Maker) -> bool:
    """Optional attributes of the element go first, then the element; whether anything could be done."""
    found = _LINE.search(error)
    if found is None:
        return False
    line = int(found[1])
    elements = zip(root.iter("*"), etree.fromstring(text).iter("*"), strict=True)
    element = next((mine for mine, read in elements if read.sourceline == line), None)
    if element is None or element is root:
        return False
    optional = make.optional.pop(element, [])
    for name in optional:
        element.attrib.pop(name, None)
    if not optional:
        parent = element.getparent()
        assert parent is not None
        parent.remove(element)
    return True

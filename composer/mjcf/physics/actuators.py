"""Read all settings of an actuator as MuJoCo compiles them, whichever tag and classes they come from."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

from lxml import etree
from lxml.etree import _Element as Node

from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.grammar.format import to_text
from composer.mjcf.physics.compile import engine

_GENERAL = GRAMMAR.element("actuator/general").attributes
# The two that MuJoCo has by another word.
_FIELDS = {"input": "ctrlspec", "user": "userdata"}


def settings(default_sections: Iterable[Node], actuator: Node) -> Mapping[str, str] | None:
    """Return all settings of an actuator as texts by the attributes of `<general>`, or None if MuJoCo refuses it.

    An empty text stands for a setting that cannot be written because it has no value. A crank length is included only
    for a slider-crank, because MuJoCo lets classes set it for other actuators too. What the actuator acts on is not
    included.
    """
    mujoco = engine()
    root = etree.Element("mujoco")
    root.extend(copy.deepcopy(section) for section in default_sections)
    etree.SubElement(root, "actuator").append(copy.deepcopy(actuator))
    try:
        read = mujoco.MjSpec.from_string(etree.tostring(root, encoding="unicode")).actuators[0]
    except (ValueError, mujoco.FatalError):
        return None
    fields = {name: _FIELDS.get(name, name) for name in _GENERAL}
    if read.trntype.name != "mjTRN_SLIDERCRANK":
        del fields["cranklength"]
    return {
        name: _text(mujoco, _GENERAL[name], getattr(read, field), read)
        for name, field in fields.items()
        if field not in ("name", "refsite", "slidersite") and hasattr(read, field)
    }


def _text(mujoco: Any, attribute: Attribute, value: Any, read: Any) -> str:
    if attribute.name == "input":
        return _input(mujoco, int(value), read)
    if attribute.type == "keyword":
        kind = getattr(value, "name", None)  # `mjGAIN_FIXED`
        return attribute.keywords[value] if kind is None else str(kind).partition("_")[2].lower()
    if attribute.name == "user":
        value = list(value)
    return to_text(attribute, value)


def _input(mujoco: Any, signature: int, read: Any) -> str:
    """Return the text of `input`. MuJoCo keeps one bit for each input, or the form in which an orientation is given."""
    if not signature:
        return ""
    if read.gaintype.name == "mjGAIN_SO3":
        names = [each for each in mujoco.mjtCtrlChart.__members__.values() if each == signature]
    else:
        names = [each for each in mujoco.mjtCtrlInput.__members__.values() if each & signature]
    return " ".join(each.name.partition("_")[2].lower() for each in names)

"""Advice for values that are almost right, written as in XML, in Python or in a drawing."""

from __future__ import annotations

import math
import re
from collections.abc import Collection

from composer.dataclass import dataclass
from composer.diagnostics.fix import Fix
from composer.expr.angle import Angle
from composer.grammar.attribute import Attribute
from composer.grammar.element import ElementType
from composer.grammar.format import number_text
from composer.grammar.number import items, parse_real
from composer.recipe.shown import shown

_WORDS = {"yes": "true", "on": "true", "no": "false", "off": "false"}
_SWITCHES = {
    **dict.fromkeys(("true", "yes", "on", "enabled", "1"), "enable"),
    **dict.fromkeys(("false", "no", "off", "disabled", "0"), "disable"),
}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_WITH_UNIT = re.compile(rf"({_NUMBER})\s*([a-zA-Zµ]+)")
# How other tools write `${…}`.
_TEMPLATE = re.compile(r"\$?[{(]{1,2}\s*([A-Za-z_][^{}()]*)[})]{1,2}|\$(\w+)")
_PI = re.compile(rf"([-+])?(?:({_NUMBER})\s*\*\s*)?(?:np\.|math\.)?pi(?:\s*/\s*({_NUMBER}))?", re.IGNORECASE)
# The divisor of a number in that unit, and the unit that MJCF expects.
_UNITS = {
    "mm": (1e3, "metres"), "cm": (1e2, "metres"), "m": (1, "metres"),
    "us": (1e6, "seconds"), "µs": (1e6, "seconds"), "ms": (1e3, "seconds"), "s": (1, "seconds"),
    "g": (1e3, "kilograms"), "kg": (1, "kilograms"), "N": (1, "newtons"), "Nm": (1, "newton metres"),
}  # fmt: skip
_FORMS = {
    "pos": "[x, y, z]", "axis": "[x, y, z]", "zaxis": "[x, y, z]", "dir": "[x, y, z]", "anchor": "[x, y, z]",
    "gravity": "[x, y, z]", "quat": "[w, x, y, z]", "axisangle": "[x, y, z, angle]",
    "xyaxes": "[x, y, z, x, y, z], the x axis and then the y axis",
    "fromto": "[x, y, z, x, y, z], one end and then the other",
    "rgba": "[red, green, blue, opacity], each from 0 to 1",
    "range": "[lower, upper]", "ctrlrange": "[lower, upper]", "forcerange": "[lower, upper]",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Advice:
    """A help line, and the exact text that it recommends, if there is one."""

    help: str
    text: str | None = None

    @property
    def fix(self) -> Fix | None:
        return None if self.text is None else Fix(self.text)


def form_of(attribute: Attribute) -> str | None:
    """Return how the numbers of an attribute are written, for attributes that are often written wrongly."""
    form = _FORMS.get(attribute.name)
    count = len(form.split("]")[0].split(",")) if form else 0
    return form if attribute.type == "real" and attribute.max_length == count else None


def instead(attribute: Attribute, value: object) -> Advice | None:
    """Return what to write instead of a value, or None if that is not known.

    It knows `'0.5'`, `90 deg`, `45°`, `pi/2`, `10cm`, `yes` and the like.
    """
    word = shown(value)
    if attribute.type == "bool" or "true" in attribute.keywords:
        # YAML 1.1 reads `yes` and `on` as booleans; YAML 1.2 has only `true` and `false`.
        return _write(_WORDS.get(word.lower()) if isinstance(value, str) else None)
    if set(attribute.keywords) == {"enable", "disable"}:
        return _write(_SWITCHES.get(word.lower()))
    if not attribute.is_number:
        return None
    advice = _number(attribute, value) if isinstance(value, str) else None
    form = form_of(attribute)
    return advice or (Advice(f"write `{attribute.name}: {form.replace(']', ']`', 1)}") if form else None)


def item_instead(attribute: Attribute, item: object) -> Advice | None:
    """Return what to write instead of one number of a list, or None if that is not known."""
    if not isinstance(item, str):
        return None
    parts = items(item.replace(";", " "))
    if len(parts) > 1 and all(parse_real(part) is not None for part in parts):
        listed = ", ".join(parts)
        return Advice(f"write commas between them: `{listed}`", listed)
    return _number(attribute, item)


def _number(attribute: Attribute, text: str) -> Advice | None:
    if found := _TEMPLATE.fullmatch(text.strip()):
        expression = f'"${{{(found[1] or found[2]).strip()}}}"'
        return Advice(f"an expression is written `{expression}`", expression)
    if parse_real(text) is not None:
        return Advice(f"write `{text}` without quotes", text.strip())
    if attribute.type != "real":
        return None
    near = text.replace("°", "deg").replace("degrees", "deg").replace("radians", "rad").replace(" ", "")
    if near != text and Angle.read(near):
        return _write(near)
    if found := _PI.fullmatch(text.strip()):
        sign, times, over = found.groups()
        degrees = 180 * float(times or 1) / (float(over or 1) or math.nan)
        return None if math.isnan(degrees) else _write(f"{sign or ''}{number_text(round(degrees, 9))}deg")
    return without_unit(text)


def without_unit(text: str) -> Advice | None:
    """Return what to write instead of `10cm`, `2ms` or `5kg`, or None for any other text."""
    found = _WITH_UNIT.fullmatch(text.strip())
    if found is None or found[2] not in _UNITS:
        return None
    per, unit = _UNITS[found[2]]
    number = number_text(float(found[1]) / per)
    return Advice(f"write `{number}`: numbers have no unit but `deg` and `rad`, {unit} are usual", number)


def _write(text: str | None) -> Advice | None:
    return None if text is None else Advice(f"write `{text}`", text)


def without_space(text: str, keys: Collection[str]) -> str | None:
    """Return key and value of a text in which the space between them is missing, or None.

    >>> without_space("model:./arm.xml", ["model"])
    'model: ./arm.xml'
    """
    key, colon, value = text.partition(":")
    return f"{key}: {value}" if colon and value and key in keys else None


def element_instead(kind: ElementType, value: object) -> str | None:
    """Return the mapping to write instead of a single value such as `sphere` or `./bracket.stl`, or None."""
    if isinstance(value, list):
        return "leave out the `-` or the brackets: this is one mapping"
    if not isinstance(value, str):
        return None
    if value.lstrip().startswith("<"):
        return "write a fragment of MJCF as `{xml: …}`"
    if spaced := without_space(value, kind.attributes):
        return f"put a space behind the colon: `{spaced}`"
    for attribute in kind.attributes.values():
        if value in attribute.keywords or (attribute.type == "file" and "." in value):
            return f"write `{{{attribute.name}: {value}}}`"
    return "write a mapping from attributes to values: `{…: …}`"

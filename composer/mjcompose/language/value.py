"""The value of one attribute, checked by the grammar, and words that messages about values share."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import field
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Fault, Fix, Note, Path
from mjcompose.base.naming import odd_character
from mjcompose.base.suggest import advised, exists_note
from mjcompose.base.words import number_text, value_text
from mjcompose.text.expression import Angle
from mjcompose.tree.grammar import Attribute, ElementType
from mjcompose.tree.values import (
    NOT_XML,
    Refusal,
    check_number,
    check_python,
    expected,
    items,
    may_be_angle,
    parse_real,
)

# Two keys exclude each other.
EXCLUSIVE = "wrong-type"


def exclusive(message: str, keys: tuple[str, str], at: Path = (), help: str | None = None) -> Fault:
    """Return the fault of the second of two keys that exclude each other."""
    first, last = keys
    related = ((f"`{first}` is written here", (*at, first)),)
    help = help or f"leave `{first}` or `{last}` out"
    return Fault(EXCLUSIVE, message, (*at, last), key=True, related=related, help=help, names=keys)


def fault_at(
    diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None, fix: Fix | None = None
) -> Fault:
    """Return a diagnostic as a fault at a path. `help` and `fix` replace the diagnostic's own."""
    fix = fix if help else diagnostic.fix
    help = help or diagnostic.help
    names = tuple(sorted(diagnostic.subjects))
    return Fault(
        diagnostic.code, diagnostic.message, at, key=key, notes=diagnostic.notes, help=help, names=names, fix=fix
    )


def kind_of(value: object) -> str:
    """Return the kind of a value, with the value itself if it is short: `text `abc``, `a list`."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None:
        return "nothing"
    kind = "text" if isinstance(value, str) else "a boolean" if isinstance(value, bool) else "a number"
    text = value_text(value)
    if isinstance(value, float) and text.removeprefix("-").isdigit():
        text += ".0"  # the expected value may be a whole number, which this is not
    return f"{kind} `{text}`" if len(text) <= 40 and "\n" not in text else kind


def is_unprintable(text: str) -> bool:
    """Return whether a text has a character that no XML file can contain, not even escaped."""
    return NOT_XML.search(text) is not None


def unprintable(subject: str, at: Path, *, key: bool = False, name: bool = True) -> Fault:
    """Return the fault of a text with a character that XML cannot hold."""
    return Fault("bad-name" if name else "wrong-type", f"{subject} has a character that XML cannot hold", at, key=key)


def odd_name(name: str, subject: str, at: Path, *, key: bool = False) -> Fault | None:
    """Return the fault of a new name that one line of text, or an XML file, cannot contain; None if it is fine."""
    if is_unprintable(name):
        return unprintable(subject, at, key=key)
    character = odd_character(name)
    if character is None:
        return None
    return Fault("bad-name", f"{subject} has {character} in it", at, key=key, help="use letters, digits and `_ . -`")


def name_fault(name: str, owner: str, at: Path) -> Fault | None:
    if not name.strip():
        return Fault("bad-name", f"a name in {owner} is empty", at, key=True)
    return odd_name(name, f"a name in {owner}", at, key=True)


Single = bool | int | float | str | Angle

Value = Single | tuple[Single, ...]


class RecipeElement(Struct):
    """An element with its children, and its attributes in the order of the file.

    `at` is its path from the top of the recipe: `locate(node, at)` is its place, and `locate(node, (*at, name))` is an
    attribute's. An element that the recipe names by its key has that name as its attribute `name`, whose place is
    `locate(node, at, key=True)`.

    With `xml`, the element is that fragment of MJCF, checked against the grammar and kept as text. Then `tag` is the
    fragment's tag, there are no `children`, and `attributes` has at most the name that a key gives. Paths of files are
    relative to the recipe.

    `terrain` is the form of the height field that mjcompose makes, which then has no other attribute than its name.
    """

    tag: str
    attributes: Mapping[str, Value] = field(default_factory=dict)
    children: tuple[RecipeElement, ...] = ()
    xml: str | None = None
    at: Path = ()
    terrain: Any = None


_SUBSCRIPT = re.compile(r"([^\[\]]+)\[([0-9]{1,4})\]")


def attribute_and_index(name: str) -> tuple[str, int | None]:
    """Return the attribute that a key names, and the index of one of its numbers, or None for all of them.

    >>> attribute_and_index("friction[0]"), attribute_and_index("pos")
    (('friction', 0), ('pos', None))
    """
    found = _SUBSCRIPT.fullmatch(name)
    return (name, None) if found is None else (found[1], int(found[2]))


FULL_TURN = 6.2832


def bare_angle(attribute: Attribute, value: Value, joint: str | None, at: Path, owner: str) -> Fault | None:
    """Return the fault of a value that is an angle, is not zero, and has no unit. None if there is none.

    `joint` is the type of the joint that has the attribute. If it is None, attributes of joints are not checked: the
    caller has to look at their classes.
    """
    items = value if isinstance(value, tuple) else (value,)
    places = angle_places(attribute, len(items), joint)
    bare = [index for index in places if isinstance(items[index], int | float) and items[index] != 0]
    if not bare:
        return None
    unit, is_clear = _likely_unit([float(items[index]) for index in bare])  # type: ignore[arg-type]
    name = "radian" if unit == "rad" else "degree"
    with_unit: list[Any] = [f"{value_text(item)}{unit}" if index in bare else item for index, item in enumerate(items)]
    instead = value_text(with_unit) if isinstance(value, tuple) else with_unit[0]
    alone = len(bare) == 1 and isinstance(value, tuple)
    message = f"`{attribute.name}` of {owner} is an angle without a unit"
    help = f"write `{attribute.name}: {instead}`, or `angle: {name}` at the top of the recipe"
    fix = Fix(with_unit[bare[0]] if alone else instead) if is_clear else None
    return Fault("bare-angle", message, (*at, bare[0]) if alone else at, help=help, fix=fix)


def _likely_unit(numbers: Sequence[float]) -> tuple[str, bool]:
    """Return the unit that numbers of an angle have most likely, and whether that is clear.

    >>> [_likely_unit(numbers) for numbers in ([1.57], [90.0], [3.0])]
    [('rad', True), ('deg', True), ('deg', False)]
    """
    # A number with decimals that is at most a full turn in radians is most likely in radians.
    if any(not number.is_integer() and abs(number) <= FULL_TURN for number in numbers):
        return "rad", True
    return "deg", any(abs(number) > FULL_TURN for number in numbers)


def angle_places(attribute: Attribute, count: int, joint: str | None) -> range:
    """Return which numbers of an attribute are angles. `joint` is the type of the joint, for attributes of joints.

    >>> from mjcompose.tree.grammar import GRAMMAR
    >>> angle_places(GRAMMAR.element("site").attributes["axisangle"], 4, None)
    range(3, 4)
    """
    if attribute.angle in ("orientation-euler", "replicate"):
        return range(count)
    if attribute.angle == "orientation-axisangle":
        return range(3, count)
    return range(count if is_angular(attribute, joint) else 0)


def is_angular(attribute: Attribute, joint: str | None) -> bool:
    turns = joint == "hinge" or (joint == "ball" and attribute.name in ("range", "springyield"))
    return attribute.angle == "joint" and turns


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
    "mm": (1e3, "meters"), "cm": (1e2, "meters"), "m": (1, "meters"),
    "us": (1e6, "seconds"), "µs": (1e6, "seconds"), "ms": (1e3, "seconds"), "s": (1, "seconds"),
    "g": (1e3, "kilograms"), "kg": (1, "kilograms"), "N": (1, "newtons"), "Nm": (1, "newton meters"),
}  # fmt: skip
_FORMS = {
    "pos": "[x, y, z]",
    "axis": "[x, y, z]",
    "zaxis": "[x, y, z]",
    "dir": "[x, y, z]",
    "anchor": "[x, y, z]",
    "gravity": "[x, y, z]",
    "quat": "[w, x, y, z]",
    "axisangle": "[x, y, z, angle]",
    "xyaxes": "[x, y, z, x, y, z], the x axis and then the y axis",
    "fromto": "[x, y, z, x, y, z], one end and then the other",
    "rgba": "[red, green, blue, opacity], each from 0 to 1",
    "range": "[lower, upper]",
    "ctrlrange": "[lower, upper]",
    "forcerange": "[lower, upper]",
}


class Advice(Struct):
    """A help line, and the exact text that it recommends, if there is one."""

    help: str
    text: str | None = None

    @property
    def fix(self) -> Fix | None:
        return None if self.text is None else Fix(self.text)


def form_of(attribute: Attribute) -> str | None:
    """Return the form of the numbers of an attribute, for attributes that are often written wrongly."""
    form = _FORMS.get(attribute.name)
    count = len(form.split("]")[0].split(",")) if form else 0
    return form if attribute.type == "real" and attribute.max_length == count else None


def instead(attribute: Attribute, value: object, tag: str) -> Advice | None:
    """Return what to write instead of a value such as `'0.5'`, `45°`, `pi/2`, `10cm` or `yes`, or None."""
    word = value_text(value)
    if attribute.type == "bool" or "true" in attribute.keywords:
        # YAML 1.1 reads `yes` and `on` as booleans; YAML 1.2 has only `true` and `false`.
        return _write(_WORDS.get(word.lower()) if isinstance(value, str) else None)
    if set(attribute.keywords) == {"enable", "disable"}:
        return _write(_SWITCHES.get(word.lower()))
    if not attribute.is_number:
        return None
    advice = _number(attribute, value, tag) if isinstance(value, str) else None
    form = form_of(attribute)
    return advice or (Advice(f"write `{attribute.name}: {form.replace(']', ']`', 1)}") if form else None)


def item_instead(attribute: Attribute, item: object, tag: str) -> Advice | None:
    """Return what to write instead of one number of a list, or None if that is not known."""
    if not isinstance(item, str):
        return None
    parts = items(item.replace(";", " "))
    if len(parts) > 1 and all(parse_real(part) is not None for part in parts):
        listed = ", ".join(parts)
        return Advice(f"write commas between them: `{listed}`", listed)
    return _number(attribute, item, tag)


def _number(attribute: Attribute, text: str, tag: str) -> Advice | None:
    template = _TEMPLATE.fullmatch(text.strip())
    if template:
        expression = f'"${{{(template[1] or template[2]).strip()}}}"'
        return Advice(f"an expression is written `{expression}`", expression)
    if parse_real(text) is not None:
        return Advice(f"write `{text}` without quotes", text.strip())
    if attribute.type != "real":
        return None
    near = text.replace("°", "deg").replace("degrees", "deg").replace("radians", "rad").replace(" ", "")
    takes_angles = may_be_angle(tag, attribute)
    if near != text and Angle.read(near):
        return _write(near) if takes_angles else None
    if takes_angles and (template := _PI.fullmatch(text.strip())):
        sign, times, over = template.groups()
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
    spaced = without_space(value, kind.attributes)
    if spaced:
        return f"put a space after the colon: `{spaced}`"
    for attribute in kind.attributes.values():
        if value in attribute.keywords or (attribute.type == "file" and "." in value):
            return f"write `{{{attribute.name}: {value}}}`"
    return "write a mapping from attributes to values: `{…: …}`"


def read_value(
    attribute: Attribute, value: Any, at: Path, owner: str, faults: list[Fault], *, tag: str
) -> Value | None:
    """Return the value, a list as a tuple, or None after a fault; `owner` is its element, with that `tag`.

    A number that may be an angle may be an `Angle`.
    """
    subject = f"`{attribute.name}` of {owner}"
    if isinstance(value, dict):
        faults.append(Fault("wrong-type", f"{subject} expects {expected(attribute)}, got a mapping", at))
        return None
    if isinstance(value, list):
        return _read_list(attribute, value, at, subject=subject, faults=faults, tag=tag)
    read = _angle(attribute, value)
    if isinstance(read, Angle) and not may_be_angle(tag, attribute):
        faults.append(no_angle(subject, read, at))
        return None
    answer = check_python(attribute, read.value if isinstance(read, Angle) else read)
    if answer is not None:
        faults.append(_fault(attribute, value, answer, code=_code(attribute, read), at=at, subject=subject, tag=tag))
        return None
    return read if _printable(attribute, read, at, subject=subject, faults=faults) else None


def no_angle(subject: str, angle: Angle, at: Path) -> Fault:
    """Return the fault of an angle in a place that takes none."""
    help = f"write a number without `{angle.unit}`"
    return Fault("wrong-type", f"{subject} is not an angle, got `{value_text(angle.value)}{angle.unit}`", at, help=help)


def _read_list(
    attribute: Attribute, value: list[Any], at: Path, subject: str, faults: list[Fault], tag: str
) -> Value | None:
    items: list[Any] = [_angle(attribute, item) for item in value]
    several = attribute.is_number and attribute.max_length != 1
    wrong = list(_wrong_angles(attribute, items, at, subject=subject, tag=tag))
    if several:
        # Each number is checked alone, so a fault points at the number and not at the whole list.
        for index, item in enumerate(items):
            if check_number(attribute, item.value if isinstance(item, Angle) else item) is not None:
                wrong.append(_item_fault(attribute, item, (*at, index), subject=subject, tag=tag))
    if wrong:
        faults += wrong
        return None
    answer = check_python(attribute, [item.value if isinstance(item, Angle) else item for item in items])
    if answer is not None:
        code = "wrong-length" if several else _list_code(attribute, items)
        faults.append(_fault(attribute, value, answer, code=code, at=at, subject=subject, tag=tag))
        return None
    for index, item in enumerate(items):
        if not _printable(attribute, item, (*at, index), subject=subject, faults=faults):
            return None
    return tuple(items)


def _wrong_angles(attribute: Attribute, items: list[Any], at: Path, subject: str, tag: str) -> Iterator[Fault]:
    """Yield the faults of the angles in places that take none."""
    allowed = _places_of_angles(attribute, len(items)) if may_be_angle(tag, attribute) else ()
    for index, item in enumerate(items):
        if isinstance(item, Angle) and index not in allowed:
            which = f"a number of the axis in {subject}" if allowed else subject
            yield no_angle(which, item, (*at, index))


def _places_of_angles(attribute: Attribute, count: int) -> range:
    """Return which numbers of an attribute that may have angles may be angles: only the axis cannot."""
    return range(3 if attribute.angle == "orientation-axisangle" else 0, count)


def _angle(attribute: Attribute, value: Any) -> Any:
    if attribute.type != "real" or not isinstance(value, str):
        return value
    return Angle.read(value) or value


def _code(attribute: Attribute, value: object) -> str:
    if attribute.is_number:
        return "wrong-length" if isinstance(value, Angle) else _number_code(attribute, value)
    if attribute.type in ("keyword", "keywords") and isinstance(value, str | bool | int):
        return "wrong-keyword"
    return "wrong-length" if attribute.type == "chars" and isinstance(value, str) else "wrong-type"


def _number_code(attribute: Attribute, value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return "wrong-type"
    if attribute.type == "int" and isinstance(value, float) and not value.is_integer():
        return "wrong-type"
    return "out-of-range" if check_number(attribute, value) else "wrong-length"


def _list_code(attribute: Attribute, items: list[Any]) -> str:
    if attribute.type == "keywords" and items and all(isinstance(item, str | bool | int) for item in items):
        return "wrong-keyword"
    return "wrong-length" if attribute.separated and not items else "wrong-type"


def _item_fault(attribute: Attribute, item: object, at: Path, subject: str, tag: str) -> Fault:
    code = _number_code(attribute, item)
    noun = "integers" if attribute.type == "int" else "numbers"
    wanted = f"{noun} of 32 bits" if code == "out-of-range" else noun
    advice = item_instead(attribute, item, tag)
    message = f"{subject} expects {wanted}, got {kind_of(item)}"
    return Fault(code, message, at) if advice is None else Fault(code, message, at, help=advice.help, fix=advice.fix)


def _fault(attribute: Attribute, value: Any, answer: Refusal, code: str, at: Path, subject: str, tag: str) -> Fault:
    advice = None if answer.advice else instead(attribute, value, tag)
    help = answer.advice if advice is None else advice.help
    notes: tuple[Note, ...] = ()
    fix = None if advice is None else advice.fix
    if code == "wrong-keyword":
        words = value if isinstance(value, list) else [value]
        wrong = next((text for text in map(value_text, words) if text not in attribute.keywords), None)
        if wrong is not None:
            near, renamed = advised(wrong, attribute.keywords)
            if near is not None:
                help = near
                fix = renamed if value == wrong else None
            if answer.unknown is not None and not answer.lists_keywords:
                notes = (exists_note("keyword", attribute.keywords, wrong),)
    elif answer.instead is not None:
        help = f"write `{attribute.name}: {answer.instead}`"
        fix = Fix(answer.instead)
    return Fault(code, f"{subject} {answer.message}", at, notes=notes, help=help, fix=fix)


def _printable(attribute: Attribute, value: object, at: Path, subject: str, faults: list[Fault]) -> bool:
    if not isinstance(value, str):
        return True
    if attribute.type == "name":
        fault = odd_name(value, subject, at)
    else:
        is_name = attribute.type in ("reference", "references")
        fault = unprintable(subject, at, name=is_name) if is_unprintable(value) else None
    if fault is not None:
        faults.append(fault)
    return fault is None


NOT_NEGATIVE = frozenset("mass density diaginertia armature damping frictionloss stiffness friction size".split())
"""Attributes that a draw must not make negative; for polynomials, this concerns only the first number."""
_POLYNOMIALS = ("damping", "stiffness")


def must_not_be_negative(attribute: str, component: int) -> bool:
    """Return whether a negative number has no meaning there.

    >>> must_not_be_negative("damping", 0), must_not_be_negative("damping", 1), must_not_be_negative("pos", 0)
    (True, False, False)
    """
    return attribute in NOT_NEGATIVE and (component == 0 or attribute not in _POLYNOMIALS)

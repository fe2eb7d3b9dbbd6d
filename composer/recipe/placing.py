"""Attributes of MJCF that place a part: its offset and its joint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest, exists_note, renaming
from composer.expr.angle import Angle
from composer.grammar import GRAMMAR
from composer.recipe.angles import bare_angle
from composer.recipe.attribute_schema import attribute_schema
from composer.recipe.element import Element, Single, Value
from composer.recipe.fault import Fault, Path
from composer.recipe.form import Form
from composer.recipe.presence import missing_key
from composer.recipe.reader import Reader, label
from composer.recipe.reference import Schema, reference
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.value import read_value

OWNER = "an attached part"
ORIENTATIONS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
WORDS = ("weld", "free", "ball", "mocap")
JointWord = Literal["weld", "free", "ball", "mocap"]
JointType = ("hinge", "slide", "ball")
TINY = 1e-10
"""Axes shorter than this are none to MuJoCo."""
_NEUTRAL = {
    "quat": "`[1, 0, 0, 0]`",
    "axisangle": "an axis, such as `[0, 0, 1, 90deg]`",
    "zaxis": "`[0, 0, 1]`",
    "xyaxes": "`[1, 0, 0, 0, 1, 0]`",
}


@dataclass(frozen=True, slots=True)
class Offset(Form):
    """Form of a field that is an attribute of a frame: `pos`, or one of the orientations.

    It is read as a tuple. It contains `Angle`s only if the attribute is an angle.
    """

    name: str

    def schema(self) -> Schema:
        return attribute_schema(GRAMMAR.element("frame").attributes[self.name])

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Value | None:
        attribute = GRAMMAR.element("frame").attributes[self.name]
        read = read_value(attribute, value, (), OWNER, faults)
        if isinstance(read, tuple) and attribute.angle is None:
            read = tuple(item.radians if isinstance(item, Angle) else item for item in read)
        elif read is not None and not settings.bare_angles:
            bare = bare_angle(attribute, read, None, (), OWNER)
            faults += [bare] if bare is not None else []
        if not faults and isinstance(read, tuple):
            fault = _no_pose(self.name, read)
            faults += [fault] if fault is not None else []
        assert faults or isinstance(read, tuple), "an offset has several numbers"
        return read


def _no_pose(name: str, read: tuple[Single, ...]) -> Fault | None:
    """Return the fault of numbers that are no position or orientation, or None.

    Otherwise MuJoCo would report a frame that the user has not written.
    """
    numbers = [float(item.value if isinstance(item, Angle) else item) for item in read]
    if not all(math.isfinite(number) for number in numbers):
        wrong = next(index for index, number in enumerate(numbers) if not math.isfinite(number))
        return Fault(
            "out-of-range", f"`{name}` of {OWNER} expects finite numbers", (wrong,), help="write a number"
        )
    axes = {
        "quat": [numbers],
        "axisangle": [numbers[:3]],
        "zaxis": [numbers],
        "xyaxes": [numbers[:3], numbers[3:]],
    }
    for axis in axes.get(name, ()):
        if math.hypot(*axis) < TINY:
            message = f"`{name}` of {OWNER} is not an orientation: all its numbers are zero"
            return Fault("out-of-range", message, help=f"leave `{name}` out, or write {_NEUTRAL[name]}")
    if name == "xyaxes" and math.hypot(*_cross(numbers[:3], numbers[3:])) < TINY:
        message = f"`xyaxes` of {OWNER} is not an orientation: its two axes have the same direction"
        return Fault(
            "out-of-range", message, help="write axes at a right angle, such as `[1, 0, 0, 0, 1, 0]`"
        )
    return None


def _cross(a: list[float], b: list[float]) -> tuple[float, float, float]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@dataclass(frozen=True, slots=True)
class JointField(Form):
    """Form of the field `joint`: a word, a mapping of a joint's attributes, or a list of such mappings with names.

    It is read as the word, an `Element` for a joint without a name, or a tuple of `Element` with names.
    """

    def schema(self) -> Schema:
        kind = {"enum": [*JointType], "description": GRAMMAR.element("joint").attributes["type"].doc}
        one = {**reference("element:joint"), "properties": {"type": kind}}
        several = {"type": "array", "minItems": 1, "items": {**one, "required": ["name"]}}
        return {"anyOf": [{"enum": [*WORDS]}, {"type": "object", **one}, several]}

    def read(
        self, value: Any, faults: list[Fault], settings: Settings
    ) -> str | Element | tuple[Element, ...] | None:
        reader = Reader(settings, faults)
        if isinstance(value, str) and value in WORDS:
            return value
        if isinstance(value, dict):
            element = _joint(reader, value, ())
            named = element is not None and "name" in element.attributes
            return (element,) if element is not None and named else element
        if isinstance(value, list):
            return _joints(reader, value)
        faults.append(_no_joint(value))
        return None


def _joints(reader: Reader, value: list[Any]) -> tuple[Element, ...]:
    if not value:
        reader.faults.append(Fault("wrong-length", "`joint` is an empty list", help="leave `joint` out"))
    elements: list[Element] = []
    names: dict[object, Path] = {}
    for index, item in enumerate(value):
        element = _joint(reader, item, (index,))
        if isinstance(item, dict) and "name" not in item:
            fault = missing_key("a joint in a list", "name", (index,))
            help = "write `name: …`; the joint is called PREFIX/NAME"
            reader.faults.append(Fault(fault.code, fault.message, (index,), help=help))
        elif element is not None:
            name = element.attributes.get("name")
            if name in names:
                related = (("the first one is here", names[name]),)
                message = f"two joints of one part are called `{name}`"
                reader.faults.append(
                    Fault("name-clash", message, (index, "name"), related=related, help="choose another name")
                )
            names.setdefault(name, (index, "name"))
            elements.append(element)
    return tuple(elements)


def _joint(reader: Reader, value: Any, at: Path) -> Element | None:
    kind = GRAMMAR.element("joint")
    written = value.get("type", "hinge") if isinstance(value, dict) else None
    if written == "free":
        message = "a free joint has no attributes and stands alone"
        reader.faults.append(Fault("wrong-keyword", message, (*at, "type"), help="write `joint: free`"))
        return None
    # A joint between a place and a part only has the class that it names, which may set another type.
    type = "hinge" if isinstance(value, Mapping) and "class" not in value else None
    element = reader.element(kind, value, at, label("joint", value), joint=type)
    if element is not None and element.attributes.get("name", "joint") == "":
        message = "the name of a joint is empty"
        reader.faults.append(Fault("bad-name", message, (*at, "name"), help="leave `name` out, or write one"))
    return element


def _no_joint(value: Any) -> Fault:
    help = "write one of `weld`, `free`, `ball`, `mocap`, or `{type: hinge, axis: [0, 0, 1]}`"
    if not isinstance(value, str):
        return Fault(
            "wrong-type", f"`joint` expects a word, a mapping or a list, got {kind_of(value)}", help=help
        )
    near, fix = closest(value, WORDS), None
    if value in JointType:
        help = f"write `joint: {{type: {value}, axis: [0, 0, 1]}}`"
    elif near:
        help, fix = f"write `joint: {near[0]}`", renaming(value, WORDS)
    note = exists_note("word", WORDS, value)
    return Fault("wrong-keyword", f"`joint` cannot be `{value}`", notes=(note,), help=help, fix=fix)

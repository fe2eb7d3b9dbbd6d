"""Compute numbers from the present ones: `scale`, `offset`, and `set` of one number of several."""

from __future__ import annotations

from typing import Any

from composer.compose.edit_values import POLYNOMIALS, Values
from composer.compose.refuse import refuse
from composer.compose.verbs.operation import OFFSET, Operation
from composer.compose.verbs.whole_value import check_without_ends
from composer.expr.angle import Angle
from composer.grammar.attribute import Attribute
from composer.grammar.check import check_python
from composer.grammar.degrees import is_in_degrees
from composer.grammar.format import to_text
from composer.link import numbers
from composer.recipe.fault import Fault, Path
from composer.recipe.verbs.values import MASS
from composer.tree.attributes import replace
from composer.tree.effective import levels
from composer.tree.kinds import kind_of


def compute(
    values: Values, operation: Operation, attribute: Attribute, subscript: int | None, written: Any, at: Path
) -> None:
    """Write the numbers that the operation makes of the present ones; with a subscript of that one alone."""
    editing, node = values.editing, values.node
    now = _present(values, operation, attribute, subscript=subscript, at=at)
    given = values.of(written, at, values.now(attribute, subscript))
    if isinstance(given, list) and len(given) > len(now):
        message = f"`{attribute.name}` of {editing.called(node)} has {len(now)} numbers, got {len(given)}"
        refuse(editing, node, Fault("wrong-length", message, at))
    places = [subscript] if subscript is not None else list(range(len(now)))
    if operation is OFFSET and attribute.name in POLYNOMIALS and not isinstance(given, list):
        places = places[:1]  # one number is the linear coefficient, as in MJCF
    items = given if isinstance(given, list) else [given] * len(places)
    angles = set(values.angles(attribute, len(now)))
    if angles and attribute.name == "euler":
        _check_sequence(values, at)
    for place, item in zip(places, items, strict=False):
        now[place] = operation.combine(
            now[place], _number(values, operation, item, attribute=attribute, is_angle=place in angles, at=at)
        )
    result: list[Any] = [
        int(each) if attribute.type == "int" and each == int(each) else each
        for each in _without_defaults(values, attribute, now)
    ]
    answer = check_python(attribute, result if attribute.max_length != 1 else result[0])
    if answer is not None:
        message = f"`{attribute.name}` of {editing.called(node)} {answer}"
        refuse(editing, node, Fault("out-of-range", message, at))
    check_without_ends(values, attribute, at)
    if attribute.is_interval:
        editing.making.intervals[node, attribute.name] = editing.span(at)
    editing.write(node, {attribute.name: at})
    with editing.writing(node, attribute):
        replace(node, {attribute.name: to_text(attribute, result)})


def _present(
    values: Values, operation: Operation, attribute: Attribute, subscript: int | None, at: Path
) -> list[float]:
    """Return the effective numbers of the attribute, in the model's units. Report that there are none, or too few."""
    editing, node = values.editing, values.node
    text = editing.effective(node, attribute.name)
    if not attribute.is_number or not text or not text.split():
        help = None
        if attribute.name == MASS:
            help = "its mass comes from its `density`: change that, or the whole mass of its body"
        message = f"{editing.called(node)} has no `{attribute.name}` that `{operation.verb}` could start from"
        refuse(editing, node, Fault("wrong-type", message, at, key=True, help=help))
    now = numbers.read(text)
    if subscript is not None and subscript >= len(now):
        message = f"`{at[-1]}` of {editing.called(node)} does not exist: it has {len(now)} numbers"
        refuse(editing, node, Fault("wrong-length", message, at, key=True))
    return now


def _without_defaults(values: Values, attribute: Attribute, found: list[float]) -> list[float]:
    """Return the numbers without trailing MuJoCo defaults, since an older MuJoCo may accept fewer numbers."""
    node = values.node
    steps = levels(node, kind_of(node), attribute, classes=values.editing.classes)
    said = max((step.taken.stop for step in steps if step.kind != "mujoco"), default=0)
    default = attribute.default if isinstance(attribute.default, tuple) else ()
    least = max(said, attribute.min_length or 0, 1)
    while len(found) > least and len(found) <= len(default) and found[-1] == default[len(found) - 1]:
        found = found[:-1]
    return found


def _number(
    values: Values, operation: Operation, item: Any, attribute: Attribute, is_angle: bool, at: Path
) -> float:
    """Return the written number. An angle is in the model's unit, unless it is a factor."""
    editing, node = values.editing, values.node
    making = editing.making
    given = Angle.read(item) if isinstance(item, str) else item
    if isinstance(given, bool) or not isinstance(given, int | float | Angle):
        refuse(editing, node, Fault("wrong-type", f"`{at[-1]}` expects a number, got `{item}`", at))
    if operation.is_factor:
        if isinstance(given, Angle):
            refuse(editing, node, Fault("wrong-type", "a factor has no unit", at))
        return float(given)
    if is_angle:
        settings = making.angle_context.at(at)
        if not isinstance(given, Angle) and given != 0 and settings.angle is None:
            help = f"write `{given}deg` or `{given}rad`, or `angle: degree` at the top of the recipe"
            message = f"`{attribute.name}` of {editing.called(node)} is an angle and {given} has no unit"
            refuse(editing, node, Fault("bare-angle", message, at, help=help))
        radians = numbers.joint_radians if attribute.angle == "joint" else numbers.orientation_radians
        return making.turned(given, settings, radians)
    unit = "deg" if is_in_degrees(str(node.tag), attribute.name) else "rad"
    return given.in_unit(unit) if isinstance(given, Angle) else float(given)


def _check_sequence(values: Values, at: Path) -> None:
    """Report Euler angles that the model and the recipe turn in different sequences."""
    editing, node = values.editing, values.node
    making = editing.making
    sequence = making.angle_context.at(at).eulerseq
    if sequence != making.model_eulerseq:
        sequences = f"the sequence `{making.model_eulerseq}`, the recipe in `{sequence}`"
        message = f"`euler` of {editing.called(node)} turns in {sequences}"
        refuse(editing, node, Fault("not-supported", message, at, help="set the whole orientation"))

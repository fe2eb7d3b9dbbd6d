"""Angles without a unit, in a recipe that does not set a unit of angles."""

from __future__ import annotations

from typing import Any

from composer.diagnostics.fix import Fix
from composer.grammar.attribute import Attribute
from composer.recipe.element import Value
from composer.recipe.fault import Fault, Path
from composer.recipe.shown import shown

FULL_TURN = 6.2832


def bare_angle(attribute: Attribute, value: Value, joint: str | None, at: Path, owner: str) -> Fault | None:
    """Return the fault of a value that is an angle, is not zero, and has no unit. None if there is none.

    `joint` is the type of the joint that has the attribute. If it is None, attributes of joints are not judged: the
    caller has to look at their classes.
    """
    items = value if isinstance(value, tuple) else (value,)
    bare = [index for index in angle_places(attribute, len(items), joint) if _is_bare(items[index])]
    if not bare:
        return None
    # A number with decimals that is at most a full turn in radians is most likely in radians.
    radians = any(not float(items[i]).is_integer() and abs(float(items[i])) <= FULL_TURN for i in bare)  # type: ignore[arg-type]
    unit, name = ("rad", "radian") if radians else ("deg", "degree")
    with_unit: list[Any] = [
        f"{shown(item)}{unit}" if index in bare else item for index, item in enumerate(items)
    ]
    instead = shown(with_unit) if isinstance(value, tuple) else with_unit[0]
    alone = len(bare) == 1 and isinstance(value, tuple)
    clear = radians or any(abs(float(items[i])) > FULL_TURN for i in bare)  # type: ignore[arg-type]
    return Fault(
        "bare-angle",
        f"`{attribute.name}` of {owner} is an angle without a unit",
        (*at, bare[0]) if alone else at,
        help=f"write `{attribute.name}: {instead}`, or `angle: {name}` at the top of the recipe",
        fix=Fix(with_unit[bare[0]] if alone else instead) if clear else None,
    )


def angle_places(attribute: Attribute, count: int, joint: str | None) -> range:
    """Return which numbers of an attribute are angles. `joint` is the type of the joint, for attributes of joints.

    >>> from composer.grammar import GRAMMAR
    >>> angle_places(GRAMMAR.element("site").attributes["axisangle"], 4, None)
    range(3, 4)
    """
    if attribute.angle in ("orientation-euler", "replicate"):
        return range(count)
    if attribute.angle == "orientation-axisangle":
        return range(3, count)
    if attribute.angle == "joint" and (joint == "hinge" or (joint == "ball" and attribute.name == "range")):
        return range(count)
    return range(0)


def _is_bare(item: object) -> bool:
    """Return whether a value is a number other than zero and has no unit."""
    return isinstance(item, int | float) and item != 0

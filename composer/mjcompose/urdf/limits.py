"""The limits of joints, as the URDF standard reads them: a missing `lower` or `upper` is 0."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Cause
from mjcompose.base.sink import Sink
from mjcompose.urdf.robot import Robot

CODE = "urdf-limits"
_ENDS = ("lower", "upper")
_WITHOUT = {"revolute": 'write `type="continuous"`', "prismatic": "write ends that it does not reach"}
"""By the types of joints that have limits, how a file says that one has none."""


class Unlimited(Struct):
    """A joint that MuJoCo leaves without limits although its type has them. `element` is where this is written."""

    joint: Node
    element: Node
    attribute: str | None
    why: str
    is_still: bool = False


def complete_limits(robot: Robot) -> None:
    """Write the 0 that the standard gives to a missing `lower` or `upper`: MuJoCo ignores a limit without both.

    A `<limit>` with neither stays: by the standard the joint cannot move, and nobody means that. Ends that no version
    of MuJoCo uses are removed: MuJoCo 3.12 saves equal ones as a range that it then refuses.
    """
    for unlimited in list(unlimited_joints(robot.root)):
        if unlimited.element.tag == "limit":
            for end in _ENDS:
                robot.changed |= bool(unlimited.element.attrib.pop(end, ""))
    for _, limit in _limits(robot.root):
        missing = [end for end in _ENDS if limit is not None and limit.get(end) is None]
        if limit is not None and len(missing) == 1:
            limit.set(missing[0], "0")
            robot.changed = True


def unlimited_joints(root: Node) -> Iterator[Unlimited]:
    for joint, limit in _limits(root):
        if limit is None:
            yield Unlimited(joint, joint, None, "it has no `<limit>`")
            continue
        written = [end for end in _ENDS if limit.get(end) is not None]
        if not written:
            yield Unlimited(joint, limit, None, "its `<limit>` has neither `lower` nor `upper`")
            continue
        unreadable = next((end for end in written if _number(limit.get(end)) is None), None)
        if unreadable is not None:
            yield Unlimited(joint, limit, unreadable, f"`{limit.get(unreadable)}` is not a number")
            continue
        low, high = (_number(limit.get(end)) or 0.0 for end in _ENDS)
        if low == high:
            yield Unlimited(joint, limit, written[0], f"`lower` and `upper` are both {low:g}", is_still=True)
        elif low > high:
            missing = [f"; a missing `{end}` is 0" for end in _ENDS if end not in written]
            why = f"`lower` ({low:g}) is above `upper` ({high:g}){''.join(missing)}"
            yield Unlimited(joint, limit, written[0], why)


def report_unlimited(robot: Robot, sink: Sink) -> None:
    """Warn about each joint that moves without limits although its type has them."""
    for each in unlimited_joints(robot.root):
        name = each.joint.get("name")
        kind = str(each.joint.get("type"))
        fixed = 'write `type="fixed"` if it does not move; ' if each.is_still else ""
        sink.warning(
            CODE,
            f"the {kind} joint `{name}` moves without limits: {each.why}",
            robot.unit.origins.span(each.element, robot.unit.file, each.attribute),
            help=f"{fixed}write its limits, or, if it has none, {_WITHOUT[kind]}",
            cause=Cause(f"unlimited joints of {robot.unit.file}", f"`{name}`: {each.why}"),
        )


def _limits(root: Node) -> Iterator[tuple[Node, Node | None]]:
    """Yield the joints that have limits, each with its `<limit>`."""
    for joint in root.iterchildren("joint"):
        if joint.get("type") in _WITHOUT:
            yield joint, joint.find("limit")


def _number(text: str | None) -> float | None:
    try:
        number = float(text or "")
    except ValueError:
        return None
    return None if math.isnan(number) else number

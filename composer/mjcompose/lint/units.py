"""Rules about values that look like another unit."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lxml.etree import _Element as Node

from mjcompose.lint.ranges import position_servos
from mjcompose.lint.rule import Finding, Found, Subject, rule
from mjcompose.mujoco.arrays import HINGE

_TURN = 2 * math.pi
_ROUND = tuple(math.pi * each for each in (1 / 6, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 1, 3 / 2, 2))
_DIGITS = 2e-3
_DEGREES = 4 * math.pi
_GRAVITY = 50.0
_METERS = "ROS REP 103, “Units”: meter, kilogram, second; NVIDIA SimReady, robot profiles: `metersPerUnit = 1`"
_LONGEST = 0.05
_SHORTEST = 1e-5


def _ranges(subject: Subject, unit: str) -> Iterator[tuple[Node, list[float]]]:
    """Yield the joints with a range of angles, if angles have this unit."""
    if (subject.setting("compiler", "angle") or "degree") == unit:
        for joint in subject.each("joint"):
            ends = subject.numbers(joint, "range")
            if ends is not None and len(ends) == 2 and subject.value(joint, "type") in ("hinge", "ball"):
                yield joint, ends


@rule("range-in-radians", "A range in degrees that looks like radians")
def range_in_radians(subject: Subject) -> Found:
    for joint, ends in _ranges(subject, "degree"):
        is_round = any(abs(abs(end) - each) < _DIGITS for end in ends for each in _ROUND if end)
        if is_round and max(map(abs, ends)) < _TURN + _DIGITS:
            message = f"the range of {subject.called(joint)}, {ends[0]:g} to {ends[1]:g} degrees, looks like radians"
            yield Finding(joint, message, "range", help='write `<compiler angle="radian"/>`, or degrees')


@rule("range-in-degrees", "A range in radians that looks like degrees")
def range_in_degrees(subject: Subject) -> Found:
    for joint, ends in _ranges(subject, "radian"):
        if max(map(abs, ends)) > _DEGREES and all(end % 5 == 0 for end in ends):
            message = f"the range of {subject.called(joint)}, {ends[0]:g} to {ends[1]:g} rad, looks like degrees"
            yield Finding(joint, message, "range", help="write the range in radians")


_LEAST = 50.0
_MOST = 65.0


@rule(
    "control-in-degrees",
    "A position actuator in degrees whose joint is in radians, or the other way round",
    in_mujoco=True,
)
def control_in_degrees(subject: Subject) -> Found:
    model = subject.model
    for row, joint, control, gear in position_servos(subject):
        if not (model.actuator_ctrllimited[control] and model.jnt_limited[joint]):
            continue
        if int(model.jnt_type[joint]) != HINGE:
            continue
        most = max(abs(float(each) / gear) for each in model.actuator_ctrlrange[control])
        reach = max(abs(float(each)) for each in model.jnt_range[joint])
        is_large = _LEAST * reach <= most <= _MOST * reach
        is_small = _LEAST * most <= reach <= _MOST * most
        if not reach or not (is_large or is_small):
            continue
        times = most / reach if is_large else reach / most
        larger = f"the controls of {subject.name('actuator', row)}"
        smaller = f"the range of {subject.name('joint', joint)}"
        larger, smaller = (larger, smaller) if is_large else (smaller, larger)
        message = f"{larger} {'reach' if is_large else 'reaches'} {times:.3g} times as far as {smaller}"
        one, other = ("controls", "range") if is_large else ("range", "controls")
        help = f"write the {one} in radians; or the {other} is in radians, and the file lacks "
        help += '`<compiler angle="radian"/>`'
        yield Finding(subject.node("actuator", row), message, "ctrlrange", help=help)


@rule("gravity-unit", "Gravity that is not in m/s²", usual=False, profiles={"robot-asset": _METERS})
def gravity_unit(subject: Subject) -> Found:
    for option in subject.root.iterfind("option"):
        size = math.hypot(*(subject.numbers(option, "gravity") or []))
        if size > _GRAVITY:
            message = f"gravity is {size:g} m/s², {size / 9.81:.3g} times the gravity of the earth"
            yield Finding(option, message, "gravity", help="write lengths in meters, and gravity in m/s²")


@rule("timestep-extreme", "A time step that is very long or very short")
def timestep_extreme(subject: Subject) -> Found:
    for option in subject.root.iterfind("option"):
        step = (subject.numbers(option, "timestep") or [0.002])[0]
        if option.get("timestep") and not _SHORTEST <= step <= _LONGEST:
            message = f"the time step is {step * 1000:g} ms"
            yield Finding(option, message, "timestep", help="write seconds, such as 0.002")


@rule("mesh-in-millimeters", "A mesh that is in millimeters", in_mujoco=True, profiles={"robot-asset": _METERS})
def mesh_size(subject: Subject) -> Found:
    import numpy as np

    from mjcompose.mujoco.shapes import MeshMeasurements, doubts

    model = subject.model
    reach = float(np.linalg.norm(model.body_pos, axis=1).max(initial=0.0))
    for mesh in range(model.nmesh):
        first = int(model.mesh_vertadr[mesh])
        count = int(model.mesh_vertnum[mesh])
        size = float(np.linalg.norm(np.ptp(model.mesh_vert[first : first + count], axis=0)))
        scale = model.mesh_scale[mesh].tolist()
        if size > 1:
            for doubt in doubts(MeshMeasurements(size), reach):
                message = f"{subject.name('mesh', mesh)} {doubt.what}"
                help = doubt.advice(scale, 'scale="{}"')
                yield Finding(subject.node("mesh", mesh), message, help=help)
